"""Faults that need only arithmetic: signs, axes, units and other factors; another definition of an angle; a
wrong row or instant; an offset; and rounding to printed digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import combinations, permutations, product
from math import pi
from typing import NamedTuple

import numpy as np

from pointcoord import PointcoordError, solve_poses
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.effects.car_number import Angle
from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import QUANTITIES, number_called
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.diagnosis.evidence import ANY, Evidence, Hypothesis, Row, WouldBe, roundest, together
from validate.plain_text import counted_as

Times = Callable[[Row], float | Array]
"""The factor or the matrix, (3, 3), by which the numbers of a row are multiplied."""

# Closer to 1 a factor is not reported: least squares gives such a factor for any small difference.
NEAR_ONE = 0.01


class Unit(NamedTuple):
    """A wrong unit.

    Attributes:
        words: the fault in words.
        of: the unit that it replaces: mm, rad or s.
        factor: the number in the wrong unit over the number in the right one; for s, per order of a rate.
    """

    words: str
    of: str
    factor: float

    def has(self, row: Row) -> bool:
        """Whether the numbers of a row may have this fault."""
        return row.order > 0 if self.of == "s" else self.of == row.unit

    def times(self, row: Row) -> float:
        """The factor of the numbers of a row."""
        return self.factor**row.order if self.of == "s" else self.factor


UNITS = (
    Unit("degrees for radians", "rad", 180.0 / pi),
    Unit("radians taken for degrees, or converted to radians twice", "rad", pi / 180.0),
    Unit("minutes of arc taken for degrees", "rad", 60.0),
    Unit("m for mm", "mm", 1e-3),
    Unit("inches for mm", "mm", 1.0 / 25.4),
    Unit("mm taken for m, or converted to mm twice", "mm", 1e3),
    Unit("per minute for per second", "s", 60.0),
    Unit("per millisecond for per second", "s", 1e-3),
)


def _rows(evidence: Evidence, rows: Iterable[Row], times: Times) -> dict[Row, WouldBe]:
    found: dict[Row, WouldBe] = {}
    for row in rows:
        by = times(row)
        # A sign or a permutation causes no rounding.
        exact = np.isin(np.abs(by), (0.0, 1.0)).all()
        allowed = evidence.allowed[row] if exact else evidence.rounded(row)
        found[row] = _product(by, evidence.held[row]), _product(np.abs(by), allowed)
    return found


def _product(by: float | Array, numbers: Array) -> Array:
    return np.asarray(numbers @ by.T if isinstance(by, np.ndarray) else by * numbers)


def _turned(matrix: Array, axial: bool, row: Row) -> float | Array:
    """The matrix for the vectors of a row in other axes; 1 for a number of the car.

    Args:
        matrix: orthogonal.
        axial: whether the axes are changed, and not only signs written: then an angular velocity also changes
            its sign if the new axes are left-handed.
    """
    if row.of == "car":
        return 1.0
    return matrix * np.sign(np.linalg.det(matrix)) if axial and row.of == "body" else matrix


def _linear(
    evidence: Evidence, words: str, rows: Iterable[Row], times: Times, cost: float = 1.0, whole: bool = False
) -> Hypothesis:
    return Hypothesis(words, _rows(evidence, rows, times), cost=cost, whole=whole)


def other_signs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Opposite signs of one, two or all components of vectors, or of a number of the car, such as toe."""
    for signs in [*product((1.0, -1.0), repeat=3)][1:]:
        flipped = [axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0]
        times = partial(_turned, np.diag(signs), False)
        words, cost = f"the other sign of {' and '.join(flipped)}", 1.0 + 0.1 * len(flipped)
        yield _linear(evidence, words, evidence.vectors, times, cost)
    cars = [row for row in evidence.wrong if row.of == "car"]
    yield _linear(evidence, "the other sign", cars, lambda _: -1.0)


def exchanged_axes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Axes in another order, with or without opposite signs.

    Permutations that do not at least halve a difference at a few instants are skipped.
    """
    few = evidence.few
    before = {row: few.left(row, few.held[row], few.allowed[row]) for row in few.vectors if row in few.wrong}
    for places, signs in product([*permutations(range(3))][1:], product((1.0, -1.0), repeat=3)):
        matrix = np.zeros((3, 3))
        matrix[range(3), places] = signs
        times = partial(_turned, matrix, True)
        there = _rows(few, before, times)
        if any(few.left(row, *there[row]) <= max(1.0, 0.5 * before[row]) for row in before):
            named = ("-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True))
            words, cost = f"other axes: its x, y, z are our {', '.join(named)}", 1.5
            yield _linear(evidence, words, evidence.vectors, times, cost + 0.01 * sum(s < 0.0 for s in signs))


def mirrored(evidence: Evidence) -> Iterator[Hypothesis]:
    """Left and right exchanged: vectors are mirrored in the car's middle plane; numbers of the car stay."""
    right = evidence.scene.mechanism.axes.right
    times = partial(_turned, np.eye(3) - 2.0 * np.outer(right, right), True)
    yield _linear(evidence, "left for right: the car is mirrored", evidence.held, times, whole=True)


