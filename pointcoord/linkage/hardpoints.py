"""Putting hardpoints on a topology, with every check that can be made before anything is solved."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pointcoord.errors import MechanismError, UnknownName
from pointcoord.linkage.constraints.in_body import Normal, carrier_weights
from pointcoord.linkage.directions import car_directions
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.double_double import PAIRS
from pointcoord.numerics.linear import null_directions

Array = NDArray[np.float64]
AXES = ("up", "right")


def build_mechanism(
    topology: Topology, points: Mapping[str, ArrayLike], directions: Mapping[str, ArrayLike]
) -> Mechanism:
    """Hardpoints put on a topology, checked.

    Args:
        points: every point of the topology, shape (..., 3), mm.
        directions: `up` and `right` of the car, unit vectors, shape (..., 3).
    Raises:
        UnknownName: a point or direction is missing or not part of the topology.
        MechanismError: a coordinate is not finite, a link has no length, or the mechanism is under- or
            over-determined; the message names the free direction or the redundant rows.
    """
    mechanism = drawn_mechanism(topology, points, directions)
    _check_determined(mechanism)
    return mechanism


def drawn_mechanism(
    topology: Topology, points: Mapping[str, ArrayLike], directions: Mapping[str, ArrayLike]
) -> Mechanism:
    """The same without a check that its equations have one solution."""
    _check_names(points, topology.points, "point")
    _check_names(directions, AXES, "direction")
    located = _checked(points, topology.points, "point")
    car = car_directions(**_checked(directions, AXES, "direction"))
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
    scaled = (stack - origin[..., None, :]) / unit[..., None, None]
    vectors = {name: np.ascontiguousarray(scaled[..., i, :]) for i, name in enumerate(located)}
    vectors |= {name: car[name][0] for name in AXES}
    drawing = Drawing(vectors, unit)
    along = {n: drawing.axis(*ends) if ends[0] else car[ends[1]] for n, ends in topology.directions.items()}
    vectors |= {name: high for name, (high, _) in along.items()}
    drawing = Drawing(vectors, unit, {name: low for name, (_, low) in along.items() if low.any()})
    drawn, lacks, doubt = _drawn(topology, drawing)
    return Mechanism(
        topology=topology,
        origin=origin,
        unit=unit,
        drawing=drawing,
        drawn=drawn,
        drawn_lacks=lacks,
        drawn_doubt=doubt,
        carrier_weights={
            name: carrier_weights(drawing, name, Normal("", *carriers))[0]
            for name, carriers in topology.carried.items()
        },
    )


def _check_names(given: Iterable[str], names: Sequence[str], kind: str) -> None:
    for name in given:
        if name not in names:
            raise UnknownName(kind, name, names)


def _checked(given: Mapping[str, ArrayLike], names: Sequence[str], kind: str) -> dict[str, Array]:
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


def _drawn(topology: Topology, drawing: Drawing) -> tuple[Array, Array, Array]:
    """The coordinates y at which the drawing stands, assembled or not, what they lack and their doubt."""
    layout = topology.layout
    batch = np.broadcast_shapes(*(v.shape[:-1] for v in drawing.vectors.values()))
    y, lacks, doubt = (np.zeros((*batch, layout.size)) for _ in range(3))
    y[..., layout.one] = 1.0
    for name in (*layout.moving, *layout.chassis, *layout.directions):
        y[..., layout.span(name)] = drawing.vectors[name]
        if name in drawing.lacks:
            # Two products and their difference, taken twice as exactly, or a difference of points.
            lacks[..., layout.span(name)] = drawing.lacks[name]
            doubt[..., layout.span(name)] = PAIRS
    for constraint in topology.constraints:
        for name, own in constraint.placed(drawing).items():
            place = layout.place(name)
            y[..., place], lacks[..., place], doubt[..., place] = own
    for drive, place in zip(topology.drives, topology.driven, strict=True):
        y[..., place] = drive.drawn(drawing)
    return y, lacks, doubt


def _check_determined(mechanism: Mechanism) -> None:
    topology, layout, system = mechanism.topology, mechanism.layout, mechanism.map
    equations, unknowns = len(system.rows), system.unknowns
    jacobian = system.jacobian(mechanism.drawn).reshape(-1, equations, unknowns)
    worst = 0
    if equations == unknowns:
        singular = np.ravel(mechanism.drawn_factors.singular)
        if not singular.any():
            return
        worst = int(np.argmax(singular))
    jacobian = jacobian[worst]
    free, redundant = null_directions(jacobian)
    problems = []
    names: list[str] = []
    if len(free):
        names = [layout.describe(i) for i in dominant(free)]
        problems.append(f"free at the drawing: {', '.join(names)}")
    if len(redundant):
        rows = [topology.labels[i] for i in dominant(redundant)]
        names += rows
        problems.append(f"redundant or contradictory at the drawing: {', '.join(rows)}")
    lost = dominant(redundant) if len(redundant) else []
    inputs = [
        drive.input
        for drive in topology.drives
        if any(layout.scalar(drive.coordinate) in system.reads[row] for row in lost)
    ]
    if len(set(inputs)) > 1:
        problems.append(f"these inputs may fight: {', '.join(dict.fromkeys(inputs))}")
    advice = "; draw the points named here apart, and off one line or plane" if equations == unknowns else ""
    state = "over" if equations > unknowns else "under" if equations < unknowns else "not"
    raise MechanismError(
        f"{topology.name} is {state}{'-' if state != 'not' else ' '}determined: {unknowns} unknowns, "
        f"{equations} equations; {'; '.join(problems) or 'its equations lose rank at the drawing'}{advice}",
        names,
    )


def dominant(directions: Array) -> list[int]:
    """Indices of the components that take part in null directions, at least a tenth of the largest."""
    weight = np.abs(directions).max(axis=0)
    return [int(i) for i in np.flatnonzero(weight > 0.1 * weight.max())]
