"""What a diagnosis looks at: given numbers beside the held ones, and how far apart they may be.

Numbers are by row: the pair of a quantity and a point, body or angle.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.effects.registry import QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.numerics.rounding import EPS
from pointcoord.simulation import finest_tolerance
from validate.comparison.compare import SMALLEST, Outcome, Pair, gaps_between
from validate.comparison.given import given_by_both
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Numbers, Solution

Array = NDArray[np.float64]
Row = tuple[str, str]
Rows = Mapping[Row, Array]

MOST_DISTINCT = 32  # numbers that are counted; more than any fault is fitted by
# How many times what may be left of it a difference is, to be explained; a smaller one may be chance.
CLEAR = 4.0
# Of a quantity's largest number: differences that are rounding, whatever is claimed.
ROUNDING = 64.0 * EPS


def length_or_angle(row: Row) -> str:
    """What a row's numbers are of, whatever rate they are: mm or rad."""
    return QUANTITIES[row[0]].unit.partition("/")[0]


def order(row: Row) -> int:
    """Which time derivative a row's numbers are."""
    return per_second(row[0])


def kind_of(row: Row) -> str:
    """What each number belongs to: a point, a body or the car."""
    return QUANTITIES[row[0]].of


def together(rows: Iterable[Row]) -> list[tuple[Row, ...]]:
    """Rows whose numbers are looked at together: a quantity's vectors; each number of the car by itself."""
    groups: dict[object, list[Row]] = {}
    for row in rows:
        groups.setdefault(row if kind_of(row) == "car" else row[0], []).append(row)
    return [tuple(some) for some in groups.values()]


def axes_of(scene: Scene) -> CarAxes:
    """The directions of a scene's car."""
    return scene.mechanism.axes


def _in_digits(amount: Array | float) -> str:
    return f"{amount:.6g}" if np.ndim(amount) == 0 else f"({', '.join(f'{c:.6g}' for c in np.ravel(amount))})"


def some_of(count: int, most: int) -> NDArray[np.intp]:
    """The places of so many of `count` instants at most, evenly."""
    return np.unique(np.linspace(0, count - 1, min(most, count)).astype(np.intp))


def numbers_in(numbers: Numbers, rows: Iterable[Row]) -> Array:
    """The numbers of rows, one after the other."""
    return np.concatenate([numbers[quantity][of].ravel() for quantity, of in rows])


def _apart_by(step: float, numbers: Array) -> int:
    """How many numbers can be picked that are all farther apart than a step; MOST_DISTINCT at most."""
    rising = np.sort(numbers[np.isfinite(numbers)])
    count = place = 0
    while place < len(rising) and count < MOST_DISTINCT:
        count += 1
        place = int(np.searchsorted(rising, rising[place] + step, side="right"))
    return count


def motion_of(scene: Callable[[], Scene], solve: Callable[[Scene], Motion] = simulate) -> Motion | None:
    """The motion of a scene that may be none, or be refused: then there is no motion."""
    with suppress(PointcoordError):
        return solve(scene())
    return None


