"""Faults that need only arithmetic: signs, axes, units and other factors; another definition of an angle;
numbers of another row or instant; an offset; and rounding to printed digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import combinations, permutations, product
from math import pi

import numpy as np

from pointcoord.effects.car_number import Angle
from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import QUANTITIES, number_called
from pointcoord.numerics.rounding import EPS
from validate.arrays import Array
from validate.diagnosis.evidence import Evidence, Row, WouldBe, roundest, together
from validate.diagnosis.fault import ANY, Fault
from validate.plain_text import counted_as

UNITS = (
    ("degrees for radians", "rad", 180.0 / pi),
    ("radians taken for degrees, or converted to radians twice", "rad", pi / 180.0),
    ("minutes of arc taken for degrees", "rad", 60.0),
    ("m for mm", "mm", 1e-3),
    ("inches for mm", "mm", 1.0 / 25.4),
    ("mm taken for m, or converted to mm twice", "mm", 1e3),
    ("per minute for per second", "s", 60.0),
    ("per millisecond for per second", "s", 1e-3),
)
"""Wrong units: in words, the unit that each replaces, and the number in the wrong unit over the number in the
right one; for s, per order of a rate."""

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

# Closer to 1 a factor is not reported: least squares gives such a factor for any small difference.
NEAR_ONE = 0.01
MEANT = 8.0  # an offset must be more than so many times the tolerance of recomputed numbers
MOST_DIGITS = 10
SINGLE = np.finfo(np.float32)


def _times(evidence: Evidence, factors: Mapping[Row, Array | float]) -> dict[Row, WouldBe]:
    """Rows, each multiplied by its factor or by its matrix, (3, 3)."""
    found: dict[Row, WouldBe] = {}
    for row, by in factors.items():
        # A sign or a permutation causes no rounding.
        exact = np.isin(np.abs(by), (0.0, 1.0)).all()
        allowed = evidence.allowed[row] if exact else evidence.rounded(row)
        if np.ndim(by):
            found[row] = evidence.trusted[row] @ np.transpose(by), allowed @ np.abs(np.transpose(by))
        else:
            found[row] = by * evidence.trusted[row], np.abs(by) * allowed
    return found


def _in_axes(evidence: Evidence, rows: Iterable[Row], matrix: Array) -> dict[Row, WouldBe]:
    """Rows in other axes, by an orthogonal matrix; numbers of the car stay.

    An angular velocity also changes its sign if the new axes are left-handed.
    """
    handed = {"car": 1.0, "body": matrix * np.sign(np.linalg.det(matrix))}
    return _times(evidence, {row: handed.get(row.of, matrix) for row in rows})


def _vectors(evidence: Evidence) -> list[Row]:
    return [row for row in evidence.looked if row.of != "car"]


def other_signs(evidence: Evidence) -> Iterator[Fault]:
    """Opposite signs of one, two or all components of vectors, or of a number of the car, such as toe."""
    for signs in [*product((1.0, -1.0), repeat=3)][1:]:
        flipped = [axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0]
        rows = _times(evidence, dict.fromkeys(_vectors(evidence), np.diag(signs)))
        yield Fault(f"the other sign of {' and '.join(flipped)}", rows, cost=1.0 + 0.1 * len(flipped))
    cars = {row: -1.0 for row in evidence.wrong if row.of == "car"}
    yield Fault("the other sign", _times(evidence, cars))


def exchanged_axes(evidence: Evidence) -> Iterator[Fault]:
    """Axes in another order, with or without opposite signs.

    Permutations that do not at least halve a difference at a few instants are skipped.
    """
    few = evidence.few
    before = {r: few.left(r, few.trusted[r], few.allowed[r]) for r in _vectors(few) if r in few.wrong}
    for places, signs in product([*permutations(range(3))][1:], product((1.0, -1.0), repeat=3)):
        matrix = np.zeros((3, 3))
        matrix[range(3), places] = signs
        there = _in_axes(few, before, matrix)
        if any(few.left(row, *there[row]) <= max(1.0, 0.5 * before[row]) for row in before):
            named = ", ".join("-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True))
            rows = _in_axes(evidence, _vectors(evidence), matrix)
            cost = 1.5 + 0.01 * sum(s < 0.0 for s in signs)
            yield Fault(f"other axes: its x, y, z are our {named}", rows, cost=cost)


def mirrored(evidence: Evidence) -> Iterator[Fault]:
    """Left and right exchanged: vectors are mirrored in the car's middle plane; numbers of the car stay."""
    right = evidence.scene.mechanism.axes.right
    rows = _in_axes(evidence, evidence.trusted, np.eye(3) - 2.0 * np.outer(right, right))
    yield Fault("left for right: the car is mirrored", rows, whole=True)


