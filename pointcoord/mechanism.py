r"""A mechanism: a topology, which is data, and the hardpoints of one car or of a batch of cars.

Lengths are measured from an origin near the mechanism in a power of two that is its size, so that
neither the distance from the user's origin nor the size of the car costs a digit, and scaling by a
power of two changes no bit of a result.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.constraints import Constraint, Link, OnLine
from pointcoord.drives import Drawing, Drive
from pointcoord.errors import MechanismError, UnknownName
from pointcoord.layout import Layout
from pointcoord.linear import factorise, null_directions
from pointcoord.quadratic import QuadraticMap, quadratic_map

Array = NDArray[np.float64]

EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class Topology:
    """What is joined to what; no numbers of a particular car.

    Attributes:
        chassis: points that the chassis carries. moving: points to be solved for.
        bodies: points of each body of three or more points whose rates are of interest.
        carried: points that ride on a body and constrain nothing, with the three points that carry them.
        directions: unit vectors that the chassis carries.
        constraints: links, slides, rack, driven heights.
        drives: the inputs that drive a coordinate.
        chassis_motion: inputs that move the whole chassis, each along a direction, zero if not given.
    """

    name: str
    chassis: tuple[str, ...]
    moving: tuple[str, ...]
    bodies: Mapping[str, tuple[str, ...]]
    carried: Mapping[str, tuple[str, str, str]]
    directions: tuple[str, ...]
    constraints: tuple[Constraint, ...]
    drives: tuple[Drive, ...]
    chassis_motion: Mapping[str, str] = field(default_factory=dict)

    @property
    def points(self) -> tuple[str, ...]:
        """Every point that a car of this kind needs."""
        return (*self.chassis, *self.moving, *self.carried)

    @property
    def required_inputs(self) -> tuple[str, ...]:
        """Inputs that must be given."""
        return tuple(drive.input for drive in self.drives)

    @property
    def inputs(self) -> tuple[str, ...]:
        """Every input that may be given."""
        return (*self.required_inputs, *self.chassis_motion)

    @property
    def labels(self) -> tuple[str, ...]:
        """A name for each row of the map."""
        return tuple(label for constraint in self.constraints for label in constraint.labels)

    @cached_property
    def layout(self) -> Layout:
        """The order of the coordinates."""
        slides = [c for c in self.constraints if isinstance(c, OnLine)]
        links = [c for c in self.constraints if isinstance(c, Link)]
        return Layout(
            moving=self.moving,
            ratios=tuple(slide.ratio for slide in slides),
            chassis=self.chassis,
            directions=self.directions,
            driven=tuple(drive.coordinate for drive in self.drives),
            squared_lengths=tuple((link.start, link.end) for link in links),
        )

    @cached_property
    def map(self) -> QuadraticMap:
        """All constraints as one quadratic map; the same for every car of this topology."""
        rows = [row for constraint in self.constraints for row in constraint.rows(self.layout)]
        return quadratic_map(rows, self.layout.unknowns, self.layout.size)


@dataclass(frozen=True)
class Mechanism:
    """A topology with hardpoints; build it with `build_mechanism`.

    Attributes:
        origin: where its coordinates are measured from, shape (..., 3), mm.
        unit: the length that is 1 in its coordinates, a power of two, shape (...,), mm.
        drawing: its drawn points and its directions in its own coordinates.
        drawn: the coordinates y of the drawing, shape (..., size).
        carrier_weights: place of each carried point in the frame of its three carriers, shape (..., 3).
    """

    topology: Topology
    origin: Array
    unit: Array
    drawing: Drawing
    drawn: Array
    carrier_weights: Mapping[str, Array]

    @property
    def layout(self) -> Layout:
        """The order of the coordinates."""
        return self.topology.layout

    @property
    def map(self) -> QuadraticMap:
        """The constraints."""
        return self.topology.map

    def known_series(self, inputs: Mapping[str, Array]) -> Array:
        """Series of all known coordinates from the series of the inputs.

        Args:
            inputs: coefficients of each input, shape (..., order + 1), rad or mm per s**k; inputs that
                move the chassis may be missing and are then zero.
        Returns:
            Coefficients, shape (..., order + 1, known coordinates), in the mechanism's units.
        Raises:
            UnknownName: an input that this topology does not have, or one that is missing.
        """
        topology, layout = self.topology, self.layout
        for name in inputs:
            if name not in topology.inputs:
                raise UnknownName("input", name, topology.inputs)
        for name in topology.required_inputs:
            if name not in inputs:
                raise UnknownName("given input", name, inputs)
        sample = inputs[topology.required_inputs[0]]
        batch = np.broadcast_shapes(sample.shape[:-1], self.drawn.shape[:-1])
        known = np.zeros((*batch, sample.shape[-1], layout.size - layout.unknowns))
        known[..., 0, :] = self.drawn[..., layout.unknowns :]
        for drive in topology.drives:
            place = layout.scalar(drive.coordinate) - layout.unknowns
            known[..., place] = drive.series(inputs[drive.input], self.drawing)
        shift = self.chassis_shift(inputs)
        if shift is not None:
            for point in topology.chassis:
                known[..., [i - layout.unknowns for i in layout.vector(point)]] += shift
        return known

    def chassis_shift(self, inputs: Mapping[str, Array]) -> Array | None:
        """Series of the chassis' displacement, (..., order + 1, 3), in units; None if it stands still."""
        shift: Array | None = None
        for name, direction in self.topology.chassis_motion.items():
            if name in inputs:
                along = (inputs[name] / np.asarray(self.unit)[..., None])[..., None]
                moved = along * self.drawing.vectors[direction][..., None, :]
                shift = moved if shift is None else shift + moved
        return shift

    def input_values(self, known: Array) -> dict[str, float]:
        """The inputs that belong to known coordinates of one pose, shape (known coordinates,)."""
        first = self.layout.unknowns
        return {
            drive.input: float(
                drive.input_value(known[self.layout.scalar(drive.coordinate) - first], self.drawing)
            )
            for drive in self.topology.drives
        }

    def known_uncertainty(self, y: Array) -> Array:
        """Rounding of the known coordinates when inputs become coordinates, shape (..., size).

        Driven coordinates take a cosine or a quotient and a product (4 units of rounding cover them),
        moved chassis points a product and a sum, squared lengths one rounding; the rest is exact.
        """
        layout = self.layout
        uncertainty = np.zeros_like(y)
        for drive in self.topology.drives:
            place = layout.scalar(drive.coordinate)
            reach = np.abs(y[..., place])
            uncertainty[..., place] = 2 * EPS * np.maximum(reach, np.abs(self.drawn[..., place]))
        for point in self.topology.chassis:
            places = list(layout.vector(point))
            moved = np.abs(y[..., places] - self.drawn[..., places])
            uncertainty[..., places] = np.where(moved > 0.0, EPS * (np.abs(y[..., places]) + moved), 0.0)
        links = layout.size - len(layout.squared_lengths)
        uncertainty[..., links:] = 4 * EPS * y[..., links:]
        return uncertainty


