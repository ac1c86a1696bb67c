"""What a diagnosis looks at: given numbers beside the held ones, and how far apart they may be.

Numbers are by row: the pair of a quantity and a point, body or angle.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from pointcoord.simulation import finest_tolerance
from validate.comparison.compare import SMALLEST, Outcome, Pair, gaps_between
from validate.comparison.given import given_by_both
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Numbers, Solution

Array = NDArray[np.float64]
Content = dict[str, Any]
"""Of a scene, whose tables and lists are its own."""


class Row(NamedTuple):
    """A quantity of a point, body or angle, whose numbers are looked at as one."""

    quantity: str
    name: str

    @property
    def of(self) -> str:
        """What each number belongs to: a point, a body or the car."""
        return QUANTITIES[self.quantity].of

    @property
    def unit(self) -> str:
        """What its numbers are of, whatever rate they are: mm or rad."""
        return QUANTITIES[self.quantity].unit.partition("/")[0]

    @property
    def order(self) -> int:
        """Which time derivative its numbers are."""
        return per_second(self.quantity)

    @property
    def is_place(self) -> bool:
        """Whether its numbers are where a point is."""
        return self.of == "point" and self.order == 0


Rows = Mapping[Row, Array]
WouldBe = tuple[Array, Array]
"""What given numbers would be, and how far from that they may be."""

# How many times what may be left of it a difference is, to be explained; a smaller one may be chance.
CLEAR = 4.0
FEW = 25  # instants
DECIMALS = 7  # that a round number has fewer of
# Of a quantity's largest number: differences that are rounding, whatever is claimed.
ROUNDING = 64.0 * EPS


def together(rows: Iterable[Row]) -> list[tuple[Row, ...]]:
    """Rows whose numbers are looked at together: a quantity's vectors; each number of the car by itself."""
    groups: dict[object, list[Row]] = {}
    for row in rows:
        groups.setdefault(row if row.of == "car" else row.quantity, []).append(row)
    return [tuple(some) for some in groups.values()]


def numbers_in(numbers: Numbers, rows: Iterable[Row]) -> Array:
    """The numbers of rows, one after the other."""
    return np.concatenate([numbers[quantity][of].ravel() for quantity, of in rows])


def roundest(found: Array | float, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The roundest of the numbers next to found ones that fits as they do; they themselves if none does.

    Least squares of printed digits miss what was meant by a little.

    Args:
        unit: in which the numbers are round.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(DECIMALS))
    return np.asarray(next((near for near in rounder if fits(near)), found))