def other_units(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each wrong unit, for all rows that may have it."""
    for unit in UNITS:
        yield _linear(evidence, unit.words, filter(unit.has, evidence.wrong), unit.times)


def factors(evidence: Evidence) -> Iterator[Hypothesis]:
    """A factor by least squares that is not that of a known unit, and not close to 1."""
    for some in together(evidence.wrong):
        factor = _factor(evidence, some)
        if factor is not None:
            words = f"{factor:.7g} times ours"
            yield Hypothesis(words, _times(evidence, some, factor), 1, 2.0)


def _factor(evidence: Evidence, rows: Sequence[Row]) -> float | None:
    ours, theirs, off = evidence.joined(rows)
    square = float(ours @ ours)
    found = float(ours @ theirs) / square if square > 0.0 else np.nan
    # The middle of the interval that the digits allow, if there is one, and not the least-squares factor.
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = np.sort([(theirs - off) / ours, (theirs + off) / ours], axis=0)
    # fmax and fmin ignore NaN, and return NaN if there is nothing else.
    if (least := np.fmax.reduce(low)) <= (most := np.fmin.reduce(high)):
        found = 0.5 * float(least + most)
    if not np.isfinite(found) or found == 0.0 or abs(found - 1.0) <= NEAR_ONE:
        return None
    # Rounded in units of its own power of ten.
    unit = 10.0 ** np.floor(np.log10(abs(found)))
    return float(roundest(found, lambda near: evidence.explained(_times(evidence, rows, near)), unit))


def _times(evidence: Evidence, rows: Sequence[Row], factor: Array | float) -> dict[Row, WouldBe]:
    return _rows(evidence, rows, lambda _: float(factor))


DEFINITIONS: Mapping[str, Callable[[Array, Array, Array], Array]] = {
    "arcsin of the component, not projected": lambda p, q, n: np.arcsin(p / n),
    "arctan of the component of a unit vector": lambda p, q, n: np.arctan(p / n),
    "the component of a unit vector, no angle": lambda p, q, n: p / n,
    "the slope, no angle": lambda p, q, n: p / q,
    "the sine, no angle": lambda p, q, n: p / np.hypot(p, q),
}
"""Other definitions of an angle, which pointcoord defines as projected: atan2(p, q), with p and q the
components of a line along two directions of the car, and n its length. Adams' turning tables print the
arcsine of camber, OptimumK the arcsine of toe."""

MEANT = 8.0  # an offset must be more than so many times the tolerance of recomputed numbers
MOST_DIGITS = 10
SINGLE = float(np.finfo(np.float32).eps)


def other_definitions(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each other definition, for all angles that disagree."""
    for row in evidence.wrong:
        angle, wheel = number_called(row.name), Wheel.of(evidence.scene.mechanism.topology, row.name)
        if row.of != "car" or not isinstance(angle, Angle):
            continue
        start, end = (evidence.places(point) for point in angle.ends(wheel))
        if start is None or end is None:
            continue
        length = np.linalg.norm(end - start, axis=-1)
        axes = evidence.scene.mechanism.axes.on(wheel.side)
        p, q = (axes.component(end - start, direction) for direction in (angle.sine, angle.cosine))
        # The line is a difference of rounded coordinates: a few roundings of these.
        size = max(float(np.abs(start).max()), float(np.abs(end).max()))
        for words, rule in DEFINITIONS.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                value = rule(p, q, length)
            if np.isfinite(value).all():
                allowed = evidence.rounded(row, value) + 8.0 * EPS * size / length
                yield Hypothesis(words, {row: (value, allowed)}, cost=1.2)


def swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two quantities are swapped, such as velocities and accelerations."""
    for one, two in combinations(sorted(evidence.wrong_quantities), 2):
        other = {one: two, two: one}
        rows = {row: Row(other[row.quantity], row.name) for row in evidence.wrong if row.quantity in other}
        words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
        yield Hypothesis(words, _of_others(evidence, rows), cost=1.1)


def names_exchanged(evidence: Evidence) -> Iterator[Hypothesis]:
    """Numbers of two points, bodies or angles under each other's names, or of one under another's name."""
    few, wrong = evidence.few, sorted({row.name for row in evidence.wrong})
    right = sorted({row.name for row in evidence.held}.difference(wrong))
    faults = [(f"{a} and {b} are exchanged", {a: b, b: a}) for a, b in combinations(wrong, 2)]
    faults += [(f"the numbers of {b}, not of {a}", {a: b}) for a, b in product(wrong, right)]
    for words, other in faults:
        rows = {row: Row(row.quantity, other[row.name]) for row in evidence.wrong if row.name in other}
        if few.explained(_of_others(few, rows)):
            yield Hypothesis(words, _of_others(evidence, rows), cost=1.1)


def _of_others(evidence: Evidence, others: Mapping[Row, Row]) -> dict[Row, WouldBe]:
    """Rows with the numbers of other rows, if these exist and have the same shape."""
    held = evidence.held
    return {
        row: (held[other], evidence.allowed[other])
        for row, other in others.items()
        if other in held and held[other].shape == held[row].shape
    }


def of_another_instant(evidence: Evidence) -> Iterator[Hypothesis]:
    """All numbers are shifted by one row; the first or the last one, which is left over, may be anything."""
    count = len(evidence.times)
    for words, late, left_over in (("one sample late", 1, 0), ("one sample early", -1, -1)):
        places = (np.arange(count) - late) % count
        rows: dict[Row, WouldBe] = {}
        for row in evidence.looked:
            allowed = evidence.allowed[row][places]
            allowed[left_over] = ANY
            rows[row] = evidence.held[row][places], allowed
        yield Hypothesis(words, rows, cost=1.2)


def offsets(evidence: Evidence) -> Iterator[Hypothesis]:
    """Offsets of positions and angles: the drawn value subtracted, or a constant added."""
    as_drawn = _as_drawn(evidence)
    for row in evidence.wrong if len(evidence.times) > 2 else ():
        if row in as_drawn:
            less = so_much_more(evidence, row, -as_drawn[row])
            yield Hypothesis("the value of the drawing is subtracted", less)
        gap = constant_gap(evidence, row, MEANT) if row.order == 0 else None
        if gap is not None:
            unit, factor = evidence.unit_of(row)
            amount = ", ".join(f"{component + 0.0:.6g}" for component in np.ravel(gap / factor))
            amount = f"({amount})" if gap.ndim else amount
            words = f"a constant offset of {amount} {unit}"
            count = int(np.count_nonzero(gap))
            yield Hypothesis(words, so_much_more(evidence, row, gap), count, 1.0 + count)


def constant_gap(evidence: Evidence, row: Row, least: float = 1.0) -> Array | None:
    """The constant difference that fits the numbers of a row best, rounded as far as they allow.

    None if it is at most `least` times the tolerance of recomputed numbers.
    """
    apart, off = evidence.given[row] - evidence.held[row], evidence.rounded(row)
    noise = float(off.max())
    off = off + evidence.own.get(row, 0.0)
    # The middle of the interval that the digits allow.
    gap = np.asarray(0.5 * ((apart - off).max(axis=0) + (apart + off).min(axis=0)))
    if not (np.isfinite(gap).all() and np.abs(gap).max() > least * noise):
        return None
    gap = np.where(np.abs(gap) <= noise, 0.0, gap)
    unit = evidence.unit_of(row)[1]
    return roundest(gap, lambda near: evidence.explained(so_much_more(evidence, row, near)), unit)


def so_much_more(evidence: Evidence, row: Row, amount: Array) -> dict[Row, WouldBe]:
    """The numbers of a row with an amount added."""
    return {row: (evidence.held[row] + amount, evidence.rounded(row, amount))}


def _as_drawn(evidence: Evidence) -> dict[Row, Array]:
    """The drawn values of the positions and of the numbers of the car that disagree."""
    rows = [row for row in evidence.wrong if row.of != "body" and row.order == 0]
    try:
        scene = evidence.solved.fine
        numbers = solve_poses(scene, drawn_inputs(scene)).numbers if rows else {}
    except PointcoordError:
        return {}
    return {
        row: np.asarray(numbers[row.quantity][row.name]) for row in rows if row.name in numbers[row.quantity]
    }


def printed_digits(evidence: Evidence) -> Iterator[Hypothesis]:
    """Rounding to the fewest decimals that the given numbers have, or to single precision.

    The tolerance is widened by half of the last place.
    """
    for rows in together(evidence.wrong):
        _, theirs, _ = evidence.joined(rows)
        if not np.isfinite(theirs).all():
            continue
        for count in range(MOST_DIGITS + 1):
            places = theirs * 10.0**count
            if (np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all():
                found = {row: _looser(evidence, row, np.asarray(10.0**-count)) for row in rows}
                yield Hypothesis(
                    f"printed with {counted_as(count, 'decimal')}", found, cost=1.05, looser=True
                )
                break
        if (np.abs(theirs) < np.finfo(np.float32).max).all() and (theirs == theirs.astype(np.float32)).all():
            found = {row: _looser(evidence, row, SINGLE * np.abs(evidence.held[row])) for row in rows}
            yield Hypothesis("printed or kept in single precision", found, looser=True)


def _looser(evidence: Evidence, row: Row, last_place: Array) -> WouldBe:
    """The held numbers, with a tolerance widened by half of a last place."""
    held = evidence.held[row]
    return held, evidence.allowed[row] + 0.5 * last_place + EPS * np.abs(held)