def other_units(evidence: Evidence) -> Iterator[Fault]:
    """Each wrong unit, for all rows that may have it."""
    for words, unit, factor in UNITS:
        if unit == "s":
            factors = {row: factor**row.order for row in evidence.wrong if row.order}
        else:
            factors = {row: factor for row in evidence.wrong if row.unit == unit}
        yield Fault(words, _times(evidence, factors))


def other_factors(evidence: Evidence) -> Iterator[Fault]:
    """A factor that fits best, not that of a known unit, and not close to 1."""
    for rows in together(evidence.wrong):
        if (factor := _factor(evidence, rows)) is not None:
            found = _times(evidence, dict.fromkeys(rows, factor))
            yield Fault(f"{factor:.7g} times ours", found, 1, 2.0)


def _factor(evidence: Evidence, rows: Sequence[Row]) -> float | None:
    """The factor that fits the numbers of rows best, rounded in units of its power of ten."""
    ours, theirs, off = evidence.joined(rows)
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = np.sort([(theirs - off) / ours, (theirs + off) / ours], axis=0)
    found = float(_middle(low, high))
    if not np.isfinite(found) or found == 0.0 or abs(found - 1.0) <= NEAR_ONE:
        return None

    def fits(near: Array) -> bool:
        return evidence.explained(_times(evidence, dict.fromkeys(rows, near)))

    return float(roundest(found, fits, 10.0 ** np.floor(np.log10(abs(found)))))


def _middle(low: Array, high: Array) -> Array:
    """The middle of the numbers that all intervals from low to high, (N,) or (N, 3), have in common.

    If they have none in common, the number that is nearest to all of them. NaN is ignored.
    """
    return np.asarray(0.5 * (np.fmax.reduce(low) + np.fmin.reduce(high)))


def offsets(evidence: Evidence) -> Iterator[Fault]:
    """Offsets of positions and angles: the drawn position subtracted, or a constant added."""
    drawn = evidence.scene.mechanism.points
    for row in evidence.wrong if len(evidence.times) > 2 else ():
        if row.is_place and row.name in drawn:
            less = _plus(evidence, row, -np.array(drawn[row.name]))
            yield Fault("the value of the drawing is subtracted", less)
        gap = _constant_gap(evidence, row) if row.order == 0 else None
        if gap is not None:
            unit, factor = evidence.unit_of(row)
            amount = ", ".join(f"{component + 0.0:.6g}" for component in np.ravel(gap / factor))
            words = f"a constant offset of {f'({amount})' if gap.ndim else amount} {unit}"
            count = int(np.count_nonzero(gap))
            yield Fault(words, _plus(evidence, row, gap), count, 1.0 + count)


def _constant_gap(evidence: Evidence, row: Row) -> Array | None:
    """The constant difference that fits the numbers of a row best, rounded as far as they allow; None if it
    may be the error of recomputed numbers."""
    apart, off = evidence.given[row] - evidence.trusted[row], evidence.rounded(row)
    noise = float(off.max())
    off = off + evidence.own.get(row, 0.0)
    gap = _middle(apart - off, apart + off)
    if not (np.isfinite(apart).all() and np.abs(gap).max() > MEANT * noise):
        return None
    gap = np.where(np.abs(gap) <= noise, 0.0, gap)
    unit = evidence.unit_of(row)[1]
    return roundest(gap, lambda near: evidence.explained(_plus(evidence, row, near)), unit)