def build_mechanism(
    topology: Topology, points: Mapping[str, ArrayLike], directions: Mapping[str, ArrayLike]
) -> Mechanism:
    """Hardpoints put on a topology, checked.

    Args:
        points: every point of the topology, shape (..., 3), mm.
        directions: every direction of the topology, unit vectors, shape (..., 3).
    Raises:
        UnknownName: a point or direction is missing or not part of the topology.
        MechanismError: a coordinate is not finite, a link has no length, or the mechanism is under- or
            over-determined; the message names the free direction or the redundant rows.
    """
    located = _checked(points, topology.points, "point")
    turned = _checked(directions, topology.directions, "direction")
    stack = np.stack(np.broadcast_arrays(*located.values()), axis=-2)
    with np.errstate(over="ignore", invalid="ignore"):
        extent = (stack.max(axis=-2) - stack.min(axis=-2)).max(axis=-1)
    if not (np.isfinite(extent).all() and (extent > 1e-100).all() and (extent < 1e100).all()):
        raise MechanismError(
            f"the points span {np.max(extent):.3g} mm; allowed: more than 1e-100 and less than 1e100"
        )
    unit = np.ldexp(1.0, np.frexp(extent)[1])
    # Truncated to a grid of four sizes, the origin is subtracted without rounding: a coordinate is
    # never less than three quarters of a nonzero origin's, and never on the other side of zero.
    grid = 4.0 * unit[..., None]
    origin = np.trunc(stack.mean(axis=-2) / grid) * grid + 0.0
    vectors = {name: (p - origin) / unit[..., None] for name, p in located.items()} | turned
    drawing = Drawing(vectors, unit)
    mechanism = Mechanism(
        topology=topology,
        origin=origin,
        unit=unit,
        drawing=drawing,
        drawn=_drawn(topology, drawing),
        carrier_weights={
            name: _carrier_weights(name, drawing, carriers) for name, carriers in topology.carried.items()
        },
    )
    _check_determined(mechanism)
    return mechanism


