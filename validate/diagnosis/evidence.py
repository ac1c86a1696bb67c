"""The evidence of a diagnosis, and a possible fault of its numbers.

Evidence is the given numbers, the trusted (`held`) numbers, and the allowed differences. Numbers are stored
by row: a pair of a quantity and a point, body or angle.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.effects.registry import QUANTITIES
from pointcoord.numerics.rounding import EPS
from pointcoord.simulation import finest_tolerance
from validate.arrays import Array, Flags
from validate.comparison.compare import Outcome
from validate.comparison.given import given_by_both
from validate.comparison.pair import SMALLEST, Pair, gaps_between
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Numbers, Solution

Content = dict[str, Any]
"""The content of a scene, a copy that may be changed."""


class Row(NamedTuple):
    """A quantity of a point, body or angle; its numbers are judged together."""

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

# A difference is explained only if it is more than so many times its tolerance; a smaller one may be chance.
CLEAR = 4.0
FEW = 25  # number of instants of a first look
DECIMALS = 7  # a round number has fewer decimals
# A tolerance of numbers that may be anything; finite, because it is multiplied by zeros of a matrix.
ANY = 1e100
# Differences below this share of a quantity's largest number are rounding, whatever the error bounds are.
ROUNDING = 64.0 * EPS


def together(rows: Iterable[Row]) -> list[tuple[Row, ...]]:
    """Groups of rows that are judged together: all vectors of a quantity; each number of the car alone."""
    groups: dict[object, list[Row]] = {}
    for row in rows:
        groups.setdefault(row if row.of == "car" else row.quantity, []).append(row)
    return [tuple(some) for some in groups.values()]


def numbers_in(numbers: Numbers, rows: Iterable[Row]) -> Array:
    """The numbers of rows, concatenated."""
    return np.concatenate([numbers[quantity][of].ravel() for quantity, of in rows])


def roundest(found: Array | float, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The numbers rounded to the fewest decimals that still fit; the numbers themselves if none fits.

    Least squares of printed digits give the intended number only approximately.

    Args:
        fits: whether rounded numbers fit.
        unit: the unit in which the numbers are rounded.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(DECIMALS))
    return np.asarray(next((near for near in rounder if fits(near)), found))


class Solved:
    """The motion of a scene and motions of changed scenes, each solved when first needed."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._others: dict[Hashable, Motion | None] = {}

    def other(
        self,
        key: Hashable,
        put: Callable[[Content], None],
        solve: Callable[[Scene], Motion] = simulate,
    ) -> Motion | None:
        """The motion of the scene with changed content; None if it is refused.

        Args:
            key: identifies the change. put: changes the content.
        """
        if key not in self._others:
            content = copy.deepcopy(self.content)
            put(content)
            self._others[key] = None
            with suppress(PointcoordError):
                self._others[key] = solve(Scene.from_mapping(content, "another car"))
        return self._others[key]

    @cached_property
    def motion(self) -> Motion | None:
        """The motion of the scene itself; None if it cannot be solved."""
        return self.other("as it is", lambda _: None)

    @cached_property
    def fine(self) -> Scene:
        """The scene with every point reported, and the finest tolerance that rounding allows."""
        tolerance = min(self.scene.tolerance, finest_tolerance(self.scene))
        return self.scene.model_copy(update={"tolerance": tolerance, "points": None})

    @cached_property
    def content(self) -> Content:
        """Its content with the first and last instant only; motions can be read at any instant between."""
        samples = min(2, self.scene.time.samples)
        ends = {"time": self.scene.time.model_copy(update={"samples": samples})}
        return self.fine.model_copy(update=ends).model_dump(mode="json", exclude_none=True)


