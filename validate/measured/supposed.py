"""What the columns that rows are taken by may be meant as: of another sign, unit or zero than is said.

A column v of an input or a travel is supposed to be x = k v + c in ours, with k 1, -1, or what makes another
unit of it, and c 0, the drawn input, pi of an angle that counts the other way, or found by least squares of
the file's places and angles. Poses are solved at some rows only; whoever supposes it has to hold the whole
file to it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from pointcoord import PointcoordError
from validate.measured.mapping import INPUT, TIME, Measured, Series
from validate.measured.poses import Driven, Found, of_a_pose
from validate.plain_text import shown
from validate.tables.units import KINDS

Array = NDArray[np.float64]
OursOf = Callable[[Series, Found], Array | None]
"""Our numbers of a column, (N,); None if they are not known."""

ROWS = 16  # that poses are solved at
NEARLY_ALL = 0.8  # of them must be in reach
STEP = {"rad": 1e-5, "mm": 1e-3}  # of differences by an offset
FAR = 1e3  # spreads of a number, which a row without a pose counts as
# What a supposition may leave of the differences, of the numbers' own spread, to be held to the whole file.
PROMISING = 0.05
# By what a rounded offset may leave more than the found one, which least squares put lowest.
CLOSE = 1.1
# Of a found offset: how near to a known one it is meant to be that.
NEAR = 1e-3


@dataclass(frozen=True)
class Supposed:
    """A file with its independent columns meant otherwise; found: whether an offset was fitted to it."""

    words: str
    measured: Measured
    found: bool


@dataclass(frozen=True)
class _Change:
    """x = factor v + more, in words of the column.

    Attributes:
        cost: how far-fetched it is. found: whether the offset was found by least squares.
    """

    words: str = ""
    factor: float = 1.0
    more: float = 0.0
    cost: float = 0.0
    found: bool = False


SAME = _Change()


def likely(driven: Driven, measured: Measured, ours_of: OursOf) -> Iterator[Supposed]:
    """The likeliest suppositions, what is known beforehand before what is found; none over time."""
    if measured.independent[0].meaning.kind == TIME or not any(
        of_a_pose(s.meaning) for s in measured.numbers
    ):
        return
    trial = _Trial(driven, _some(measured), ours_of)
    try:
        before = trial.left([SAME] * len(measured.independent))
        tried = [(trial.left(changes), changes) for changes in trial.supposed()]
    except PointcoordError:
        return
    kept = [(left, changes) for left, changes in tried if left <= PROMISING and left < before]
    # Simple before far-fetched, where both leave as little as the digits of a file allow.
    kept.sort(key=lambda one: (math.floor(math.log10(one[0] + 1e-12)), sum(c.cost for c in one[1])))
    for _, changes in kept:
        yield from _changed(measured, changes)


def _changed(measured: Measured, changes: Sequence[_Change]) -> Iterator[Supposed]:
    """The file with its independent columns changed."""
    both = list(zip(measured.independent, changes, strict=True))
    words = ", and ".join(f"{shown(s.column)} {change.words}" for s, change in both if change.words)
    fitted = any(change.found for change in changes)
    independent = tuple(
        replace(s, values=c.factor * s.values + c.more, off=abs(c.factor) * s.off) for s, c in both
    )
    turned = {s.meaning.words for s, c in both if c.factor < 0.0}
    slopes = [s for s in measured.numbers if s.meaning.per in turned]
    numbers = tuple(replace(s, values=-s.values) if s in slopes else s for s in measured.numbers)
    yield Supposed(words, replace(measured, independent=independent, numbers=numbers), fitted)
    if slopes:
        # Derivatives by a column that counts the other way do so too, if they were not made of another.
        names = ", ".join(shown(s.column) for s in slopes)
        words = f"{words}, and {names} is by it as it is said"
        yield Supposed(words, replace(measured, independent=independent), fitted)


def in_reach(driven: Driven, measured: Measured) -> Iterator[str]:
    """Units of a column that bring nearly all rows within reach, in words; nearest the said one first."""
    some = _some(measured)
    for i, s in enumerate(some.independent):
        units = [(n, size / s.factor) for n, size in _units(s.meaning.unit)]
        for name, factor in sorted(units, key=lambda one: abs(math.log(one[1]))):
            values = [factor * v.values if k == i else v.values for k, v in enumerate(some.independent)]
            _, lost = driven.inputs(values)
            if abs(factor - 1.0) <= 1e-9 or len(lost) > (1.0 - NEARLY_ALL) * len(some.rows):
                continue
            if s.meaning.kind == TIME or driven.poses(values).reached.mean() >= NEARLY_ALL:
                yield f"{shown(s.column)} is in {name}, not in {_unit_of(s)}"


def _some(measured: Measured) -> Measured:
    """Some of its rows, evenly, and of its numbers those that a pose has."""
    rows = np.zeros(len(measured.rows), dtype=bool)
    rows[np.unique(np.linspace(0, len(rows) - 1, ROWS).astype(int))] = True
    numbers = tuple(s for s in measured.numbers if of_a_pose(s.meaning))
    return replace(measured, numbers=numbers).taken(rows)


@dataclass(frozen=True, repr=False)
class _Trial:
    """A file's numbers by other values of its independent columns."""

    driven: Driven
    measured: Measured
    ours_of: OursOf

    def supposed(self) -> Iterator[list[_Change]]:
        """What each column is changed by: one alone, two together, one by another zero."""
        columns = self.measured.independent
        known = [list(self._known(s)) for s in columns]
        for i, changes in enumerate(known):
            yield from (_one(len(columns), {i: change}) for change in changes)
        for (i, first), (j, second) in combinations(enumerate(known), 2):
            for one, two in product(first, second):
                # Of units of two columns only that both are in the same.
                if abs(one.factor) == abs(two.factor):
                    yield _one(len(columns), {i: replace(one, cost=one.cost + 1.0), j: two})
        for i in range(len(columns)):
            for factor in (1.0, -1.0):
                if change := self._other_zero(i, factor):
                    yield _one(len(columns), {i: change})

    def _known(self, s: Series) -> Iterator[_Change]:
        """Changes of a column that nothing is found for."""
        unit, drawn, said = s.meaning.unit, self._drawn(s), _unit_of(s)
        if unit == "rad":
            yield _Change("is pi minus ours", -1.0, math.pi, 1.2)
        for name, size in _units(unit):
            factor = size / s.factor
            other = abs(factor - 1.0) > 1e-9
            of_unit = f"is in {name}, not in {said}" if other else ""
            if other:
                yield _Change(of_unit, factor, 0.0, 1.1)
            if unit != "rad" or not other:
                yield _Change(_both(of_unit, "has the other sign"), -factor, 0.0, 1.0 + 1.1 * other)
            if drawn:
                home = f"{of_unit}, and from the drawing on" if other else "counts from the drawing on"
                yield _Change(home, factor, drawn, 1.1 + other)
                yield _Change(f"{home}, the other way", -factor, drawn, 1.3 + 2.0 * other)

    def _drawn(self, s: Series) -> float:
        """An input of the drawing; a travel counts from there by itself."""
        return self.driven.drawn.get(s.meaning.name, 0.0) if s.meaning.kind == INPUT else 0.0

    def left(self, changes: Sequence[_Change]) -> float:
        """What is left of the differences, of their numbers' spread; infinite where rows are out of reach."""
        columns = self.measured.independent
        gap = self._gaps([c.factor * s.values + c.more for s, c in zip(columns, changes, strict=True)])
        told = np.isfinite(gap) | ~np.isfinite(self._theirs)
        # A supposition must make sense of nearly all rows.
        if not told.all(axis=0).mean() >= NEARLY_ALL or not np.isfinite(gap).any():
            return math.inf
        return float(np.sqrt(np.nanmean(gap**2)))

    def _other_zero(self, i: int, factor: float) -> _Change | None:
        """The zero that least squares find for a column, as round as it may be; None if none comes near."""
        columns = self.measured.independent
        s, drawn, count = columns[i], self._drawn(columns[i]), len(columns)
        way = "counts the other way, and " if factor < 0.0 else ""

        def change(more: float) -> list[_Change]:
            return _one(count, {i: _Change("", factor, more)})

        def gaps(more: Array) -> Array:
            values = [factor * c.values + more if c is s else c.values for c in columns]
            gap = np.where(np.isfinite(self._theirs), self._gaps(values), 0.0)
            return np.nan_to_num(gap, nan=FAR).ravel()

        step = STEP[s.meaning.unit]
        search = partial(least_squares, gaps, x_scale=1e3 * step)
        found = [
            float(search([begin], diff_step=step / max(abs(begin), step)).x[0]) for begin in {0.0, drawn}
        ]
        best = min(found, key=lambda more: self.left(change(more)))
        least = self.left(change(best))
        if not least <= PROMISING:
            return None
        rounded = (s.factor * round(best / s.factor, decimals) for decimals in range(7))
        more = next((one for one in rounded if self.left(change(one)) <= CLOSE * least), best)
        if drawn and factor > 0.0 and abs(more - drawn) <= NEAR * abs(drawn):
            return _Change("counts from the drawing on", factor, more, 2.0, found=True)
        missing = "missing" if more > 0.0 else "too many"
        words = f"{way}counts from another zero: {abs(more / s.factor):.5g} {_unit_of(s)} are {missing}"
        return _Change(words, factor, more, 3.0 - factor, found=True)

    @cached_property
    def _theirs(self) -> Array:
        return np.stack([s.values for s in self.measured.numbers])

    @cached_property
    def _spread(self) -> Array:
        there = np.isfinite(self._theirs)
        highest = np.max(self._theirs, axis=1, where=there, initial=-np.inf)
        wide = highest - np.min(self._theirs, axis=1, where=there, initial=np.inf)
        return np.where(wide > 0.0, wide, 1.0)[:, None]

    def _gaps(self, values: Sequence[Array]) -> Array:
        """Theirs less ours, of the spread of theirs, (columns, rows); NaN where there is no pose."""
        numbers = self.measured.numbers
        if len(self.driven.inputs(values)[1]) > (1.0 - NEARLY_ALL) * len(values[0]):
            return np.full_like(self._theirs, np.nan)
        found = self.driven.poses(values, numbers)
        ours = [self.ours_of(s, found) for s in numbers]
        nothing = np.full(len(values[0]), np.nan)
        gap = self._theirs - np.stack([nothing if one is None else one for one in ours])
        angles = np.array([s.meaning.unit == "rad" for s in numbers])[:, None]
        turned = (gap + math.pi) % (2.0 * math.pi) - math.pi
        return np.asarray(np.where(angles, turned, gap) / self._spread)


def _one(count: int, changes: dict[int, _Change]) -> list[_Change]:
    """Some columns changed, and the others as they are."""
    return [changes.get(i, SAME) for i in range(count)]


def _both(first: str, second: str) -> str:
    return f"{first}, and {second}" if first else second


def _unit_of(s: Series) -> str:
    """The unit that a column is said to be in."""
    return next((n for n, size in _units(s.meaning.unit) if math.isclose(size, s.factor)), s.meaning.unit)


def _units(unit: str) -> list[tuple[str, float]]:
    """Units of a kind by their first names, and their sizes in ours."""
    found: dict[float, str] = {}
    for name, size in KINDS[unit].items():
        found.setdefault(size, name)
    return [(name, size) for size, name in found.items()]
