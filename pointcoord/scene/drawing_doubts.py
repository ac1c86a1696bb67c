"""What looks wrong with a drawing although it can be solved: units, signs and sides mistaken, in words.

No rule here refuses anything: a car may be odd. Each says what is odd, with its value, and what it may mean,
of one drawing or of many designs of a car at once.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.corner import wheels_of
from pointcoord.effects.effect import Doubt
from pointcoord.effects.registry import ANGLES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.topology import Topology

Array = NDArray[np.float64]

SMALLEST, LARGEST = 50.0, 20_000.0  # mm: no suspension is smaller, and no car longer
# Of how far out a wheel's points reach: a rack may end a little across the middle of the car.
ACROSS = 0.1


def drawing_doubts(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> tuple[str, ...]:
    """What looks wrong with one drawing, in the order of how much it changes.

    Args:
        topology: of a car that gives these points.
        points: hardpoints, each (3,), mm.
    """
    return tuple(doubt.words(()) for doubt in doubts_of_drawings(topology, points, axes) if doubt.where)


def doubts_of_drawings(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> tuple[Doubt, ...]:
    """What is looked at in drawings, in the order of how much it changes, and those in which it looks wrong.

    Args:
        points: hardpoints, each (..., 3), mm, with the same leading dimensions.
    """
    every = np.stack(list(points.values()), axis=-2)
    size = np.ptp(every, axis=-2).max(axis=-1)
    doubts = [
        Doubt(
            ~((size >= SMALLEST) & (size <= LARGEST)),
            lambda one: (
                f"the car is {float(size[one]):.3g} mm long: points are in mm; are these in another unit, "
                'which units = "m" or "in" at the top of the scene would say?'
            ),
        ),
        *_front_behind_rear(topology, points, axes),
        *_racks_outboard(topology, points, axes),
        _alone_across(topology, points, axes),
    ]
    for wheel in wheels_of(topology, ()):
        angles = (angle for angle in ANGLES.values() if wheel.role(angle.line))
        doubts += [angle.doubt(wheel, points, axes.on(wheel.side)) for angle in angles]
    return tuple(doubts)


def _front_behind_rear(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[Doubt]:
    """A front that lies behind a rear: axes that are not right-handed, or names mistaken."""
    if not topology.role("front_and_rear"):
        return
    front, rear = topology.role("front_and_rear")
    ahead = axes.component(points[front] - points[rear], "forward")

    def words(one: tuple[int, ...]) -> str:
        forward = np.round(np.cross(axes.up, axes.right), 6) + 0.0
        return (
            f"{front} is drawn {-float(ahead[one]):.4g} mm behind {rear}: by up and right the car's front "
            f"lies towards {forward.tolist()}, as in right-handed axes; are these two swapped, is right "
            "turned round, or are your axes left-handed? Angles along the car may have the wrong sign"
        )

    yield Doubt(ahead < 0.0, words)


def _racks_outboard(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Iterator[Doubt]:
    """What is driven by a travel and lies farther out than what it pushes: two ends mistaken.

    Both across the middle of the car, they are another wheel's.
    """
    pushed = {drive.pushed for drive in topology.drives}
    links = (ends for constraint in topology.constraints for ends in constraint.squared_lengths)
    for inner, outer in ((one, two) for a, b in links for one, two in ((a, b), (b, a)) if one in pushed):
        one, other = (axes.component(points[name], "outboard") for name in (inner, outer))
        yield _farther_out(inner, outer, one - other, np.maximum(one, other) < 0.0)


def _farther_out(inner: str, outer: str, out: Array, across: NDArray[np.bool_]) -> Doubt:
    return Doubt(
        (out > 0.0) & ~across,
        lambda one: f"{inner} lies {float(out[one]):.4g} mm outboard of {outer}: are they swapped?",
    )


def _alone_across(topology: Topology, points: Mapping[str, Array], axes: CarAxes) -> Doubt:
    """One point clearly on the other side of the car's middle than all the others: a sign mistaken.

    Where a pivot lies at 0 the drawing is not counted from the middle. A point that another may stand in for
    need not be one of this wheel: the rack's own lies anywhere along it.
    """
    names = [name for name in topology.required_points if name in points]
    out = np.stack([axes.component(points[name], "outboard") for name in names], axis=-1)
    clearly = ACROSS * out.max(axis=-1, keepdims=True)
    alone = ((out < -clearly).sum(axis=-1) == 1) & ((out > clearly).sum(axis=-1) == len(names) - 1)

    def words(one: tuple[int, ...]) -> str:
        at = int(out[one].argmin())
        return (
            f"{names[at]} lies {-float(out[one][at]):.4g} mm across the middle of the car, and no other "
            "point of this wheel does: has its coordinate to the right the wrong sign?"
        )

    return Doubt(alone, words)
