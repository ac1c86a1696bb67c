"""What a diagnosis starts from: given numbers, trusted numbers, and the allowed differences.

Numbers are stored by row: a pair of a quantity and a point, body or number of the car.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.comparison.compare import Outcome
from validate.comparison.given import given_by_both
from validate.comparison.pair import SMALLEST, Pair, gaps_between
from validate.diagnosis.solved import Solved
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Solution

# A difference is explained only if it is more than so many times its tolerance; a smaller one may be chance.
CLEAR = 4.0
FEW = 25  # number of instants of a first look
DECIMALS = 7  # a round number has fewer decimals


class Row(NamedTuple):
    """A quantity of a point, a body or the car; its numbers are judged together."""

    quantity: str
    name: str

    @property
    def of(self) -> str:
        """What the number belongs to: a point, a body or the car."""
        return QUANTITIES[self.quantity].of

    @property
    def unit(self) -> str:
        """The unit without time, mm or rad, also for rates."""
        return QUANTITIES[self.quantity].unit.partition("/")[0]

    @property
    def order(self) -> int:
        """The order of its time derivative."""
        return per_second(self.quantity)

    @property
    def is_place(self) -> bool:
        """Whether it is the position of a point."""
        return self.of == "point" and self.order == 0


Rows = Mapping[Row, Array]
WouldBe = tuple[Array, Array]
"""The numbers that a fault would give, and the allowed differences from them."""


@dataclass(frozen=True)
class Evidence:
    """Given and trusted numbers at the same instants.

    Attributes:
        times: (N,), s.
        given, trusted: the numbers, (N, 3) or (N,).
        allowed: allowed differences between given and trusted numbers, likewise.
        wrong: the rows that disagree.
        over_time: whether the instants are times; otherwise they are rows of a file over inputs or travels.
        other_cars: whether the instants are those of the scene, so that other cars can be solved there.
        own: further errors of the given numbers, such as their rounding, in their unit; added to `allowed`.
        units: unit of given amounts in words, and its factor to our unit, if not that of the quantity.
        labels: the instants in words, such as lines of a file; their times if empty.
    """

    scene: Scene
    times: Array
    given: Rows
    trusted: Rows
    allowed: Rows
    wrong: tuple[Row, ...]
    solved: Solved
    over_time: bool = True
    other_cars: bool = True
    own: Rows = field(default_factory=dict)
    units: Mapping[Row, tuple[str, float]] = field(default_factory=dict)
    labels: Sequence[str] = ()

    @classmethod
    def of(cls, scene: Scene, given: Solution, trusted: Solution, outcome: Outcome) -> Evidence:
        """The evidence of all rows that both solutions give, with the tolerances of their comparison."""
        times, one, two = given_by_both(given, trusted, scene.instants)
        pairs = [Pair(quantity, (one, two), outcome.factor) for quantity in one.numbers]
        rows = {Row(pair.quantity, name): pair for pair in pairs for name in pair.names}
        theirs, ours = ({row: of.numbers[row.quantity][row.name] for row in rows} for of in (one, two))
        allowed = {
            row: pair.held(row.name).allowed.reshape(ours[row].shape) + SMALLEST for row, pair in rows.items()
        }
        disagree = {(row.quantity, row.name) for row in outcome.disagreements}
        wrong = tuple(row for row in rows if row in disagree)
        return cls(scene, times, theirs, ours, allowed, wrong, Solved(scene))

    @cached_property
    def few(self) -> Evidence:
        """The evidence at a few evenly chosen instants, for a first look."""
        last = len(self.times) - 1
        places = np.unique(np.linspace(0, last, min(FEW, last + 1)).astype(np.intp))

        def of(rows: Rows) -> Rows:
            return {row: array[places] for row, array in rows.items()}

        given, trusted, allowed, own = map(of, (self.given, self.trusted, self.allowed, self.own))
        times = self.times[places]
        return replace(self, times=times, given=given, trusted=trusted, allowed=allowed, own=own)

    def after(self, rows: Mapping[Row, WouldBe], wrong: tuple[Row, ...]) -> Evidence:
        """The evidence with other trusted numbers for some rows, and other rows to explain."""
        trusted = {**self.trusted, **{row: value for row, (value, _) in rows.items()}}
        allowed = {**self.allowed, **{row: width for row, (_, width) in rows.items()}}
        return replace(self, trusted=trusted, allowed=allowed, wrong=wrong)

    def unit_of(self, row: Row) -> tuple[str, float]:
        """The unit in which amounts of a row are reported, and its factor to our unit."""
        return self.units.get(row, (row.unit, 1.0))

    def label(self, place: int) -> str:
        """An instant in words."""
        return self.labels[place] if self.labels else f"{self.times[place]:g} s"

    def off_by(self, row: Row) -> Array:
        """The allowed differences of a row, including the errors of the given numbers."""
        return np.asarray(self.allowed[row] + self.own.get(row, 0.0))

    def joined(self, rows: Iterable[Row]) -> tuple[Array, Array, Array]:
        """Trusted numbers, given numbers and allowed differences of rows, each concatenated."""
        of_rows = ((self.trusted[row], self.given[row], self.off_by(row)) for row in rows)
        ours, theirs, off = (np.concatenate([x.ravel() for x in of]) for of in zip(*of_rows, strict=True))
        return ours, theirs, off

    def gap(self, row: Row, value: Array) -> Array:
        """Differences of given numbers from `value`; whole turns are removed from angles."""
        return gaps_between(self.given[row], value, QUANTITIES[row.quantity].unit)

    def left(self, row: Row, value: Array, allowed: Array) -> float:
        """The largest difference of given numbers from `value` over its tolerance."""
        with np.errstate(over="ignore"):  # a tolerance may be tiny
            return float(np.max(self.gap(row, value) / (allowed + self.own.get(row, 0.0)), initial=0.0))

    def explained(self, rows: Mapping[Row, WouldBe]) -> bool:
        """Whether all given numbers of rows are within their tolerances."""
        return all(self.left(row, *numbers) <= 1.0 for row, numbers in rows.items())

    def clear(self, row: Row, allowed: Array) -> bool:
        """Whether the difference of a row is clearly larger than a tolerance."""
        return self.left(row, self.trusted[row], allowed) > CLEAR

    def rounded(self, row: Row, *others: Array | float) -> Array:
        """The tolerance of numbers computed from the trusted ones and others.

        Their error is at most that of the trusted numbers, plus a few roundings.
        """
        largest = max(
            float(np.abs(x).max(initial=0.0)) for x in (self.trusted[row], *map(np.asarray, others))
        )
        return np.asarray(2.0 * self.allowed[row] + 8.0 * EPS * largest)

    def distinct(self, rows: Sequence[Row]) -> int:
        """The number of distinct wrong numbers or vectors of rows less one: of the given or the trusted ones,
        whichever are fewer.

        A single number proves nothing: a fitted parameter always matches it.
        """
        axes = self.trusted[rows[0]][0].size
        ours, theirs, off = (numbers.reshape(-1, axes) for numbers in self.joined(rows))
        wrong = (np.abs(theirs - ours) > off).any(axis=1)
        # Two are distinct if they differ by more than both their tolerances, and by more than rounding.
        least = 4.0 * off[wrong].max(initial=0.0), 1e-9 * np.abs(ours).max()
        return min(len(np.unique(np.floor(some[wrong] / max(least)), axis=0)) for some in (ours, theirs)) - 1

    @property
    def wrong_quantities(self) -> tuple[str, ...]:
        """The quantities that have a row that disagrees."""
        return tuple(dict.fromkeys(row.quantity for row in self.wrong))

    @property
    def looked(self) -> tuple[Row, ...]:
        """The rows that disagree, and the agreeing rows of their quantities, which a fault must fit too."""
        alike = (row for row in self.trusted if row.quantity in self.wrong_quantities)
        return tuple(dict.fromkeys((*self.wrong, *alike)))

    def places(self, point: str) -> Array | None:
        """The position of a point, (N, 3), even if it is not reported; None if it cannot be solved."""
        (row,) = (row for quantity in QUANTITIES if (row := Row(quantity, point)).is_place)
        if row in self.trusted:
            return self.trusted[row]
        motion = self.solved.motion if self.other_cars else None
        return None if motion is None else np.asarray(motion.at(self.times).numbers[row.quantity][point])


def together(rows: Iterable[Row]) -> list[tuple[Row, ...]]:
    """Groups of rows that are judged together: all vectors of a quantity; each number of the car alone."""
    groups: dict[object, list[Row]] = {}
    for row in rows:
        groups.setdefault(row if row.of == "car" else row.quantity, []).append(row)
    return [tuple(some) for some in groups.values()]


def roundest(found: Array | float, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The numbers rounded to the fewest decimals that still fit; the numbers themselves if none fits.

    Least squares of printed digits give the intended number only approximately.

    Args:
        fits: whether rounded numbers fit.
        unit: the unit in which the numbers are rounded.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(DECIMALS))
    return np.asarray(next((near for near in rounder if fits(near)), found))
