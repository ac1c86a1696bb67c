"""What a diagnosis looks at: given numbers beside the held ones, and how far apart they may be.

Numbers are by row: the pair of a quantity and a point, body or angle.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, simulate, sweep
from pointcoord.effects.registry import QUANTITIES
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.numerics.rounding import EPS
from pointcoord.simulation import finest_tolerance
from validate.comparison.compare import Outcome
from validate.comparison.given import given as given_numbers
from validate.comparison.tolerance import largest_numbers, tolerance
from validate.formulations.asked_numbers import per_second
from validate.formulations.protocol import Solution

Array = NDArray[np.float64]
Row = tuple[str, str]
Rows = Mapping[Row, Array]

EVENLY = 32  # instants of the telling ones
MOST_DISTINCT = 32  # numbers that are counted; more than any fault is fitted by
# How many times what may be left of it a difference is, to be explained; a smaller one may be chance.
CLEAR = 4.0
# Of a quantity's largest number: differences that are rounding, whatever is claimed.
ROUNDING = 64.0 * EPS
TINY = float(np.finfo(float).tiny)


def length_or_angle(row: Row) -> str:
    """What a row's numbers are of, whatever rate they are: mm or rad."""
    return QUANTITIES[row[0]].unit.partition("/")[0]


def order(row: Row) -> int:
    """Which time derivative a row's numbers are."""
    return per_second(row[0])


def kind_of(row: Row) -> str:
    """What each number belongs to: a point, a body or the car."""
    return QUANTITIES[row[0]].of


def _told(amount: Array | float) -> str:
    return f"{amount:.6g}" if np.ndim(amount) == 0 else f"({', '.join(f'{c:.6g}' for c in np.ravel(amount))})"


def _apart_by(step: float, numbers: Array) -> int:
    """How many numbers can be picked that are all farther apart than a step; MOST_DISTINCT at most."""
    rising = np.sort(numbers[np.isfinite(numbers)])
    count = place = 0
    while place < len(rising) and count < MOST_DISTINCT:
        count += 1
        place = int(np.searchsorted(rising, rising[place] + step, side="right"))
    return count


