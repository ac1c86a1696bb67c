"""The position of every point, which every motion reports, and its time derivatives, one effect for each."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pointcoord.effects.effect import ALONG, Effect, Poses, Quantity
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers


@dataclass(frozen=True, eq=False)
class PointStates(Effect):
    """The time derivative of order `derivative` of every point's position.

    Its base is the position if the derivative has no name of its own.
    """

    def needs(self, topology: Topology) -> Collection[str]:
        return topology.points

    def evaluate(self, poses: Poses | EnclosedPoses) -> dict[str, dict[str, Any]]:
        """The states, each (..., N, 3), without the user's origin and the displacement of the chassis."""
        return {self.quantities[0].name: dict(poses.points[self.derivative])}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Distances of the reported states from the exact ones, with the expected rounding of a sum."""
        of, quantity = self.derivative, self.quantities[0].name
        errors = {name: poses.reported(name, of).errors(each) for name, each in numbers[quantity].items()}
        return {quantity: errors}


NAMED = ("position", "velocity", "acceleration", "jerk", "snap", "crackle", "pop")
"""The derivatives that have names, in order."""
HIGHEST = 20
"""Error bounds of doubles grow with each order. At this order, at least five digits are proven in the shipped
scenes, except for Bricard's redundant rows; at the thirtieth there may be none."""


def _states(derivative: int) -> PointStates:
    named = derivative < len(NAMED)
    name = NAMED[derivative] if named else f"derivative_{derivative}"
    words = name if named else f"{derivative}th derivative"
    unit = ("mm", "mm/s")[derivative] if derivative < 2 else f"mm/s^{derivative}"
    return PointStates(
        name=name,
        gives=f"{words} of every point, {unit}",
        derivative=derivative,
        quantities=(Quantity(name, words, unit, "point", sign=ALONG),),
        base="" if named else NAMED[0],
        reports_states=True,
    )


POSITION, *RATES = map(_states, range(HIGHEST + 1))

STATES = tuple(effect.name for effect in (POSITION, *RATES))
"""The names of all states, by order."""
FIRST_NUMBERED = STATES[len(NAMED)]