class Solved:
    """A scene's own motion and those of other cars, each solved when it is first asked for."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._others: dict[Hashable, Motion | None] = {}

    def other(
        self,
        key: Hashable,
        put: Callable[[Content], None],
        solve: Callable[[Scene], Motion] = simulate,
    ) -> Motion | None:
        """The motion of the scene with other content; None where that is refused."""
        if key not in self._others:
            content = copy.deepcopy(self.content)
            put(content)
            self._others[key] = None
            with suppress(PointcoordError):
                self._others[key] = solve(Scene.from_mapping(content, "another car"))
        return self._others[key]

    @cached_property
    def motion(self) -> Motion | None:
        """That of the scene itself; None where it cannot be solved."""
        return self.other("as it is", lambda _: None)

    @cached_property
    def fine(self) -> Scene:
        """The scene with every point, solved as finely as rounding allows."""
        tolerance = min(self.scene.tolerance, finest_tolerance(self.scene))
        return self.scene.model_copy(update={"tolerance": tolerance, "points": None})

    @cached_property
    def content(self) -> Content:
        """That at its first and last instant, as plain data: motions are read between them."""
        samples = min(2, self.scene.time.samples)
        ends = {"time": self.scene.time.model_copy(update={"samples": samples})}
        return self.fine.model_copy(update=ends).model_dump(mode="json", exclude_none=True)


@dataclass(frozen=True)
class Evidence:
    """Given and held numbers at the same instants.

    Attributes:
        times: (N,), s.
        given, held: the numbers, (N, 3) or (N,).
        allowed: how far a given number may be from the one that it is held to, likewise.
        wrong: the rows that disagree.
        over_time: whether the instants are times; else rows of a file, of inputs or travels.
        other_cars: whether the instants are those of the scene, so that other cars are solved there.
        own: how far a given number may be off by itself, in its own unit, beside what is allowed.
        known: where points are, (N, 3), beside the rows.
        units: of rows that have another than their quantity, such as of derivatives, in words.
    """

    scene: Scene
    times: Array
    given: Rows
    held: Rows
    allowed: Rows
    wrong: tuple[Row, ...]
    solved: Solved
    over_time: bool = True
    other_cars: bool = True
    own: Rows = field(default_factory=dict)
    known: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[Row, str] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, given: Solution, held: Solution, outcome: Outcome) -> Evidence:
        """The numbers of all rows that both give, held to what both claim."""
        times, one, two = given_by_both(given, held, scene.instants)
        pairs = {quantity: Pair(quantity, (one, two), outcome.factor) for quantity in one.numbers}
        rows = [Row(q, name) for q, pair in pairs.items() for name in pair.names]
        trusted = {row: two.numbers[row.quantity][row.name] for row in rows}
        disagree = {Row(row.quantity, row.name) for row in outcome.disagreements}
        return cls(
            scene=scene,
            times=times,
            given={row: one.numbers[row.quantity][row.name] for row in rows},
            held=trusted,
            allowed={
                row: pairs[row.quantity].allowed(row.name).reshape(trusted[row].shape) + SMALLEST
                for row in rows
            },
            wrong=tuple(row for row in rows if row in disagree),
            solved=Solved(scene),
        )

    def at(self, places: slice | NDArray[np.intp], theirs: slice | None = None) -> Evidence:
        """The same at some of the instants; the given numbers from other ones, where these are stated."""

        def of(rows: Rows, some: slice | NDArray[np.intp] = places) -> Rows:
            return {row: array[some] for row, array in rows.items()}

        return replace(
            self,
            times=self.times[places],
            given=of(self.given, places if theirs is None else theirs),
            held=of(self.held),
            allowed=of(self.allowed),
            own=of(self.own),
            known={point: path[places] for point, path in self.known.items()},
        )

    @cached_property
    def few(self) -> Evidence:
        """The same at a few of the instants, evenly: what fits there may fit at all of them."""
        last = len(self.times) - 1
        return self.at(np.unique(np.linspace(0, last, min(FEW, last + 1)).astype(np.intp)))

    def after(self, rows: Mapping[Row, WouldBe], wrong: tuple[Row, ...]) -> Evidence:
        """The same with other numbers to hold the given ones against."""
        held = {**self.held, **{row: value for row, (value, _) in rows.items()}}
        allowed = {**self.allowed, **{row: width for row, (_, width) in rows.items()}}
        return replace(self, held=held, allowed=allowed, wrong=wrong)

    def undone(self, rows: Collection[Row], undo: Callable[[Row, Array], Array]) -> Evidence:
        """The same with other given numbers of rows and of vectors beside; wrong is what then disagrees."""
        quantities = {row.quantity for row in rows if row.of != "car"}
        given = {
            row: undo(row, array) if row in rows or row.quantity in quantities else array
            for row, array in self.given.items()
        }
        there = replace(self, given=given)
        wrong = (row for row, held in self.held.items() if there.left(row, held, self.allowed[row]) > 1.0)
        return replace(there, wrong=tuple(wrong))

    def in_words(self, row: Row, amount: Array) -> str:
        """An amount of a row with its unit."""
        said = ", ".join(f"{c:.6g}" for c in np.ravel(amount))
        return f"{f'({said})' if np.ndim(amount) else said} {self.units.get(row, row.unit)}"

    def off_by(self, row: Row) -> Array:
        """How far a row's numbers may be from the held ones."""
        return np.asarray(self.allowed[row] + self.own.get(row, 0.0))

    def joined(self, rows: Sequence[Row]) -> tuple[Array, Array, Array]:
        """The held and the given numbers of rows, one after the other, and how far each may be off."""
        held, given, off_by = (
            np.concatenate([of(row).ravel() for row in rows])
            for of in (self.held.__getitem__, self.given.__getitem__, self.off_by)
        )
        return held, given, off_by

    def left(self, row: Row, value: Array, allowed: Array) -> float:
        """The largest difference of given numbers from others, in parts of what is allowed."""
        gap = gaps_between(self.given[row], value, QUANTITIES[row.quantity].unit)
        with np.errstate(over="ignore"):  # nothing but zeros allows nothing
            return float(np.max(gap / (allowed + self.own.get(row, 0.0)), initial=0.0))

    def explained(self, rows: Mapping[Row, WouldBe]) -> bool:
        """Whether all given numbers of rows are within what they may be off."""
        return all(self.left(row, *numbers) <= 1.0 for row, numbers in rows.items())

    def clear(self, row: Row, allowed: Array) -> bool:
        """Whether a row is so far off that what is allowed of it does not explain it, nor rounding."""
        if self.left(row, self.held[row], allowed) <= CLEAR:
            return False
        beside = (held for other, held in self.held.items() if other.quantity == row.quantity)
        largest = max(float(np.abs(held).max(initial=0.0)) for held in beside)
        return not bool((np.abs(self.given[row] - self.held[row]) <= ROUNDING * largest).all())

    def rounded(self, row: Row, *others: Array | float) -> Array:
        """What is allowed of numbers that were computed again, from the held ones or from the drawing.

        They are as far off as the held ones at most, and what made them rounds each a few times.
        """
        largest = max(
            float(np.abs(array).max(initial=0.0)) for array in (self.held[row], *map(np.asarray, others))
        )
        return np.asarray(2.0 * self.allowed[row] + 8.0 * EPS * largest)

    def distinct(self, rows: Sequence[Row]) -> int:
        """How many distinct numbers that are off rows have, beside one of each axis; the fewer of both sides.

        One number of each axis is none to tell anything by.
        """
        axes = self.held[rows[0]][0].size
        held, given, allowed = (numbers.reshape(-1, axes) for numbers in self.joined(rows))
        off = ~(np.abs(given - held) <= allowed)
        counts = []
        for numbers in (held, given):
            # Two numbers of which each may be off by what is allowed, on both sides.
            step = max(4.0 * float(allowed.max()), 1e-9 * float(np.abs(numbers).max(initial=0.0)))
            apart = (axis[there & np.isfinite(axis)] for axis, there in zip(numbers.T, off.T, strict=True))
            counts.append(sum(max(len(np.unique(np.floor(some / step))) - 1, 0) for some in apart))
        return min(counts)

    @property
    def wrong_quantities(self) -> tuple[str, ...]:
        """The quantities of which a row disagrees."""
        return tuple(dict.fromkeys(row.quantity for row in self.wrong))

    @property
    def looked(self) -> tuple[Row, ...]:
        """The rows that disagree, and those that agree of the same quantities: would they under a fault?"""
        beside = (row for row in self.held if row.quantity in self.wrong_quantities and row not in self.wrong)
        return (*self.wrong, *beside)

    @property
    def vectors(self) -> tuple[Row, ...]:
        """Of `looked` those that are no numbers of the car."""
        return tuple(row for row in self.looked if row.of != "car")

    def places(self, point: str) -> Array | None:
        """Where a point is, (N, 3), whether the scene reports it or not; None where it cannot be solved."""
        (row,) = (row for quantity in QUANTITIES if (row := Row(quantity, point)).is_place)
        if point in self.known or row in self.held:
            return self.known.get(point, self.held.get(row))
        motion = self.solved.motion if self.over_time else None
        return None if motion is None else np.asarray(motion.at(self.times).numbers[row.quantity][point])
