"""What is done to numbers alone: signs, axes, units, offsets, factors, digits, others' places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import permutations, product
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pointcoord import PointcoordError, solve_poses
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order, together
from validate.diagnosis.hypothesis import Hypothesis, Undo, WouldBe
from validate.diagnosis.least import roundest
from validate.tables.units import FORCES

Array = NDArray[np.float64]


class Unit(NamedTuple):
    """Another unit.

    Attributes:
        words: for what it was taken.
        of: mm, rad, N, % or s, which it stands for.
        factor: a number in our unit times this is the number in that one; per second of a rate for s.
        orders: of time derivatives of which it is in use.
    """

    words: str
    of: str
    factor: float
    orders: tuple[int, ...] = (0, 1, 2)


UNITS = (
    Unit("degrees for radians", "rad", 180.0 / pi),
    Unit("degrees taken for radians and converted once more", "rad", pi / 180.0),
    Unit("minutes of arc for radians", "rad", 60.0 * 180.0 / pi),
    Unit("minutes of arc taken for degrees", "rad", 60.0),
    Unit("turns for radians", "rad", 0.5 / pi),
    Unit("turns per minute for rad/s", "rad", 30.0 / pi, (1,)),
    Unit("m for mm", "mm", 1e-3),
    Unit("cm for mm", "mm", 1e-1),
    Unit("inches for mm", "mm", 1.0 / 25.4),
    Unit("mm taken for m and converted once more", "mm", 1e3),
    Unit("mm taken for inches and converted once more", "mm", 25.4),
    Unit("multiples of 9.80665 m/s^2 for mm/s^2", "mm", 1.0 / 9806.65, (2,)),
    Unit("kN for N", "N", 1e-3),
    Unit("pounds for N", "N", 1.0 / FORCES["lbf"]),
    Unit("parts of 1 for %", "%", 1e-2),
    Unit("per millisecond for per second", "s", 1e-3, (1, 2)),
    Unit("per minute for per second", "s", 60.0, (1, 2)),
)
# A factor near 1 is what least squares makes of any small difference, such as that of two cars.
NEAR_ONE = 0.01
MOST_DIGITS = 10
FEW = 64  # instants at which axes are tried first
SINGLE = float(np.finfo(np.float32).eps)


def _vectors(rows: Iterable[Row]) -> list[Row]:
    return [row for row in rows if kind_of(row) != "car"]


def other_signs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Of one, two or all components of vectors, or of a number of the car as a whole, as of toe in or out."""
    vectors = _vectors(evidence.wrong)
    for signs in product((1.0, -1.0), repeat=3):
        flipped = [axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0]
        if flipped and vectors:
            # Rows that agree as well, so that it is known whether they would under the fault.
            rows: dict[Row, WouldBe] = {
                row: (evidence.held[row] * np.array(signs), evidence.allowed[row])
                for row in (*vectors, *_vectors(evidence.beside))
            }
            words = f"the other sign of {' and '.join(flipped)}"
            undo = partial(_signed, np.array(signs))
            yield Hypothesis(tuple(flipped), words, rows, cost=1.0 + 0.1 * len(flipped), undo=undo)
    cars = [row for row in evidence.wrong if kind_of(row) == "car"]
    if cars:
        turned = {row: (-evidence.held[row], evidence.allowed[row]) for row in cars}
        yield Hypothesis("car", "the other sign", turned)


def _signed(signs: Array, row: Row, numbers: Array) -> Array:
    return numbers if kind_of(row) == "car" else np.asarray(numbers * signs)


def _in_axes(evidence: Evidence, matrix: Array, rows: Iterable[Row]) -> dict[Row, WouldBe]:
    """Vectors in other axes; what a body turns by keeps its sense only where the axes stay right-handed."""
    exact = np.isin(np.abs(matrix), (0.0, 1.0)).all()
    found: dict[Row, WouldBe] = {}
    for row in _vectors(rows):
        allowed = evidence.allowed[row] if exact else evidence.rounded(row)
        found[row] = (_turned(matrix, row, evidence.held[row]), allowed @ np.abs(matrix).T)
    return found


def _turned(matrix: Array, row: Row, vectors: Array) -> Array:
    """Vectors of a row in other axes; those of a number of the car are no vectors."""
    if kind_of(row) == "car":
        return vectors
    axial = np.linalg.det(matrix) if kind_of(row) == "body" else 1.0
    return np.asarray(vectors @ (np.sign(axial) * matrix).T)


def _back(matrix: Array) -> Undo:
    """From other axes to ours."""
    return partial(_turned, matrix.T)