def _checked(given: Mapping[str, ArrayLike], names: Sequence[str], kind: str) -> dict[str, Array]:
    for name in given:
        if name not in names:
            raise UnknownName(kind, name, names)
    result: dict[str, Array] = {}
    for name in names:
        if name not in given:
            raise MechanismError(f"{kind} {name!r} is missing; needed: {', '.join(names)}", [name])
        array = np.array(given[name], dtype=float)
        if array.shape[-1:] != (3,) or not np.isfinite(array).all():
            raise MechanismError(
                f"{kind} {name!r} is {array.tolist()}; allowed: three finite numbers", [name]
            )
        result[name] = array
    return result


def _drawn(topology: Topology, drawing: Drawing) -> Array:
    """The coordinates y at which the drawing stands, whether or not it is assembled."""
    layout = topology.layout
    batch = np.broadcast_shapes(*(v.shape[:-1] for v in drawing.vectors.values()))
    y = np.zeros((*batch, layout.size))
    y[..., layout.one] = 1.0
    for name in (*layout.moving, *layout.chassis, *layout.directions):
        y[..., list(layout.vector(name))] = drawing.vectors[name]
    for constraint in topology.constraints:
        if isinstance(constraint, OnLine):
            start = drawing.vectors[constraint.start]
            line = drawing.vectors[constraint.end] - start
            reach = np.sum((drawing.vectors[constraint.point] - start) * line, axis=-1)
            square = np.sum(line * line, axis=-1)
            if not (square > 0.0).all():
                raise _no_length(constraint.start, constraint.end)
            y[..., layout.scalar(constraint.ratio)] = reach / square
        elif isinstance(constraint, Link):
            difference = drawing.vectors[constraint.start] - drawing.vectors[constraint.end]
            square = np.sum(difference * difference, axis=-1)
            if not (square > 0.0).all():
                raise _no_length(constraint.start, constraint.end)
            y[..., layout.squared_length(constraint.start, constraint.end)] = square
    for drive in topology.drives:
        y[..., layout.scalar(drive.coordinate)] = drive.drawn(drawing)
    return y


def _no_length(start: str, end: str) -> MechanismError:
    return MechanismError(
        f"link {start} - {end} has no length: both points are at the same place; move one", [start, end]
    )


def _carrier_weights(name: str, drawing: Drawing, carriers: tuple[str, str, str]) -> Array:
    """(a, b, c) with p - p_0 = a e1 + b e2 + c e1 x e2 for the edges e of the carrying triangle."""
    base, first, second = (drawing.vectors[point] for point in carriers)
    e1, e2 = first - base, second - base
    frame = np.stack(np.broadcast_arrays(e1, e2, np.cross(e1, e2)), axis=-1)
    lengths = np.linalg.norm(e1, axis=-1) * np.linalg.norm(e2, axis=-1)
    area = np.linalg.norm(np.cross(e1, e2), axis=-1)
    if not (area > 8 * EPS * lengths).all():
        raise MechanismError(
            f"{', '.join(carriers)} lie in one line, so they cannot carry {name}; move one off the line",
            carriers,
        )
    offset = np.broadcast_to(drawing.vectors[name] - base, frame.shape[:-1])
    return np.asarray(np.linalg.solve(frame, offset[..., None])[..., 0])


def _check_determined(mechanism: Mechanism) -> None:
    topology, layout, system = mechanism.topology, mechanism.layout, mechanism.map
    equations, unknowns = len(system.rows), system.unknowns
    jacobian = system.jacobian(mechanism.drawn)
    if equations == unknowns:
        singular = factorise(jacobian).singular
        if not singular.any():
            return
        jacobian = jacobian[tuple(np.argwhere(singular)[0])]
    else:
        jacobian = jacobian.reshape(-1, equations, unknowns)[0]
    free, redundant = null_directions(jacobian)
    problems = []
    names: list[str] = []
    if len(free):
        names = [layout.describe(i) for i in _dominant(free)]
        problems.append(f"free at the drawing: {', '.join(names)}")
    if len(redundant):
        rows = [topology.labels[i] for i in _dominant(redundant)]
        names += rows
        problems.append(f"redundant or contradictory at the drawing: {', '.join(rows)}")
    state = "over" if equations > unknowns else "under" if equations < unknowns else "not"
    raise MechanismError(
        f"{topology.name} is {state}{'-' if state != 'not' else ' '}determined: {unknowns} unknowns, "
        f"{equations} equations; {'; '.join(problems) or 'its equations lose rank at the drawing'}",
        names,
    )


def _dominant(directions: Array) -> list[int]:
    """Indices of the components that take part in null directions, at least a tenth of the largest."""
    weight = np.abs(directions).max(axis=0)
    return [int(i) for i in np.flatnonzero(weight > 0.1 * weight.max())]
