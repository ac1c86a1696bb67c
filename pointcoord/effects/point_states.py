"""The position of every point, which every motion reports, and its time derivatives, one effect for each."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Effect, Poses, Quantity
from pointcoord.linkage.topology import Topology

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses, Numbers

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PointStates(Effect):
    """The time derivative of order `derivative` of every point's position."""

    @property
    def base(self) -> str:
        """The position, for a derivative without a name of its own; else empty."""
        return "" if self.derivative < len(NAMED) else NAMED[0]

    @property
    def reports_states(self) -> bool:
        return True

    def needs(self, topology: Topology) -> Collection[str]:
        return topology.points

    def evaluate(self, poses: Poses) -> dict[str, dict[str, Array]]:
        """The states plus the user's origin and the chassis' displacement, each (..., N, 3)."""
        states, added = poses.states[self.derivative], poses.added[self.derivative]
        reported = {name: state if added is None else state + added for name, state in states.items()}
        return {self._quantity: reported}

    def errors(self, poses: EnclosedPoses, numbers: Numbers) -> dict[str, dict[str, Array]]:
        """Distances of the reported states from the exact ones, with the expected rounding of a sum."""
        errors = {
            name: poses.reported(name, self.derivative).errors(reported)
            for name, reported in numbers[self._quantity].items()
        }
        return {self._quantity: errors}

    @property
    def _quantity(self) -> str:
        (quantity,) = self.quantities
        return quantity.name


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
        sign="components along the user's axes",
        derivative=derivative,
        quantities=(Quantity(name, words, unit, "point"),),
    )


POSITION, *RATES = map(_states, range(HIGHEST + 1))

STATES = tuple(effect.name for effect in (POSITION, *RATES))
"""The names of all states, by order."""
FIRST_NUMBERED = STATES[len(NAMED)]