def exchanged_axes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Axes in another order, with or without other signs.

    Those that do not even halve a difference at a few instants are left out.
    """
    few = evidence.thinned(FEW)
    vectors = _vectors(few.wrong)
    before = {row: few.left(row, few.held[row], few.allowed[row]) for row in vectors}
    if not vectors:
        return
    for places, signs in product([*permutations(range(3))][1:], product((1.0, -1.0), repeat=3)):
        matrix = np.zeros((3, 3))
        matrix[range(3), places] = signs
        there = _in_axes(few, matrix, vectors)
        if all(few.left(row, *there[row]) > max(1.0, 0.5 * before[row]) for row in vectors):
            continue
        named = tuple("-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True))
        rows = _in_axes(evidence, matrix, (*evidence.wrong, *evidence.beside))
        words = f"other axes: its x, y, z are our {', '.join(named)}"
        cost = 1.5 + 0.01 * sum(s < 0.0 for s in signs)
        yield Hypothesis(named, words, rows, cost=cost, undo=_back(matrix))


def mirrored(evidence: Evidence) -> Iterator[Hypothesis]:
    """Left for right: vectors are mirrored in the car's middle plane, angles that count outboard stay."""
    right = evidence.axes.right
    matrix = np.eye(3) - 2.0 * np.outer(right, right)
    rows = _in_axes(evidence, matrix, evidence.held)
    rows |= {r: (evidence.held[r], evidence.allowed[r]) for r in evidence.held if kind_of(r) == "car"}
    words = "left for right: the car is mirrored"
    yield Hypothesis("mirror", words, rows, whole=True, undo=_back(matrix))