class Solved:
    """A scene's own motion, solved when it is first asked for, with every point."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._others: dict[Hashable, Motion | None] = {}

    def other(self, key: Hashable, solve: Callable[[], Motion | None]) -> Motion | None:
        """The motion of another car, solved once: several suppositions ask for the same."""
        if key not in self._others:
            self._others[key] = solve()
        return self._others[key]

    @cached_property
    def fine(self) -> Scene:
        """The scene with every point, solved as finely as rounding allows."""
        tolerance = min(self.scene.tolerance, finest_tolerance(self.scene))
        return self.scene.model_copy(update={"tolerance": tolerance, "points": None})

    @cached_property
    def ends(self) -> Scene:
        """The same at its first and last instant: motions are read between them."""
        samples = min(2, self.scene.time.samples)
        return self.fine.model_copy(update={"time": self.scene.time.model_copy(update={"samples": samples})})

    @cached_property
    def content(self) -> dict[str, Any]:
        """That as plain data."""
        return self.ends.model_dump(mode="json", exclude_none=True)

    @cached_property
    def motion(self) -> Motion | None:
        """Its motion; None where pointcoord refuses it."""
        return motion_of(lambda: self.ends)


def numbers_not_given(numbers: Numbers, given: Collection[Row]) -> dict[Row, Array]:
    """Numbers of the car, of all that there are, that are not given."""
    every = {(q, n): a for q, of in numbers.items() if QUANTITIES[q].of == "car" for n, a in of.items()}
    return {row: array for row, array in every.items() if row not in given}


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
        parted: whether a fault of all numbers was undone, so that one car has to explain every one of them.
        own: how far a given number may be off by itself, in its own unit, beside what is allowed.
        known: where points are, (N, 3), beside the rows.
        not_given: our numbers of the car that are not given, (N,).
        units: of rows that have another than their quantity, such as of derivatives, in words.
        theirs: the units that rows are given in, where these are not ours, and how many of ours each is.
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
    parted: bool = False
    own: Rows = field(default_factory=dict)
    known: Mapping[str, Array] = field(default_factory=dict)
    not_given: Rows = field(default_factory=dict)
    units: Mapping[Row, str] = field(default_factory=dict)
    theirs: Mapping[Row, tuple[str, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, given: Solution, held: Solution, outcome: Outcome) -> Evidence:
        """The numbers of all rows that both give, held to what both claim."""
        times, one, two = given_by_both(given, held, scene.instants)
        pairs = {quantity: Pair.of(one, two, quantity, outcome.factor) for quantity in one.numbers}
        rows = [(q, name) for q, pair in pairs.items() for name in pair.one.numbers if pair.gives(name)]
        trusted = {row: two.numbers[row[0]][row[1]] for row in rows}
        disagree = {(row.quantity, row.name) for row in outcome.disagreements}
        return cls(
            scene=scene,
            times=times,
            given={row: one.numbers[row[0]][row[1]] for row in rows},
            held=trusted,
            allowed={(q, n): pairs[q].allowed(n).reshape(trusted[q, n].shape) + SMALLEST for q, n in rows},
            wrong=tuple(row for row in rows if row in disagree),
            solved=Solved(scene),
            not_given=numbers_not_given(two.numbers, rows),
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
            not_given=of(self.not_given),
        )

    def thinned(self, count: int) -> Evidence:
        """The same at so many instants at most, evenly."""
        return self.at(some_of(len(self.times), count))

    def after(self, rows: Mapping[Row, tuple[Array, Array]], wrong: tuple[Row, ...]) -> Evidence:
        """The same with other numbers to hold the given ones against: values, and what they may differ."""
        held = {**self.held, **{row: value for row, (value, _) in rows.items()}}
        allowed = {**self.allowed, **{row: width for row, (_, width) in rows.items()}}
        return replace(self, held=held, allowed=allowed, wrong=wrong)

    def undone(self, rows: Collection[Row], undo: Callable[[Row, Array], Array]) -> Evidence:
        """The same with other given numbers of rows and of vectors beside; wrong is what then disagrees."""
        quantities = {row[0] for row in rows if kind_of(row) != "car"}
        given = {
            row: undo(row, array) if row in rows or row[0] in quantities else array
            for row, array in self.given.items()
        }
        there = replace(self, given=given, parted=True)
        wrong = (row for row, held in self.held.items() if there.left(row, held, self.allowed[row]) > 1.0)
        return replace(there, wrong=tuple(wrong))

    def without_units(self) -> Evidence:
        """The same after a fault of units: the held numbers are in none that is known."""
        return replace(self, units=dict.fromkeys(self.held, "in its own unit"), theirs={})

    def in_words(self, row: Row, amount: Array | float) -> str:
        """An amount of a row with its unit, and in the one that it is given in."""
        said = f"{_in_digits(amount)} {self.units.get(row, length_or_angle(row))}"
        if row not in self.theirs:
            return said
        unit, factor = self.theirs[row]
        return f"{said} ({_in_digits(amount / factor)} {unit})"

    def off_by(self, row: Row) -> Array:
        """How far a row's numbers may be from the held ones."""
        return np.asarray(self.allowed[row] + self.own.get(row, 0.0))

    def joined(self, rows: Sequence[Row], at: slice | NDArray[np.intp] = slice(None)) -> tuple[Array, Array]:
        """The given numbers of rows at some instants, one after the other, and how far each may be off."""
        given, off_by = (
            np.concatenate([array[at].ravel() for array in part])
            for part in ([self.given[row] for row in rows], [self.off_by(row) for row in rows])
        )
        return given, off_by

    def stacked(self, rows: Sequence[Row], of: Callable[[Row], Array]) -> Array:
        """Numbers of rows of one shape below each other, (rows * N, 3 or 1)."""
        return np.concatenate([of(row).reshape(len(self.times), -1) for row in rows])

    def left(self, row: Row, value: Array, allowed: Array) -> float:
        """The largest difference of given numbers from others, in parts of what is allowed."""
        gap = gaps_between(self.given[row], value, QUANTITIES[row[0]].unit)
        with np.errstate(over="ignore"):  # nothing but zeros allows nothing
            return float(np.max(gap / (allowed + self.own.get(row, 0.0)), initial=0.0))

    def clear(self, row: Row, allowed: Array) -> bool:
        """Whether a row is so far off that what is allowed of it does not explain it, nor rounding."""
        if self.left(row, self.held[row], allowed) <= CLEAR:
            return False
        largest = max(float(np.abs(self.held[r]).max(initial=0.0)) for r in self.held if r[0] == row[0])
        return not bool((np.abs(self.given[row] - self.held[row]) <= ROUNDING * largest).all())

    def rounded(self, row: Row, *others: Array | float) -> Array:
        """What is allowed of numbers that were computed again, from the held ones or from the drawing.

        They are as far off as the held ones at most, and what made them rounds each a few times.
        """
        largest = max(
            float(np.abs(array).max(initial=0.0)) for array in (self.held[row], *map(np.asarray, others))
        )
        return np.asarray(2.0 * self.allowed[row] + 8.0 * EPS * largest)

    def by(self, motion: Motion) -> dict[Row, tuple[Array, Array]]:
        """What each row would be of another motion, and how far from that it may be."""
        samples = motion.at(self.times)
        proven = motion.proof_of(samples, rates=True).proven
        rows: dict[Row, tuple[Array, Array]] = {}
        for row in self.held:
            quantity, of = row
            if of in samples.numbers[quantity]:
                value = np.array(samples.numbers[quantity][of])
                # These are off by their own bound, and by as much again for what numbers of its laws, such as
                # a factor that is found, are rounded by.
                bound = np.nan_to_num(proven[quantity][of], posinf=0.0)
                rows[row] = (value, 2.0 * (self.rounded(row, value) + bound))
        return rows

    def distinct(self, rows: Sequence[Row]) -> int:
        """How many distinct numbers that are off rows have, beside one of each axis; the fewer of both sides.

        One number of each axis is none to tell anything by.
        """
        sides = [self.stacked(rows, part.__getitem__) for part in (self.held, self.given)]
        allowed = self.stacked(rows, self.off_by)
        off = ~(np.abs(sides[1] - sides[0]) <= allowed)
        counts = []
        for numbers in sides:
            # Two numbers of which each may be off by what is allowed, on both sides.
            step = max(4.0 * float(allowed.max()), 1e-9 * float(np.abs(numbers).max(initial=0.0)))
            apart = (_apart_by(step, axis[there]) for axis, there in zip(numbers.T, off.T, strict=True))
            counts.append(sum(max(count - 1, 0) for count in apart))
        return min(counts)

    @property
    def telling(self) -> tuple[tuple[Row, ...], ...]:
        """Numbers of one unit that disagree: positions, angles, as far as there are any, else the first."""
        of_a_pose = (
            tuple(row for row in self.wrong if length_or_angle(row) == of and order(row) == 0)
            for of in ("mm", "rad")
        )
        first = tuple(row for row in self.wrong if row[0] == self.wrong[0][0])
        return tuple(filter(None, of_a_pose)) or (first,)

    @property
    def beside(self) -> tuple[Row, ...]:
        """The rows that agree, of quantities of which others disagree."""
        return tuple(r for r in self.held if r[0] in self.wrong_quantities and r not in self.wrong)

    @property
    def wrong_quantities(self) -> tuple[str, ...]:
        """The quantities of which a row disagrees."""
        return tuple(dict.fromkeys(row[0] for row in self.wrong))

    def places(self, point: str) -> Array | None:
        """Where a point is, (N, 3), whether the scene reports it or not; None where it cannot be solved."""
        if point in self.known:
            return self.known[point]
        for row, array in self.held.items():
            if row[1] == point and kind_of(row) == "point" and order(row) == 0:
                return array
        motion = self.solved.motion if self.over_time else None
        if motion is None:
            return None
        (quantity,) = (q for q, of in QUANTITIES.items() if of.of == "point" and per_second(q) == 0)
        return np.asarray(motion.at(self.times).numbers[quantity][point])