class Solved:
    """A scene's own motion, solved when it is first asked for, with every point."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene

    @cached_property
    def fine(self) -> Scene:
        """The scene, solved as finely as rounding allows."""
        return self.scene.model_copy(
            update={"tolerance": min(self.scene.tolerance, finest_tolerance(self.scene))}
        )

    @cached_property
    def drawn(self) -> Mapping[str, float]:
        """The angles of its closed drawing by name, rad."""
        try:
            return {name: float(angle[0]) for name, angle in sweep(self.fine).drawn.items()}
        except PointcoordError:
            return {}

    @cached_property
    def motion(self) -> Motion | None:
        """Its motion with every point; None where pointcoord refuses it."""
        try:
            return simulate(self.fine.model_copy(update={"points": None}))
        except PointcoordError:
            return None


@dataclass(frozen=True)
class Evidence:
    """Given and held numbers at the same instants.

    Attributes:
        times: (N,), s.
        given, held: the numbers, (N, 3) or (N,).
        allowed: how far a given number may be from the one that it is held to, likewise.
        wrong: the rows that disagree.
        only: keys of the faults that are to be looked at; None: all.
        over_time: whether the instants are times; else rows of a file, of inputs or travels.
        own: how far a given number may be off by itself, in its own unit, beside what is allowed.
        known: where points are, (N, 3), beside the rows.
        units: of rows that have another than their quantity, such as of derivatives.
        theirs: the units that rows are given in, where these are not ours, and how many of ours each is.
        in_our_units: whether the held numbers are; after another fault they may be in no unit that is known.
    """

    scene: Scene
    times: Array
    given: Rows
    held: Rows
    allowed: Rows
    wrong: tuple[Row, ...]
    solved: Solved
    only: frozenset[Hashable] | None = None
    in_our_units: bool = True
    over_time: bool = True
    own: Rows = field(default_factory=dict)
    known: Mapping[str, Array] = field(default_factory=dict)
    units: Mapping[Row, str] = field(default_factory=dict)
    theirs: Mapping[Row, tuple[str, float]] = field(default_factory=dict)

    @classmethod
    def of(cls, scene: Scene, given: Solution, held: Solution, outcome: Outcome) -> Evidence:
        """The numbers of all rows that both give, held to what both claim."""
        instants = scene.instants
        one, two = given_numbers(given, instants), given_numbers(held, instants)
        both = one.found & two.found
        one, two = one.at(both), two.at(both)
        rows = [
            (quantity, name)
            for quantity, numbers in one.numbers.items()
            for name in numbers
            if name in two.numbers[quantity]
        ]
        allowed: dict[Row, Array] = {}
        for quantity, name in rows:
            sides = (one, two)
            largest = min(
                float(largest_numbers(s.numbers[quantity].values(), len(s.condition)).max(initial=0.0))
                for s in sides
            )
            zero = np.zeros_like(one.numbers[quantity][name])
            claims = [s.claims[quantity].get(name, zero) for s in sides]
            allowed[quantity, name] = outcome.factor * tolerance(claims[0], claims[1], largest) + TINY
        disagree = {(row.quantity, row.name) for row in outcome.disagreements}
        return cls(
            scene=scene,
            times=instants[both],
            given={row: one.numbers[row[0]][row[1]] for row in rows},
            held={row: two.numbers[row[0]][row[1]] for row in rows},
            allowed=allowed,
            wrong=tuple(row for row in rows if row in disagree),
            solved=Solved(scene),
        )

    def at(self, instants: Sequence[int]) -> Evidence:
        """The same at fewer instants."""
        some = np.asarray(instants, dtype=np.intp)
        given, held, allowed, own = (
            {row: array[some] for row, array in rows.items()}
            for rows in (self.given, self.held, self.allowed, self.own)
        )
        known = {point: places[some] for point, places in self.known.items()}
        return replace(
            self, times=self.times[some], given=given, held=held, allowed=allowed, own=own, known=known
        )

    def unit_of(self, row: Row) -> str:
        """The unit of a row's held numbers, in words."""
        own = self.units.get(row, length_or_angle(row))
        return own if self.in_our_units else "in its own unit"

    def in_words(self, row: Row, amount: Array | float) -> str:
        """An amount of a row with its unit, and in the one that it is given in."""
        said = f"{_told(amount)} {self.unit_of(row)}"
        if row not in self.theirs or not self.in_our_units:
            return said
        unit, factor = self.theirs[row]
        return f"{said} ({_told(amount / factor)} {unit})"

    def wants(self, key: Hashable) -> bool:
        """Whether a fault is to be looked at."""
        return self.only is None or key in self.only

    def wanting(self, keys: Iterable[Hashable]) -> Evidence:
        """The same for some faults only."""
        return replace(self, only=frozenset(keys))

    @cached_property
    def telling(self) -> Evidence:
        """The same at some instants: evenly, and where numbers are largest or farthest off.

        Of each row where ours is largest, so that what is allowed of rounding is the same; of each quantity
        and number of the car where both differ most, where that is most beside what is allowed, and where
        theirs is largest.
        """
        count = len(self.times)
        some = {*np.linspace(0, count - 1, min(EVENLY, count)).astype(int).tolist()}
        most: dict[object, dict[str, tuple[float, int]]] = {}
        for row in self.wrong:
            held, given = (part[row].reshape(count, -1) for part in (self.held, self.given))
            gap = np.abs(given - held)
            some.add(int(np.argmax(np.abs(held).max(axis=1))))
            kinds = most.setdefault(row if kind_of(row) == "car" else row[0], {})
            allowed = (self.allowed[row] + self.own.get(row, 0.0)).reshape(count, -1)
            for what, of in (("gap", gap), ("share", gap / allowed), ("theirs", np.abs(given))):
                worst = np.nan_to_num(of, nan=np.inf).max(axis=1)
                at = int(np.argmax(worst))
                if what not in kinds or worst[at] > kinds[what][0]:
                    kinds[what] = float(worst[at]), at
        some |= {at for kinds in most.values() for _, at in kinds.values()}
        return self.at(sorted(some))

    def after(self, rows: Mapping[Row, tuple[Array, Array]], wrong: tuple[Row, ...]) -> Evidence:
        """The same with other numbers to hold the given ones against: values, and what they may differ."""
        held = {**self.held, **{row: value for row, (value, _) in rows.items()}}
        allowed = {**self.allowed, **{row: width for row, (_, width) in rows.items()}}
        return replace(self, held=held, allowed=allowed, wrong=wrong)

    def left(self, row: Row, value: Array, allowed: Array) -> float:
        """The largest difference of given numbers from others, in parts of what is allowed."""
        gap = np.abs(self.given[row] - value)
        if QUANTITIES[row[0]].unit == "rad":
            gap = np.minimum(gap, np.abs(2.0 * np.pi - gap))
        gap = np.where(np.isfinite(gap), gap, np.inf)
        with np.errstate(over="ignore"):  # nothing but zeros allows nothing
            return float(np.max(gap / (allowed + self.own.get(row, 0.0)), initial=0.0))

    def clear(self, row: Row, allowed: Array) -> bool:
        """Whether a row is so far off that what is allowed of it does not explain it, nor rounding."""
        if self.left(row, self.held[row], allowed) <= CLEAR:
            return False
        gap = np.abs(self.given[row] - self.held[row])
        return not bool((gap <= ROUNDING * self.largest(row[0])).all())

    def largest(self, quantity: str) -> float:
        """The largest held number of a quantity."""
        if quantity not in self._largest:
            some = [np.abs(self.held[row]).max(initial=0.0) for row in self.held if row[0] == quantity]
            self._largest[quantity] = float(max(some))
        return self._largest[quantity]

    def rounded(self, row: Row, *others: Array | float) -> Array:
        """What is allowed of numbers that were computed again, from the held ones or from the drawing.

        They are as far off as the held ones at most, and what made them rounds each a few times.
        """
        largest = max(
            float(np.abs(array).max(initial=0.0)) for array in (self.held[row], *map(np.asarray, others))
        )
        return np.asarray(2.0 * self.allowed[row] + 8.0 * EPS * largest)

    def share_apart(self, rows: tuple[Row, ...]) -> float | None:
        """The largest difference of rows in parts of the largest held number; None where there is none."""
        if rows not in self._apart:
            finite = all(np.isfinite(self.given[row]).all() for row in rows)
            most = max(float(np.abs(self.held[row]).max()) for row in rows)
            apart = max(float(np.abs(self.given[row] - self.held[row]).max()) for row in rows)
            self._apart[rows] = apart / most if finite and most > 0.0 else None
        return self._apart[rows]

    def distinct(self, rows: tuple[Row, ...]) -> int:
        """How many distinct numbers that are off rows have, beside one of each axis; the fewer of both sides.

        One number of each axis is none to tell anything by.
        """
        if rows not in self._distinct:
            self._distinct[rows] = min(
                self._distinct_of(numbers, rows) for numbers in (self.held, self.given)
            )
        return self._distinct[rows]

    def _distinct_of(self, numbers: Rows, rows: tuple[Row, ...]) -> int:
        values: dict[int, list[Array]] = {}
        steps: dict[int, float] = {}
        for row in rows:
            part = numbers[row].reshape(len(self.times), -1)
            allowed = self.allowed[row] + self.own.get(row, 0.0)
            off = ~(np.abs(self.given[row] - self.held[row]) <= allowed).reshape(part.shape)
            # Two numbers of which each may be off by what is allowed, on both sides.
            step = max(4.0 * float(allowed.max()), 1e-9 * float(np.abs(part).max(initial=0.0)))
            for axis in range(part.shape[1]):
                values.setdefault(axis, []).append(part[off[:, axis], axis])
                steps[axis] = max(steps.get(axis, 0.0), step)
        return sum(max(_apart_by(steps[axis], np.concatenate(some)) - 1, 0) for axis, some in values.items())

    @cached_property
    def _apart(self) -> dict[tuple[Row, ...], float | None]:
        return {}

    @cached_property
    def _largest(self) -> dict[str, float]:
        return {}

    @cached_property
    def _distinct(self) -> dict[tuple[Row, ...], int]:
        return {}

    def wrong_of(self, quantity: str) -> tuple[Row, ...]:
        """The rows of a quantity that disagree."""
        return tuple(row for row in self.wrong if row[0] == quantity)

    @property
    def beside(self) -> tuple[Row, ...]:
        """The rows that agree, of quantities of which others disagree."""
        return tuple(r for r in self.held if r[0] in self.wrong_quantities and r not in self.wrong)

    @property
    def wrong_quantities(self) -> tuple[str, ...]:
        """The quantities of which a row disagrees."""
        return tuple(dict.fromkeys(row[0] for row in self.wrong))

    @cached_property
    def axes(self) -> CarAxes:
        """The car's directions."""
        part = self.scene.mechanism
        return CarAxes(np.array(part.up), np.array(part.right), part.outboard)

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