@dataclass(frozen=True)
class Evidence:
    """Given numbers and trusted (`held`) numbers at the same instants.

    Attributes:
        times: (N,), s.
        given, held: the numbers, (N, 3) or (N,).
        allowed: allowed differences between given and held numbers, likewise.
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
    held: Rows
    allowed: Rows
    wrong: tuple[Row, ...]
    solved: Solved
    over_time: bool = True
    other_cars: bool = True
    own: Rows = field(default_factory=dict)
    units: Mapping[Row, tuple[str, float]] = field(default_factory=dict)
    labels: Sequence[str] = ()

    @classmethod
    def of(cls, scene: Scene, given: Solution, held: Solution, outcome: Outcome) -> Evidence:
        """The evidence of all rows that both solutions give, with the tolerances of their comparison."""
        times, one, two = given_by_both(given, held, scene.instants)
        pairs = [Pair(quantity, (one, two), outcome.factor) for quantity in one.numbers]
        rows = {Row(pair.quantity, name): pair for pair in pairs for name in pair.names}
        trusted, theirs = ({row: of.numbers[row.quantity][row.name] for row in rows} for of in (two, one))
        allowed = {
            row: pair.held(row.name).allowed.reshape(trusted[row].shape) + SMALLEST
            for row, pair in rows.items()
        }
        disagree = {(row.quantity, row.name) for row in outcome.disagreements}
        wrong = tuple(row for row in rows if row in disagree)
        return cls(scene, times, theirs, trusted, allowed, wrong, Solved(scene))

    @cached_property
    def few(self) -> Evidence:
        """The evidence at a few evenly chosen instants, for a first look."""
        last = len(self.times) - 1
        places = np.unique(np.linspace(0, last, min(FEW, last + 1)).astype(np.intp))

        def of(rows: Rows) -> Rows:
            return {row: array[places] for row, array in rows.items()}

        return replace(
            self,
            times=self.times[places],
            given=of(self.given),
            held=of(self.held),
            allowed=of(self.allowed),
            own=of(self.own),
        )

    def after(self, rows: Mapping[Row, WouldBe], wrong: tuple[Row, ...]) -> Evidence:
        """The evidence with other trusted numbers for some rows, and other rows to explain."""
        held = {**self.held, **{row: value for row, (value, _) in rows.items()}}
        allowed = {**self.allowed, **{row: width for row, (_, width) in rows.items()}}
        return replace(self, held=held, allowed=allowed, wrong=wrong)

    def unit_of(self, row: Row) -> tuple[str, float]:
        """The unit in which amounts of a row are reported, and its factor to our unit."""
        return self.units.get(row, (row.unit, 1.0))

    def label(self, place: int) -> str:
        """An instant in words."""
        return self.labels[place] if self.labels else f"{self.times[place]:g} s"

    def off_by(self, row: Row) -> Array:
        """The allowed differences of a row, including the errors of the given numbers."""
        return np.asarray(self.allowed[row] + self.own.get(row, 0.0))

    def joined(self, rows: Sequence[Row]) -> tuple[Array, Array, Array]:
        """Held numbers, given numbers and allowed differences of rows, concatenated."""
        of_rows = ((self.held[row], self.given[row], self.off_by(row)) for row in rows)
        held, given, off_by = (
            np.concatenate([part.ravel() for part in of]) for of in zip(*of_rows, strict=True)
        )
        return held, given, off_by

    def left(self, row: Row, value: Array, allowed: Array) -> float:
        """The largest difference of given numbers from `value` over its tolerance."""
        gap = gaps_between(self.given[row], value, QUANTITIES[row.quantity].unit)
        with np.errstate(over="ignore"):  # a tolerance may be tiny
            return float(np.max(gap / (allowed + self.own.get(row, 0.0)), initial=0.0))

    def wrong_at(self, row: Row) -> Flags:
        """The instants at which a row disagrees, (N,)."""
        gap = gaps_between(self.given[row], self.held[row], QUANTITIES[row.quantity].unit)
        return np.asarray(~(gap <= self.off_by(row)).reshape(len(gap), -1).all(axis=-1))

    def explained(self, rows: Mapping[Row, WouldBe]) -> bool:
        """Whether all given numbers of rows are within their tolerances."""
        return all(self.left(row, *numbers) <= 1.0 for row, numbers in rows.items())

    def clear(self, row: Row, allowed: Array) -> bool:
        """Whether the difference of a row is clearly larger than its tolerance and than rounding."""
        if self.left(row, self.held[row], allowed) <= CLEAR:
            return False
        beside = (held for other, held in self.held.items() if other.quantity == row.quantity)
        largest = max(float(np.abs(held).max(initial=0.0)) for held in beside)
        return not bool((np.abs(self.given[row] - self.held[row]) <= ROUNDING * largest).all())

    def rounded(self, row: Row, *others: Array | float) -> Array:
        """The tolerance of numbers that were computed from the held ones or from the drawing.

        Their error is at most that of the held numbers, plus a few roundings.
        """
        largest = max(
            float(np.abs(array).max(initial=0.0)) for array in (self.held[row], *map(np.asarray, others))
        )
        return np.asarray(2.0 * self.allowed[row] + 8.0 * EPS * largest)

    def distinct(self, rows: Sequence[Row]) -> int:
        """The number of distinct wrong numbers of rows, not counting one for each axis: of the given or the
        held numbers, whichever has fewer.

        A single number of an axis proves nothing: a fitted parameter always matches it.
        """
        axes = self.held[rows[0]][0].size
        held, given, allowed = (numbers.reshape(-1, axes) for numbers in self.joined(rows))
        off = ~(np.abs(given - held) <= allowed)
        counts = []
        for numbers in (held, given):
            # Two numbers are distinct if they differ by more than both their tolerances.
            step = max(
                4.0 * float(allowed[off].max(initial=0.0)), 1e-9 * float(np.abs(numbers).max(initial=0.0))
            )
            apart = (axis[there & np.isfinite(axis)] for axis, there in zip(numbers.T, off.T, strict=True))
            counts.append(sum(max(len(np.unique(np.floor(some / step))) - 1, 0) for some in apart))
        return min(counts)

    @property
    def wrong_quantities(self) -> tuple[str, ...]:
        """The quantities that have a row that disagrees."""
        return tuple(dict.fromkeys(row.quantity for row in self.wrong))

    @property
    def looked(self) -> tuple[Row, ...]:
        """The rows that disagree, and the agreeing rows of their quantities, which a fault must fit too."""
        beside = (row for row in self.held if row.quantity in self.wrong_quantities and row not in self.wrong)
        return (*self.wrong, *beside)

    @property
    def vectors(self) -> tuple[Row, ...]:
        """The rows of `looked` that are vectors, not numbers of the car."""
        return tuple(row for row in self.looked if row.of != "car")

    def places(self, point: str) -> Array | None:
        """The position of a point, (N, 3), even if the scene does not report it; None if not solvable."""
        (row,) = (row for quantity in QUANTITIES if (row := Row(quantity, point)).is_place)
        if row in self.held:
            return self.held[row]
        motion = self.solved.motion if self.other_cars else None
        return None if motion is None else np.asarray(motion.at(self.times).numbers[row.quantity][point])


Stage = Literal["numbers", "motion", "drawing", "last"]


@dataclass(frozen=True)
class Hypothesis:
    """One fault with its parameters.

    Attributes:
        words: the fault in words.
        rows: the numbers that each row would have with the fault.
        fitted: number of fitted parameters.
        cost: how far-fetched it is, from the fitted parameters and the choices made.
        key: identifies the fault within its kind; faults with equal keys are merged. The words, if None.
        decimals: number of decimals of its amount; of equally far-fetched faults the rounder is preferred.
        looser: whether the fault only widens the tolerance, such as rounding to printed digits.
        whole: whether it concerns the whole car, so that rows that agree must also agree with the fault.
        rests: whether it concerns points at rest, for which a single number is enough.
        kind: the kind of fault; two kinds are joined by "and".
        explains: once it is tested, the disagreeing rows that it explains.
        leftover: the largest remaining difference / tolerance of these rows.
    """

    words: str
    rows: Mapping[Row, WouldBe]
    fitted: int = 0
    cost: float = 1.0
    key: Hashable = None
    decimals: int = 0
    looser: bool = False
    whole: bool = False
    rests: bool = False
    kind: str = ""
    explains: tuple[Row, ...] = ()
    leftover: float = np.nan


@dataclass(frozen=True)
class Kind:
    """A kind of fault.

    Attributes:
        name: name of the kind. suppose: yields possible faults of this kind for some evidence.
        stage: "numbers" needs only arithmetic; "motion" solves the same car with another motion or closure;
            "drawing" solves cars with another drawing; "last" explains little. Each is tried on rows that
            earlier stages do not explain.
        opens, closes: whether it may be the first or the second of two faults in the same numbers.
    """

    name: str
    suppose: Callable[[Evidence], Iterator[Hypothesis]]
    stage: Stage = "numbers"
    opens: bool = False
    closes: bool = False
