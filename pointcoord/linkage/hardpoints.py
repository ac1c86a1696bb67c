"""Builds a mechanism from a topology and hardpoints, with all checks possible before solving."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.in_body import carrier_weights
from pointcoord.linkage.directions import car_directions, direction_of
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import PAIRS
from pointcoord.numerics.infinitesimal import with_slope
from pointcoord.numerics.linear import null_directions
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

AXES = ("up", "right")
# Rounding of a coordinate or squared length, relative to the car's size: two places, half a last digit each.
DRAWN_TO = 4.0 * UNIT_ROUNDOFF


def build_mechanism(
    topology: Topology, points: Mapping[str, ArrayLike], directions: Mapping[str, ArrayLike]
) -> Mechanism:
    """A mechanism from a topology and hardpoints, checked.

    Args:
        points: every point of the topology, finite, shape (..., 3), mm; the scene's checks see to that.
        directions: `up` and `right` of the car, unit vectors, shape (..., 3).
    Raises:
        MechanismError: the car has no usable size, a link has no length, or the equations lose rank in the
            drawing; the message names the free direction and the redundant rows.
    """
    mechanism = drawn_mechanism(topology, points, directions)
    _check_determined(mechanism)
    return mechanism


def drawn_mechanism(
    topology: Topology, points: Mapping[str, ArrayLike], directions: Mapping[str, ArrayLike]
) -> Mechanism:
    """As `build_mechanism`, without the check that the equations have one solution."""
    located = {name: np.array(points[name], dtype=float) for name in topology.points}
    car = car_directions(*(np.array(directions[name], dtype=float) for name in AXES))
    stack = np.stack(np.broadcast_arrays(*located.values()), axis=-2)
    with np.errstate(over="ignore", invalid="ignore"):
        extent = (stack.max(axis=-2) - stack.min(axis=-2)).max(axis=-1)
    if not (np.isfinite(extent).all() and (extent > 1e-100).all() and (extent < 1e100).all()):
        raise MechanismError(
            f"the points span {np.max(extent):.3g} mm; allowed: more than 1e-100 and less than 1e100"
        )
    unit = np.ldexp(1.0, np.frexp(extent)[1])
    # The origin is truncated to a grid of four sizes, so subtracting it is exact: a coordinate is at least
    # three quarters of a nonzero coordinate of the origin, and on the same side of zero.
    grid = 4.0 * unit[..., None]
    origin = np.trunc(stack.mean(axis=-2) / grid) * grid + 0.0
    scaled = (stack - origin[..., None, :]) / unit[..., None, None]
    vectors = {name: np.ascontiguousarray(scaled[..., i, :]) for i, name in enumerate(located)}
    vectors |= {name: car[name][0] for name in AXES}
    drawing = Drawing(vectors, unit)
    along = {
        name: drawing.axis(start, end) if start else direction_of(car, end)
        for name, (start, end) in topology.directions.items()
    }
    vectors |= {name: high for name, (high, _) in along.items()}
    drawing = Drawing(vectors, unit, {name: low for name, (_, low) in along.items() if low.any()})
    drawn, lacks, doubt = _drawn(topology, drawing)
    if topology.left_out:
        # Rows that are left out follow from the others only to the rounding of the drawing.
        far = 1.0 + np.abs(origin).max(axis=-1) / unit
        doubt[..., topology.layout.one + 1 :] += DRAWN_TO * far[..., None]
    return Mechanism(
        topology=topology,
        origin=origin,
        unit=unit,
        drawing=drawing,
        drawn=drawn,
        drawn_lacks=lacks,
        drawn_doubt=doubt,
        carrier_weights=_carrier_weights(topology, drawing),
    )


def hardpoints_moved(mechanism: Mechanism, moves: Mapping[str, Array]) -> Mechanism:
    """A mechanism with the derivatives of everything computed from its drawing (see `infinitesimal`).

    For a drawing that is not closed, the derivatives are those of the drawing as it is: closing it only moves
    its points to where these known coordinates require.

    Args:
        mechanism: a single car.
        moves: hardpoint -> change of its place with each of K parameters, (K, 3), mm; for all hardpoints.
    Returns:
        The mechanism with slopes in its numbers, with the batch dimensions (K, 1).
    """
    drawing, topology = mechanism.drawing, mechanism.topology
    vectors = dict(drawing.vectors)
    for name, move in moves.items():
        vectors[name] = with_slope(vectors[name], move[:, None] / mechanism.unit)
    for name, (start, end) in topology.directions.items():
        if start:
            vectors[name] = Drawing(vectors, drawing.unit).axis(start, end)[0]
    moved = Drawing(vectors, drawing.unit, drawing.lacks)
    drawn = _drawn(topology, moved)[0]
    return replace(mechanism, drawing=moved, drawn=drawn, carrier_weights=_carrier_weights(topology, moved))


def _carrier_weights(topology: Topology, drawing: Drawing) -> dict[str, Array]:
    """Weights of every carried point."""
    return {name: carrier_weights(drawing, name, carriers)[0] for name, carriers in topology.carried.items()}


def _drawn(topology: Topology, drawing: Drawing) -> tuple[Array, Array, Array]:
    """The coordinates y of the drawing, assembled or not; their rounding error; and their uncertainty."""
    layout = topology.layout
    batch = np.broadcast_shapes(*(v.shape[:-1] for v in drawing.vectors.values()))
    kind = np.result_type(*drawing.vectors.values())
    y, lacks, doubt = (np.zeros((*batch, layout.size), kind) for _ in range(3))
    y[..., layout.one] = 1.0
    for name in (*layout.moving, *layout.chassis, *layout.directions):
        y[..., layout.span(name)] = drawing.vectors[name]
        if name in drawing.lacks:
            # Either two products and their difference in twice the precision, or a difference of points.
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
    assert len(system.rows) == system.unknowns  # a scene has as many inputs as freedoms
    singular = np.ravel(mechanism.drawn_factors.singular)
    if not singular.any():
        return
    jacobian = system.jacobian(mechanism.drawn).reshape(-1, system.unknowns, system.unknowns)
    free, lost = (dominant(each) for each in null_directions(jacobian[int(np.argmax(singular))]))
    coordinates, rows = [layout.describe(i) for i in free], [topology.labels[i] for i in lost]
    driving = [
        drive.input
        for drive in topology.drives
        if any(layout.scalar(drive.coordinate) in system.reads[row] for row in lost)
    ]
    inputs = list(dict.fromkeys(driving))
    problems = [
        *([f"free in the drawing: {', '.join(coordinates)}"] if free else []),
        *([f"redundant or contradictory in the drawing: {', '.join(rows)}"] if lost else []),
        *([f"these inputs may drive the same freedom: {', '.join(inputs)}"] if len(inputs) > 1 else []),
    ]
    raise MechanismError(
        f"{topology.name} is not determined: {'; '.join(problems) or 'its equations lose rank there'}; "
        "draw the points named here apart, and off one line or plane",
        [*coordinates, *rows],
    )


def dominant(directions: Array) -> list[int]:
    """Indices of the components that are at least a tenth of the largest in some null direction."""
    if not len(directions):
        return []
    weight = np.abs(directions).max(axis=0)
    return [int(i) for i in np.flatnonzero(weight > 0.1 * weight.max())]
