"""A quantity of two formulations: their numbers row by row, and what a difference is held to."""

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
# Numbers below the smallest normal one lose digits, and so do tolerances made of them.
SMALLEST = float(np.finfo(float).tiny)


@dataclass(frozen=True)
class Held:
    """The numbers of one point, body or angle by both formulations; each array (N, components).

    Attributes:
        numbers: of both. claims: what both claim of them, 0 where one claims nothing.
        claimed: whether both claim something.
        gap: the difference; infinite where one alone is no number.
        allowed: what it is held to. share: it in parts of that, 0 where nothing differs.
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
        factor: how many times the derived tolerance to hold differences to.
    """

    quantity: str
    sides: tuple[Solution, Solution]
    factor: float

    @cached_property
    def names(self) -> list[str]:
        """Those of which both have numbers, at one instant at least."""
        one, two = (side.numbers[self.quantity] for side in self.sides)
        return [name for name in one if name in two] if len(self.sides[0].times) else []

    @cached_property
    def _largest(self) -> list[Array]:
        """Of both sides the largest number at each instant, (N,)."""
        return [largest_numbers(side.numbers[self.quantity].values(), len(side.times)) for side in self.sides]

    @cached_property
    def _levels(self) -> list[Array]:
        """What both would claim of any number, see `tolerance.level`, (N,)."""
        return [
            level(own.claims[self.quantity].values(), most, own.condition, own.usual.get(self.quantity))
            for own, most in zip((side.accuracy for side in self.sides), self._largest, strict=True)
        ]

    @cached_property
    def _blind(self) -> list[NDArray[np.bool_] | None]:
        """Of both at which instants an accuracy that was stated says nothing, (N,); None: none was."""
        return [side.accuracy.blind for side in self.sides]

    def held(self, name: str) -> Held:
        """The numbers of one of the names."""
        mine, other = (_columns(side.numbers[self.quantity][name]) for side in self.sides)
        claimed = [side.accuracy.claims[self.quantity].get(name) for side in self.sides]
        own, others = (np.zeros_like(mine) if claim is None else _columns(claim) for claim in claimed)
        gap = gaps_between(mine, other, QUANTITIES[self.quantity].unit)
        # Who gives a number that there is none of, a rounding over a rounding, claims nothing of it.
        lone = np.where(np.isnan(mine), others, np.where(np.isnan(other), own, 0.0))
        gap[lone >= NOTHING] = 0.0
        # The smaller of both, so that a wrong number does not widen its own tolerance.
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
        """At which instants what is allowed tests nothing, (N,)."""
        # Whose accuracy was stated beforehand may claim much, and what it claims elsewhere is no measure.
        stated = [blind for blind in self._blind if blind is not None]
        if stated:
            return np.asarray(np.any(stated, axis=0))
        one, two = (claim.max(axis=-1) for claim in held.claims)
        return untested(one, two, *self._levels)

    def tells(self, scene: Scene, held: Held) -> bool:
        """Whether a number is none that a solver was given: what was given would not agree as well.

        It is asked of a solver with a stated accuracy only. It was given where each point is drawn, and that
        of the chassis is all there is to know of its points. An instant of which its accuracy says nothing
        does not count.
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
    """How far two arrays of numbers are apart, number by number; infinity where one alone is none."""
    gap = np.abs(mine - other)
    if unit == "rad":
        # Whole turns apart is the same angle.
        gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))
    # A NaN is a disagreement, and the worst one.
    gap[~np.isfinite(gap)] = np.inf
    # That there is none, as of a centre at infinity, is what both say.
    gap[np.isnan(mine) & np.isnan(other)] = 0.0
    return np.asarray(gap)


def _columns(array: Array) -> Array:
    return array.reshape(len(array), -1)