def other_units(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each unit, of all rows that may have it."""
    for unit in UNITS:
        rows = {}
        for row in evidence.wrong:
            if order(row) in unit.orders and unit.of in ("s", length_or_angle(row)):
                factor = unit.factor ** order(row) if unit.of == "s" else unit.factor
                rows[row] = (factor * evidence.held[row], factor * evidence.rounded(row))
        if rows:
            # A velocity in m/s is one in mm per millisecond: the length is meant.
            cost = 1.05 if unit.of == "s" else 1.0
            yield Hypothesis(unit.words, unit.words, rows, cost=cost, undo=partial(_in_our_unit, unit))


def _in_our_unit(unit: Unit, row: Row, numbers: Array) -> Array:
    """Numbers of a row that are given in another unit."""
    return np.asarray(numbers / (unit.factor ** order(row) if unit.of == "s" else unit.factor))


def factors(evidence: Evidence) -> Iterator[Hypothesis]:
    """One factor that is no known unit's, by least squares, and far enough from 1 to be meant."""
    for some in together(evidence.wrong):
        ours, theirs = (np.concatenate([part[row].ravel() for row in some]) for part in evidence.both)
        square = float(ours @ ours)
        factor = float(ours @ theirs) / square if square > 0.0 else np.nan
        if not np.isfinite(factor) or factor == 0.0 or abs(factor - 1.0) <= NEAR_ONE:
            continue
        explains = partial(_explains, evidence, some)
        # So many decimals of the factor's own power of ten.
        near = float(roundest(factor, 7, explains, 10.0 ** np.floor(np.log10(abs(factor)))))
        if explains(near):
            yield Hypothesis(f"{near:.9g}", f"{near:.7g} times ours", _times(evidence, some, near), 1, 2.0)


def _times(evidence: Evidence, rows: Iterable[Row], factor: float) -> dict[Row, WouldBe]:
    return {row: (factor * evidence.held[row], abs(factor) * evidence.rounded(row)) for row in rows}


def _explains(evidence: Evidence, rows: Iterable[Row], factor: Array | float) -> bool:
    """Whether rows are so many times ours."""
    would_be = _times(evidence, rows, float(factor))
    return all(evidence.left(row, *numbers) <= 1.0 for row, numbers in would_be.items())


def _less(evidence: Evidence, row: Row, value: Array | float) -> WouldBe:
    return evidence.held[row] - value, evidence.rounded(row, value)


def _is_less(evidence: Evidence, row: Row, offset: Array) -> bool:
    """Whether a row is ours and so much more."""
    return evidence.left(row, *_less(evidence, row, -offset)) <= 1.0


def offsets(evidence: Evidence) -> Iterator[Hypothesis]:
    """What is subtracted: the first value, the drawing's, another origin of all points, a constant.

    A constant of one point beside others that are off as well is said where it is all that is wrong with it.
    """
    placed = [row for row in evidence.wrong if order(row) == 0]
    first = {row: _less(evidence, row, evidence.held[row][0]) for row in placed}
    if first:
        yield Hypothesis("first", "the value at the first instant is subtracted", first)
    drawn = {row: _less(evidence, row, value) for row, value in _as_drawn(evidence, placed).items()}
    if drawn:
        yield Hypothesis("drawn", "the value of the drawing is subtracted", drawn, cost=1.2)
    points = [row for row in placed if kind_of(row) == "point"]
    yield from _origin(evidence, points)
    for row in placed:
        gap = _constant_of(evidence, row)
        noise = float(evidence.rounded(row).max())
        if np.isfinite(gap).all() and np.abs(gap).max() > 8.0 * noise and len(evidence.times) > 2:
            _, unit = evidence.theirs.get(row, ("", 1.0))
            near = np.where(np.abs(gap) <= noise, 0.0, gap)
            gap = roundest(near, 7, partial(_is_less, evidence, row), unit)
            if row in points and len(points) > 1 and not _is_less(evidence, row, gap):
                continue
            words, count = f"a constant offset of {evidence.in_words(row, gap)}", max(np.size(gap), 1)
            yield Hypothesis((row, "constant"), words, {row: _less(evidence, row, -gap)}, count, 1.0 + count)


def _constant_of(evidence: Evidence, row: Row) -> Array:
    """By what a row differs from ours: amid what its digits leave open, where the mean may lie beside."""
    apart = evidence.given[row] - evidence.held[row]
    off = evidence.rounded(row) + evidence.own.get(row, 0.0)
    amid = np.asarray(0.5 * ((apart - off).max(axis=0) + (apart + off).min(axis=0)))
    return amid if _is_less(evidence, row, amid) else np.asarray(apart.mean(axis=0))


def _as_drawn(evidence: Evidence, rows: Iterable[Row]) -> dict[Row, float]:
    """Numbers of the car as it is drawn, of those rows that are such."""
    of_the_car = [row for row in rows if kind_of(row) == "car"]
    try:
        scene = evidence.solved.fine
        numbers = solve_poses(scene, drawn_inputs(scene)).numbers if of_the_car else {}
    except PointcoordError:
        return {}
    return {(q, name): float(numbers[q][name]) for q, name in of_the_car if name in numbers[q]}


def _origin(evidence: Evidence, rows: list[Row]) -> Iterator[Hypothesis]:
    """One shift for all points; of another origin only where every given point has it."""
    if len(rows) < 2:
        return  # one point alone tells of no other
    # Not the mean: a few points may be elsewhere by themselves besides.
    shift = np.median(np.concatenate([evidence.given[row] - evidence.held[row] for row in rows]), axis=0)
    shift[np.abs(shift) < max(float(evidence.rounded(row).max()) for row in rows)] = 0.0
    fitted = int(np.count_nonzero(shift))
    if not fitted or not np.isfinite(shift).all():
        return
    moved = {row: _less(evidence, row, -shift) for row in rows}
    points = [row for row in evidence.given if row[0] == rows[0][0]]
    every = set(points) == set(rows) and all(evidence.left(row, *moved[row]) <= 1.0 for row in rows)
    # The points that agree say where the origin is: what is off beside them is off by itself.
    found = evidence.in_words(rows[0], shift)
    words = f"another origin: every point is shifted by {found}" if every else f"shifted by {found}"
    undo = partial(_shifted, -shift)
    yield Hypothesis("origin", words, moved, fitted, 1.0 + 0.5 * fitted, undo=undo)


def _shifted(shift: Array, row: Row, places: Array) -> Array:
    return np.asarray(places + shift)


def _decimal_step(numbers: Array, places: int) -> Array:
    """The last place of numbers of so many decimals."""
    return np.full(numbers.shape, 10.0**-places)


def _significant_step(numbers: Array, digits: int) -> Array:
    """The last place of numbers of so many significant digits."""
    size = np.floor(np.log10(np.maximum(np.abs(numbers), 1e-300)))
    return np.asarray(10.0 ** (size - digits + 1.0))


def _are_multiples(numbers: Array, step: Array) -> bool:
    """Whether all numbers are multiples of their steps, as nearly as a double can be."""
    places = numbers / step
    return bool((np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all())


def printed_digits(evidence: Evidence) -> Iterator[Hypothesis]:
    """The fewest decimals and significant digits that the given numbers have, and single precision.

    Half of the last place is what they may be off.
    """
    for rows in together(evidence.wrong):
        theirs, _ = evidence.joined(rows)
        if not np.isfinite(theirs).all():
            continue
        for what, step in (("decimals", _decimal_step), ("significant digits", _significant_step)):
            for count in range(what != "decimals", MOST_DIGITS + 1):
                if _are_multiples(theirs, step(theirs, count)):
                    found = {row: _looser(evidence, row, step(evidence.given[row], count)) for row in rows}
                    said = f"{count} {what}"
                    yield Hypothesis(said, f"printed with {said}", found, cost=1.05, looser=True)
                    break
        if (np.abs(theirs) < np.finfo(np.float32).max).all() and (theirs == theirs.astype(np.float32)).all():
            found = {row: _looser(evidence, row, SINGLE * np.abs(evidence.held[row])) for row in rows}
            yield Hypothesis("single", "printed or kept in single precision", found, looser=True)


def _looser(evidence: Evidence, row: Row, last_place: Array) -> WouldBe:
    """The numbers as they are held, and half of a last place more that they may be off."""
    held = evidence.held[row]
    return held, evidence.allowed[row] + 0.5 * last_place + EPS * np.abs(held)
