"""The numbers of one quantity by two formulations, their differences and tolerances."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.registry import QUANTITIES
from pointcoord.scene.scene_file import Scene
from validate.comparison.tolerance import largest_numbers, level, tolerance, untested
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import NOTHING, Solution

Array = NDArray[np.float64]
# Numbers below the smallest normal double lose digits, and so do tolerances computed from them.
SMALLEST = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Held:
    """The numbers of one point, body or angle by both formulations; each array (N, components).

    Attributes:
        numbers: numbers of both formulations.
        claims: error bounds of both formulations, 0 if one gives no bound.
        claimed: whether both give an error bound.
        gap: absolute difference; infinite where only one of the two is a number.
        allowed: tolerance.
        share: difference / tolerance, 0 where the numbers are equal.
    """

    name: str
    numbers: tuple[Array, Array]
    claims: tuple[Array, Array]
    claimed: bool
    gap: Array
    allowed: Array
    share: Array


@dataclass(frozen=True)
class Pair:
    """A quantity of two formulations at the same instants.

    Attributes:
        factor: factor on the derived tolerances.
    """

    quantity: str
    sides: tuple[Solution, Solution]
    factor: float

    @cached_property
    def names(self) -> list[str]:
        """The points, bodies or angles of which both have numbers; empty without instants."""
        one, two = (side.numbers[self.quantity] for side in self.sides)
        return [name for name in one if name in two] if len(self.sides[0].times) else []

    @cached_property
    def _largest(self) -> list[Array]:
        """The largest number of each side at each instant, (N,)."""
        return [largest_numbers(side.numbers[self.quantity].values(), len(side.times)) for side in self.sides]

    @cached_property
    def _levels(self) -> list[Array]:
        """The error level of each side at each instant, (N,), see `tolerance.level`."""
        return [
            level(own.claims[self.quantity].values(), most, own.condition, own.usual.get(self.quantity))
            for own, most in zip((side.accuracy for side in self.sides), self._largest, strict=True)
        ]

    @cached_property
    def _blind(self) -> list[NDArray[np.bool_] | None]:
        """The instants at which the stated accuracy of each side gives no bound, (N,); None: none stated."""
        return [side.accuracy.blind for side in self.sides]

    def held(self, name: str) -> Held:
        """Numbers, differences and tolerances of one of the names."""
        mine, other = (_columns(side.numbers[self.quantity][name]) for side in self.sides)
        claimed = [side.accuracy.claims[self.quantity].get(name) for side in self.sides]
        own, others = (np.zeros_like(mine) if claim is None else _columns(claim) for claim in claimed)
        gap = gaps_between(mine, other, QUANTITIES[self.quantity].unit)
        # One side has a number, the other NaN: the number does not exist (0/0) if its error bound is NOTHING.
        lone = np.where(np.isnan(mine), others, np.where(np.isnan(other), own, 0.0))
        gap[lone >= NOTHING] = 0.0
        # The smaller of both largest numbers, so that a wrong number does not widen its own tolerance.
        allowed = self.factor * tolerance(own, others, min(float(most.max()) for most in self._largest))
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(gap == 0.0, 0.0, gap / (allowed + SMALLEST))
        return Held(
            name=name,
            numbers=(mine, other),
            claims=(own, others),
            claimed=all(claim is not None for claim in claimed),
            gap=gap,
            allowed=allowed,
            share=share,
        )

    def wide(self, held: Held) -> NDArray[np.bool_]:
        """The instants at which the tolerance is too wide to test anything, (N,)."""
        # An accuracy that was stated beforehand may be coarse: a wide bound from it still tests.
        stated = [blind for blind in self._blind if blind is not None]
        if stated:
            return np.asarray(np.any(stated, axis=0))
        one, two = (claim.max(axis=-1) for claim in held.claims)
        return untested(one, two, *self._levels)

    def tells(self, scene: Scene, held: Held) -> bool:
        """Whether the agreement of a number tests the solver: the data given to the solver would not agree.

        Only a solver with a stated accuracy is examined; otherwise True. The solver is given the drawn place
        of each point; for a point of the chassis this place is the answer. Instants at which the stated
        accuracy gives no bound do not count.
        """
        stated = [blind is not None for blind in self._blind]
        if stated[0] == stated[1]:
            return True
        solver, other = (0, 1) if stated[0] else (1, 0)
        kind, part, unseen = QUANTITIES[self.quantity], scene.mechanism, np.asarray(self._blind[solver])
        if kind.of == "point" and held.name in part.topology.chassis:
            return False
        if per_second(self.quantity):
            given_back = np.zeros(3)
        elif kind.of == "point" and held.name in part.points:
            given_back = np.array(part.points[held.name], dtype=float)
        else:
            return not unseen.all()
        width = self.factor * tolerance(*held.claims, float(self._largest[other].max()))
        return bool((np.abs(held.numbers[other] - given_back) > width)[~unseen].any())


def gaps_between(mine: Array, other: Array, unit: str) -> Array:
    """Absolute differences of two arrays, number by number; infinite where only one of them is a number."""
    gap = np.abs(mine - other)
    if unit == "rad":
        # Angles that differ by a whole turn are equal.
        gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))
    # A NaN is a disagreement, and the worst one.
    gap[~np.isfinite(gap)] = np.inf
    # Two NaN agree: neither has a number, as for a centre at infinity.
    gap[np.isnan(mine) & np.isnan(other)] = 0.0
    return np.asarray(gap)


def _columns(array: Array) -> Array:
    return array.reshape(len(array), -1)
