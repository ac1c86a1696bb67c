r"""The numbers of one quantity by two formulations, their differences, and the tolerances of these.

Let e1 and e2 be the error bounds of the two formulations for a number (see `Accuracy`). The tolerance is

    T = e1 + e2 + eps^2 M.

A larger difference shows that an error bound is violated. M is the largest number of the quantity in the
scene: a number that is zero is solved for together with nonzero numbers, and is off by a rounding error of
their rounding errors. There is an error bound for each instant and each component. The bounds of pointcoord
are proven from its own equations in twice the working precision, but are never wider than the error that its
method makes where nothing is wrong (`Proof.expected`). The bounds of models that prove nothing follow from a
stated accuracy of their points (`formulations.stated_accuracy`).

A tolerance is limited by the formulation with the larger error bound. If this bound is more than LOOSEST
times the error level of the other formulation, an error of the other one of LOOSEST times its level would
pass: the row is "not tested", and does not agree. The error level of a formulation is the largest error bound
of the quantity at the instant, so that a component that happens to be exact does not count against its
partner. The level is at least the effect of rounding on any method, eps times condition number times the
largest number of the quantity. The level is also at least the usual error of the method (`Accuracy.usual`),
because a proven bound may be almost zero by chance, as for a pitch that is 0 everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from pointcoord.scene.scene_file import Scene
from validate.arrays import Array, Flags
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import NOTHING, Solution

# Numbers below the smallest normal double lose digits, and so do tolerances computed from them.
SMALLEST = float(np.finfo(float).tiny)
LOOSEST = 1000.0


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
        """The largest finite number of each side at each instant, (N,); 0 without any."""
        found = []
        for side in self.sides:
            arrays = side.numbers[self.quantity].values()
            finite = [_columns(np.where(np.isfinite(array), np.abs(array), 0.0)) for array in arrays]
            found.append(np.hstack([np.zeros((len(side.times), 1)), *finite]).max(axis=1))
        return found

    @cached_property
    def _levels(self) -> list[Array]:
        """The error level of each side at each instant, (N,), see the top of this file."""
        found = []
        for own, numbers in zip((side.accuracy for side in self.sides), self._largest, strict=True):
            parts = [EPS * own.condition * numbers, *own.claims[self.quantity].values()]
            if (usual := own.usual.get(self.quantity)) is not None:
                parts.append(usual)
            found.append(np.hstack([_columns(part) for part in parts]).max(axis=1))
        return found

    def _tolerance(self, claims: tuple[Array, Array], largest: float) -> Array:
        """The tolerance of a difference of two numbers with these error bounds; `largest` is M."""
        return np.asarray(self.factor * (claims[0] + claims[1] + EPS**2 * largest))

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
        allowed = self._tolerance((own, others), min(float(most.max()) for most in self._largest))
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

    def wide(self, held: Held) -> Flags:
        """The instants at which the tolerance is too wide to test anything, (N,)."""
        # An accuracy that was stated beforehand may be coarse: a wide bound from it still tests.
        stated = [side.accuracy.blind for side in self.sides if side.accuracy.blind is not None]
        if stated:
            return np.asarray(np.any(stated, axis=0))
        bounds = (claim.max(axis=-1) for claim in held.claims)
        pairs = zip(bounds, reversed(self._levels), strict=True)
        return np.asarray(np.any([bound > LOOSEST * level for bound, level in pairs], axis=0))

    def tells(self, scene: Scene, held: Held) -> bool:
        """Whether the agreement of a number tests the solver: the data given to the solver would not agree.

        Only a solver with a stated accuracy is examined; otherwise True. The solver is given the drawn place
        of each point; for a point of the chassis this place is the answer. Instants at which the stated
        accuracy gives no bound do not count.
        """
        blind = [side.accuracy.blind for side in self.sides]
        if (blind[0] is None) == (blind[1] is None):
            return True
        solver, other = (1, 0) if blind[0] is None else (0, 1)
        kind, part, unseen = QUANTITIES[self.quantity], scene.mechanism, np.asarray(blind[solver])
        if kind.of == "point" and held.name in part.topology.chassis:
            return False
        if per_second(self.quantity):
            given_back = np.zeros(3)
        elif kind.of == "point" and held.name in part.points:
            given_back = np.array(part.points[held.name], dtype=float)
        else:
            return not unseen.all()
        width = self._tolerance(held.claims, float(self._largest[other].max()))
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
