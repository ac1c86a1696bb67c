"""Finds what looks wrong in a drawing although it can be solved: mistaken units, signs and sides.

No rule here refuses a scene: a car may be odd. Each rule reports what is odd, with its value, and what it may
mean, for one drawing or for many designs of a car at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from pointcoord.effects.corner import wheels_of
from pointcoord.effects.effect import Doubt
from pointcoord.effects.registry import ANGLES
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array, Flags

SMALLEST, LARGEST = 50.0, 20_000.0  # mm: no suspension is smaller, and no car longer
# Share of the largest outboard distance of a wheel's points: a rack may end a little beyond the car's middle.
ACROSS = 0.1
# Most times as far from the middle as half of the points: mm read as inches are 25.4 times as far.
FAR = 20.0


def doubts_of_drawings(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> tuple[Doubt, ...]:
    """Every check of drawings, and the drawings that fail it, the one with the largest consequences first.

    Args:
        points: hardpoints, each (..., 3), mm, with the same leading dimensions.
    """
    wheels = [
        angle.doubt(wheel, points, axes.on(wheel.side))
        for wheel in wheels_of(topology, ())
        for angle in ANGLES.values()
        if wheel.role(angle.line)
    ]
    return (
        *_of_size(points),
        *_front_behind_rear(topology, points, axes),
        *_racks_outboard(topology, points, axes),
        _alone_across(topology, points, axes),
        *wheels,
    )


def _of_size(points: Mapping[str, Array]) -> Iterator[Doubt]:
    """A car too small or large, or a point much farther from the median of all than half of them: units."""
    names, places = [*points], np.stack(list(points.values()), axis=-2)
    size = np.ptp(places, axis=-2).max(axis=-1)
    # Points so far off that this overflows are refused with their mechanism.
    with np.errstate(over="ignore"):
        away = np.linalg.norm(places - np.median(places, axis=-2, keepdims=True), axis=-1)
    near = np.median(away, axis=-1)
    yield Doubt(
        ~((size >= SMALLEST) & (size <= LARGEST)),
        lambda one: (
            f"the car is {float(size[one]):.3g} mm long; if its points are in another unit than the scene "
            'states, write units = "mm", "m" or "in" at its top (mm if not given)'
        ),
    )
    yield Doubt(
        away.max(axis=-1) > FAR * near,
        lambda one: (
            f"{names[int(away[one].argmax())]} lies {float(away[one].max()):.5g} mm from the middle of the "
            f"points, and half of them within {float(near[one]):.4g} mm of it: is it drawn in another unit?"
        ),
    )


def _front_behind_rear(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[Doubt]:
    """A front that lies behind a rear: left-handed axes, or names swapped."""
    if not topology.role("front_and_rear"):
        return
    front, rear = topology.role("front_and_rear")
    ahead = axes.component(points[front] - points[rear], "forward")
    forward = (np.round(np.cross(axes.up, axes.right), 6) + 0.0).tolist()
    yield Doubt(
        ahead < 0.0,
        lambda one: (
            f"{front} is drawn {-float(ahead[one]):.4g} mm behind {rear}: by up and right, in right-handed "
            f"axes, the car's front lies towards {forward}; are the two points swapped, is right reversed, "
            "or are your axes left-handed? Angles along the car may have the wrong sign"
        ),
    )


def _racks_outboard(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[Doubt]:
    """A point driven by a travel that lies farther out than the point it pushes: the two ends are swapped.

    If both lie beyond the car's middle, they belong to the other wheel.
    """
    pushed = {drive.pushed for drive in topology.drives}
    links = (ends for constraint in topology.constraints for ends in constraint.squared_lengths)
    for inner, outer in ((one, two) for a, b in links for one, two in ((a, b), (b, a)) if one in pushed):
        one, other = (axes.component(points[name], "outboard") for name in (inner, outer))
        yield _swapped(inner, outer, one - other, np.maximum(one, other) < 0.0)


def _swapped(inner: str, outer: str, out: Array, across: Flags) -> Doubt:
    return Doubt(
        (out > 0.0) & ~across,
        lambda one: f"{inner} lies {float(out[one]):.4g} mm outboard of {outer}: are they swapped?",
    )


def _alone_across(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Doubt:
    """One point clearly beyond the car's middle, all others on the wheel's side: a wrong sign.

    Nothing is reported where a pivot lies at 0: then coordinates are not measured from the car's middle.
    Points with a stand-in are not checked, since they may lie beyond it: a rack's centre lies anywhere.
    """
    names = [name for name in topology.required_points if name in points]
    out = np.stack([axes.component(points[name], "outboard") for name in names], axis=-1)
    clearly = ACROSS * out.max(axis=-1, keepdims=True)
    return Doubt(
        ((out < -clearly).sum(axis=-1) == 1) & ((out > clearly).sum(axis=-1) == len(names) - 1),
        lambda one: (
            f"{names[int(out[one].argmin())]} lies {-float(out[one].min()):.4g} mm beyond the middle of the "
            "car, and no other point of this wheel does: has its coordinate to the right the wrong sign?"
        ),
    )
