"""Putting hardpoints on a topology, with every check that can be made before anything is solved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.constraints import Link, OnLine
from pointcoord.doubled import exact_square
from pointcoord.drives import Drawing
from pointcoord.errors import MechanismError, UnknownName
from pointcoord.linear import EPS, factorise, null_directions
from pointcoord.mechanism import Mechanism
from pointcoord.topology import Topology

Array = NDArray[np.float64]


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
    drawn = _drawn(topology, drawing)
    mechanism = Mechanism(
        topology=topology,
        origin=origin,
        unit=unit,
        drawing=drawing,
        drawn=drawn,
        drawn_lacks=_drawn_lacks(topology, drawing, drawn),
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


def _drawn_lacks(topology: Topology, drawing: Drawing, drawn: Array) -> Array:
    """The rounding of the squared lengths, five units at most; the rest of the drawing is not rounded."""
    lacks = np.zeros_like(drawn)
    for start, end in topology.layout.squared_lengths:
        place = topology.layout.squared_length(start, end)
        square, rest = exact_square(drawing.vectors[start], drawing.vectors[end])
        lacks[..., place] = (square - drawn[..., place]) + rest
    return lacks


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
