"""From the states of points to what a scene asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.effect import Poses
from pointcoord.effects.plan import Plan
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.chassis import ChassisMotion
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.results.samples import Channel, Samples

Array = NDArray[np.float64]
States = Sequence[Mapping[str, Array]]
"""For each time derivative, the points' states of shape (..., N, 3), mm, in the chassis' frame, from the
mechanism's origin."""


@dataclass(frozen=True)
class Readout:
    """How states become results.

    Attributes:
        plan: the effects to compute.
        chassis: what it does, which is added to the points' states.
        axes: the car's, along which angles are measured.
    """

    mechanism: Mechanism
    plan: Plan
    chassis: ChassisMotion
    axes: CarAxes

    @property
    def derivatives(self) -> dict[str, int]:
        """Highest time derivative that is evaluated of each point."""
        return self.plan.derivatives(self.mechanism.topology)

    @property
    def derivative_of_every_point(self) -> int:
        """Highest time derivative that is evaluated of every point."""
        return min(self.derivatives.values())

    def samples(self, times: Array, states: States) -> Samples:
        """Compute the effects of the plan from states, and name the numbers."""
        shifts = self.chassis.states(times, self.derivative_of_every_point)
        rest = [None] * (len(states) - 1)
        added = (self.offset(times), *(shifts[1:] or rest))
        poses = Poses(self.mechanism, self.axes, states, added)
        found: dict[str, dict[str, Array]] = {quantity: {} for quantity in QUANTITIES}
        for effect in self.plan.computed:
            for quantity, arrays in effect.evaluate(poses).items():
                found[quantity] |= arrays
        numbers = {name: Channel(QUANTITIES[name], found[name], self._left_out(name)) for name in found}
        return Samples(times.copy(), numbers)

    def _left_out(self, quantity: str) -> dict[str, tuple[str, ...] | None]:
        """The effects that would give more of a quantity, and what each gives of it."""
        others = (EFFECTS[name] for name in self.plan.left_out)
        return {
            other.name: other.gives_numbers[quantity] for other in others if quantity in other.gives_numbers
        }

    def offset(self, times: Array) -> Array | None:
        """What is added to every position, the origin and the chassis' displacement; None if it is zero."""
        origin = self.mechanism.origin[..., None, :]
        shift = self.chassis.states(times, 0)
        if not shift:
            return origin if origin.any() else None
        return origin + shift[0]