def _plus(evidence: Evidence, row: Row, amount: Array) -> dict[Row, WouldBe]:
    return {row: (evidence.trusted[row] + amount, evidence.rounded(row, amount))}


def other_definitions(evidence: Evidence) -> Iterator[Fault]:
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
        rounding = 8.0 * EPS * max(float(np.abs(start).max()), float(np.abs(end).max())) / length
        for words, rule in DEFINITIONS.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                value = rule(p, q, length)
            yield Fault(words, {row: (value, evidence.rounded(row, value) + rounding)}, cost=1.2)


def swapped(evidence: Evidence) -> Iterator[Fault]:
    """Two quantities are swapped, such as velocities and accelerations."""
    for one, two in combinations(evidence.wrong_quantities, 2):
        other = {one: two, two: one}
        rows = {row: Row(other[row.quantity], row.name) for row in evidence.wrong if row.quantity in other}
        words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
        yield Fault(words, _of_others(evidence, rows), cost=1.1)


def names_exchanged(evidence: Evidence) -> Iterator[Fault]:
    """Numbers of two points, bodies or angles under each other's names, or of one under another's name."""
    few, wrong = evidence.few, sorted({row.name for row in evidence.wrong})
    right = sorted({row.name for row in evidence.trusted}.difference(wrong))
    faults = [(f"{a} and {b} are exchanged", {a: b, b: a}) for a, b in combinations(wrong, 2)]
    faults += [(f"the numbers of {b}, not of {a}", {a: b}) for a, b in product(wrong, right)]
    for words, other in faults:
        rows = {row: Row(row.quantity, other[row.name]) for row in evidence.wrong if row.name in other}
        if few.explained(_of_others(few, rows)):
            yield Fault(words, _of_others(evidence, rows), cost=1.1)


def _of_others(evidence: Evidence, others: Mapping[Row, Row]) -> dict[Row, WouldBe]:
    """Rows with the numbers of other rows, if these exist and have the same shape."""
    ours = evidence.trusted
    return {
        row: (ours[other], evidence.allowed[other])
        for row, other in others.items()
        if other in ours and ours[other].shape == ours[row].shape
    }


def of_another_instant(evidence: Evidence) -> Iterator[Fault]:
    """All numbers are shifted by one row; the first or the last one, which is left over, may be anything."""
    instants = np.arange(len(evidence.times))
    for words, late, left_over in (("one sample late", 1, 0), ("one sample early", -1, -1)):
        places, rows = (instants - late) % len(instants), dict[Row, WouldBe]()
        for row in evidence.looked:
            allowed = evidence.allowed[row][places]
            allowed[left_over] = ANY
            rows[row] = evidence.trusted[row][places], allowed
        yield Fault(words, rows, cost=1.2)


def printed_digits(evidence: Evidence) -> Iterator[Fault]:
    """Rounding to the fewest decimals that the given numbers have, or to single precision."""
    for rows in together(evidence.wrong):
        _, theirs, _ = evidence.joined(rows)
        if not (np.abs(theirs) < SINGLE.max).all():
            continue
        for count in range(MOST_DIGITS + 1):
            places = theirs * 10.0**count
            if (np.abs(places - np.rint(places)) <= 4.0 * EPS * np.abs(places)).all():
                found = {row: _looser(evidence, row, 10.0**-count) for row in rows}
                words = f"printed with {counted_as(count, 'decimal')}"
                yield Fault(words, found, cost=1.05, looser=True)
                break
        if (theirs == theirs.astype(np.float32)).all():
            found = {row: _looser(evidence, row, SINGLE.eps * np.abs(evidence.trusted[row])) for row in rows}
            yield Fault("printed or kept in single precision", found, looser=True)


def _looser(evidence: Evidence, row: Row, last_place: Array | float) -> WouldBe:
    """The trusted numbers, with a tolerance widened by half of a last place."""
    ours = evidence.trusted[row]
    return ours, evidence.allowed[row] + 0.5 * last_place + EPS * np.abs(ours)
