r"""Derivatives of poses by one known quantity, all others held: an input, a rod's length, or a joint's gap.

With y = [u, w] and the known coordinates w(q), C(y) = 0 gives C_u u_q = -C_w w_q (implicit function theorem).
The quantity q is called a *way*. A gap opens a joint: one half of the joint, the point as some rows R read
it, moves away from the other half. This adds the derivative of these rows by the point, C_u u_q = -R C_p. On
a slide, R are the rows of its line.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.linkage.mechanism import Mechanism, carried_place
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import implicit_rate
from pointcoord.numerics.power_series import cross_series

# Poses at a time, so that intermediate results stay in cache.
POSES = 4096
GAP = "gap"
"""Key of the gap vector itself among the derivatives of points along a gap."""


@dataclass(frozen=True)
class ByInput:
    """By an input, rad or mm; by mm of its travel where the input is a steering wheel.

    The derivative is zero for an input outside the part that is solved for.
    """

    input: str


@dataclass(frozen=True)
class ByLength:
    """By the length of a rod, up to a constant factor."""

    rod: str


@dataclass(frozen=True)
class ByGap:
    """By the gap of a joint at a point, one unit along an axis, of the half not on the reported body.

    If that half belongs to the chassis, it stays, and the other half moves by as much the other way. On a
    slide the line moves.
    """

    point: str
    axis: int


Way = ByInput | ByLength | ByGap


def moved_along(
    mechanism: Mechanism, y: Array, ways: Sequence[Way]
) -> tuple[dict[str, Array], list[dict[str, Array]]]:
    """Every point of poses, mm, and its derivative along each way, mm per rad, mm or unit.

    Args:
        y: (N, size), or (cars, N, size) for a batch of cars. Points have the same shape, with 3 as the last.
    """
    if y.ndim > 2:
        # One car for each pose; some cars at a time, so that their matrices stay small.
        count = max(1, POSES // y.shape[1])
        parts = [
            moved_along(
                mechanism.taken(np.repeat(np.arange(low, low + len(some)), y.shape[1])),
                some.reshape(-1, y.shape[-1]),
                ways,
            )
            for low in range(0, len(y), count)
            for some in [y[low : low + count]]
        ]
        shape = (*y.shape[:-1], 3)
        tables = list(zip(*([places, *slopes] for places, slopes in parts), strict=True))
        joined = [
            {name: np.concatenate([part[name] for part in table]).reshape(shape) for name in table[0]}
            for table in tables
        ]
        return joined[0], joined[1:]
    unit = mechanism.unit[..., None]
    places = {name: place * unit for name, place in mechanism.places(y).items()}
    places[GAP] = np.zeros((len(y), 3))
    slopes = way_slopes(mechanism, y, ways)
    return places, [point_slopes(mechanism, y, s, way) for way, s in zip(ways, slopes, strict=True)]


def way_slopes(mechanism: Mechanism, y: Array, ways: Sequence[Way]) -> list[Array]:
    """dy/dq along each way at poses y, (N, size), units per rad, mm or unit; zero where nothing moves."""
    if not ways:
        return []
    factors, found = factorise(mechanism.map.jacobian(y)), []
    values = mechanism.input_values(y[:, mechanism.map.unknowns :])
    for way in ways:
        known, (moved, rows) = known_slopes(mechanism, values, way), shifted(mechanism.topology, way)
        opened = 2.0 * mechanism.map.polar(y, np.broadcast_to(moved, y.shape)) * rows
        found.append(implicit_rate(mechanism.map, factors, y, known, opened))
    return found


def known_slopes(mechanism: Mechanism, inputs: Mapping[str, Array], way: Way) -> Array:
    """The known coordinates' part of dy/dq, (..., N, known).

    Args:
        inputs: values of the inputs, each (N,), rad or mm.
    """
    topology, unknowns, drawn = mechanism.topology, mechanism.map.unknowns, mechanism.drawn
    shape = np.broadcast_shapes(drawn.shape[:-1], *(value.shape for value in inputs.values()))
    known = np.zeros((*shape, drawn.shape[-1] - unknowns), drawn.dtype)
    if isinstance(way, ByInput):
        if way.input not in topology.required_inputs:
            return known
        value = inputs[way.input]
        series = np.stack([value, np.ones_like(value)], axis=-1)
        for drive, place in zip(topology.drives, topology.driven, strict=True):
            if drive.input == way.input:
                known[..., place - unknowns] = drive.travel.series(series, mechanism.drawing)[..., 1]
        return known
    if isinstance(way, ByLength):
        ends = {*topology.rods[way.rod]}
        of_the_rod = (one.constants for one in topology.constraints if ends in map(set, one.segments))
        # The one constant of a rod's constraint is its length, in whatever form.
        length = next(constants[0] for constants in of_the_rod if len(constants) == 1)
        known[..., topology.layout.scalar(length) - unknowns] = 1.0
    elif way.point in topology.chassis and way.point not in topology.sliding:
        known[..., topology.layout.vector(way.point)[way.axis] - unknowns] = 1.0
    return known


def shifted(topology: Topology, way: Way) -> tuple[Array, Array]:
    """For a gap: shift of each coordinate, (size,), and 1 at the rows that read the shifted coordinates.

    The shift of a point that moves is 1. A joint's point on the chassis moves as a known coordinate instead;
    rows that only use it as a centre of rotation are not part of the joint, and read it shifted back by -1.
    """
    layout, system = topology.layout, topology.map
    moved, rows = np.zeros(layout.size), np.zeros(len(system.rows))
    if not isinstance(way, ByGap):
        return moved, rows
    (slide, _), place = topology.sliding.get(way.point, ("", False)), layout.vector(way.point)
    of_chassis = way.point in topology.chassis and not slide
    moved[place[way.axis]] = -1.0 if of_chassis else 1.0
    there = {*topology.moving, *topology.chassis}
    beside = next((others for points, others in topology.joints.items() if way.point in points), ())
    others = {i for name in beside if name in there for i in layout.vector(name)}
    for constraint, numbers in zip(topology.constraints, topology.rows_of, strict=True):
        read = {i for row in numbers for i in system.reads[row]}
        if slide:
            of_this_half = constraint.slide == slide and not read.isdisjoint(place)
        elif of_chassis:
            of_this_half = way.point in constraint.pivots
        else:
            of_this_half = not (read.isdisjoint(place) or read.isdisjoint(others))
        if of_this_half:
            rows[list(numbers)] = 1.0
    return moved, rows


def point_slopes(mechanism: Mechanism, y: Array, slopes: Array, way: Way) -> dict[str, Array]:
    """The derivative of every point, (..., N, 3), mm per rad, mm or unit, from that of the coordinates."""
    series = point_series(mechanism, np.stack([y, slopes], axis=-2))
    moved = {name: each[..., 1, :] for name, each in series.items()}
    if isinstance(way, ByGap):
        unit = mechanism.unit[..., None]
        moved[GAP] = np.broadcast_to(np.eye(3)[way.axis] * unit, (*y.shape[:-1], 3))
    return moved


def point_series(mechanism: Mechanism, series: Array) -> dict[str, Array]:
    """The series of every point, (..., order + 1, 3), mm, from that of the coordinates."""
    layout, topology = mechanism.layout, mechanism.topology
    found = {name: series[..., list(layout.vector(name))] for name in (*topology.chassis, *topology.moving)}
    for name, carriers in topology.carried.items():
        weights, places = mechanism.carrier_weights[name][..., None, :], (found[one] for one in carriers)
        found[name] = carried_place(weights, *places, product=cross_series)
    return {name: each * mechanism.unit[..., None, None] for name, each in found.items()}
