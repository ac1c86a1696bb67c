"""What is done to every number by a rule: other signs, axes, units or instants, another definition of an
angle, or another number's place.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import combinations, permutations, product
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import QUANTITIES, angle_called
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, WouldBe

Array = NDArray[np.float64]

FEW = 64  # instants at which axes are tried first


class Unit(NamedTuple):
    """Another unit.

    Attributes:
        words: for what it was taken.
        of: mm, rad, or s, which it stands for.
        factor: a number in our unit times this is the number in that one; per second of a rate for s.
    """

    words: str
    of: str
    factor: float


UNITS = (
    Unit("degrees for radians", "rad", 180.0 / pi),
    Unit("degrees taken for radians and converted once more", "rad", pi / 180.0),
    Unit("minutes of arc taken for degrees", "rad", 60.0),
    Unit("m for mm", "mm", 1e-3),
    Unit("inches for mm", "mm", 1.0 / 25.4),
    Unit("mm taken for m and converted once more", "mm", 1e3),
    Unit("per minute for per second", "s", 60.0),
)

DEFINITIONS: Mapping[str, Callable[[Array, Array, Array], Array]] = {
    "arcsin of the component, not projected": lambda p, q, n: np.arcsin(p / n),
    "arctan of the component of a unit vector": lambda p, q, n: np.arctan(p / n),
    "the component of a unit vector, no angle": lambda p, q, n: p / n,
    "the slope, no angle": lambda p, q, n: p / q,
    "the sine, no angle": lambda p, q, n: p / np.hypot(p, q),
}
"""Of an angle, which is projected here: atan2(p, q), with p and q the components of a line along two
directions of the car, and n its length. Adams' turning tables print the arcsine of camber, OptimumK that of
toe."""
BACK: Mapping[str, Callable[[Array], Array]] = {
    "the slope, no angle": np.arctan,
    "the sine, no angle": lambda sine: np.arcsin(np.clip(sine, -1.0, 1.0)),
}
"""Of those that need no line the projected angle."""

SAMPLES: Mapping[str, Callable[[Array], Array]] = {
    "one sample late, the first one twice": lambda x: np.concatenate([x[:1], x[:-1]]),
    "one sample early, the last one twice": lambda x: np.concatenate([x[1:], x[-1:]]),
    "one sample late, the last one first": lambda x: np.concatenate([x[-1:], x[:-1]]),
    "one sample early, the first one last": lambda x: np.concatenate([x[1:], x[:1]]),
}
"""In words, and what is then given of numbers."""


def _turned(matrix: Array, axial: bool, row: Row, numbers: Array) -> Array:
    """Vectors of a row in other axes; those of a number of the car are no vectors.

    Args:
        axial: whether axes are changed, and not only the signs that someone writes: what a body turns by
            keeps its sense only where the axes stay right-handed.
    """
    if kind_of(row) == "car":
        return numbers
    sense = np.sign(np.linalg.det(matrix)) if axial and kind_of(row) == "body" else 1.0
    return np.asarray(numbers @ (sense * matrix).T)


def _in_axes(
    evidence: Evidence, matrix: Array, rows: Iterable[Row], axial: bool = True
) -> dict[Row, WouldBe]:
    exact = np.isin(np.abs(matrix), (0.0, 1.0)).all()
    found: dict[Row, WouldBe] = {}
    for row in rows:
        if kind_of(row) != "car":
            allowed = evidence.allowed[row] if exact else evidence.rounded(row)
            found[row] = _turned(matrix, axial, row, evidence.held[row]), allowed @ np.abs(matrix).T
    return found


def other_signs(evidence: Evidence) -> Iterator[Hypothesis]:
    """Of one, two or all components of vectors, or of a number of the car as a whole, as of toe in or out."""
    cars = [row for row in evidence.wrong if kind_of(row) == "car"]
    for signs in product((1.0, -1.0), repeat=3):
        flipped = tuple(axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0)
        if flipped and len(cars) < len(evidence.wrong):
            words, matrix = f"the other sign of {' and '.join(flipped)}", np.diag(signs)
            rows, undo = (
                _in_axes(evidence, matrix, evidence.looked, axial=False),
                partial(_turned, matrix, False),
            )
            yield Hypothesis(flipped, words, rows, cost=1.0 + 0.1 * len(flipped), undo=undo)
    if cars:
        rows = {row: (-evidence.held[row], evidence.allowed[row]) for row in cars}
        yield Hypothesis("car", "the other sign", rows)


def exchanged_axes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Axes in another order, with or without other signs.

    Those that do not even halve a difference at a few instants are left out.
    """
    few = evidence.thinned(FEW)
    before = {r: few.left(r, few.held[r], few.allowed[r]) for r in few.wrong if kind_of(r) != "car"}
    for places, signs in product([*permutations(range(3))][1:], product((1.0, -1.0), repeat=3)):
        matrix = np.zeros((3, 3))
        matrix[range(3), places] = signs
        there = _in_axes(few, matrix, before)
        if all(few.left(row, *there[row]) > max(1.0, 0.5 * before[row]) for row in before):
            continue
        named = tuple("-" * (s < 0.0) + "xyz"[p] for s, p in zip(signs, places, strict=True))
        words, rows = (
            f"other axes: its x, y, z are our {', '.join(named)}",
            _in_axes(evidence, matrix, evidence.looked),
        )
        cost = 1.5 + 0.01 * sum(s < 0.0 for s in signs)
        yield Hypothesis(named, words, rows, cost=cost, undo=partial(_turned, matrix.T, True))


def mirrored(evidence: Evidence) -> Iterator[Hypothesis]:
    """Left for right: vectors are mirrored in the car's middle plane, angles that count outboard stay."""
    right = evidence.scene.mechanism.axes.right
    matrix = np.eye(3) - 2.0 * np.outer(right, right)
    rows = {row: (evidence.held[row], evidence.allowed[row]) for row in evidence.held}
    rows |= _in_axes(evidence, matrix, evidence.held)
    undo = partial(_turned, matrix.T, True)
    yield Hypothesis("mirror", "left for right: the car is mirrored", rows, whole=True, undo=undo)


def other_units(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each unit, of all rows that may have it."""
    for unit in UNITS:
        rows = {
            row: (_scale(unit, row) * evidence.held[row], _scale(unit, row) * evidence.rounded(row))
            for row in evidence.wrong
            if unit.of == length_or_angle(row) or (unit.of == "s" and order(row))
        }
        if rows:
            yield Hypothesis(unit.words, unit.words, rows, undo=partial(_in_our_unit, unit))


def _scale(unit: Unit, row: Row) -> float:
    return unit.factor ** order(row) if unit.of == "s" else unit.factor


def _in_our_unit(unit: Unit, row: Row, numbers: Array) -> Array:
    return np.asarray(numbers / _scale(unit, row))


def other_definitions(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each definition, of all angles that disagree."""
    topology = evidence.scene.mechanism.topology
    for row in evidence.wrong:
        angle, wheel = angle_called(row[1]), Wheel.of(topology, row[1])
        if kind_of(row) != "car" or angle is None:
            continue
        start, end = (evidence.places(point) for point in angle.ends(wheel))
        if start is None or end is None:
            continue
        length = np.linalg.norm(end - start, axis=-1)
        axes = evidence.scene.mechanism.axes.on(wheel.side)
        p, q = (axes.component(end - start, direction) for direction in (angle.sine, angle.cosine))
        # The line is a difference of coordinates that are each rounded; a few such roundings.
        size = max(float(np.abs(start).max()), float(np.abs(end).max()))
        for words, rule in DEFINITIONS.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                value = rule(p, q, length)
            if np.isfinite(value).all():
                allowed = evidence.rounded(row, value) + 8.0 * EPS * size / length
                undo = partial(_projected, BACK[words]) if words in BACK else None
                yield Hypothesis(words, words, {row: (value, allowed)}, cost=1.2, undo=undo)


def _projected(back: Callable[[Array], Array], row: Row, numbers: Array) -> Array:
    """The angles that numbers of a row stand for; those of other rows are no such numbers."""
    return back(numbers) if kind_of(row) == "car" else numbers


def _of_others(evidence: Evidence, others: Mapping[Row, Row]) -> dict[Row, WouldBe]:
    """Rows with the numbers of others, where these are there and have as many components."""
    held = evidence.held
    return {
        row: (held[other], evidence.allowed[other])
        for row, other in others.items()
        if other in held and held[other].shape == held[row].shape
    }


def swapped(evidence: Evidence) -> Iterator[Hypothesis]:
    """Two quantities in each other's place, such as velocities and accelerations."""
    for one, two in combinations(sorted(evidence.wrong_quantities), 2):
        partner = {one: two, two: one}
        rows = _of_others(evidence, {r: (partner[r[0]], r[1]) for r in evidence.wrong if r[0] in partner})
        words = f"{QUANTITIES[one].words} is swapped with {QUANTITIES[two].words}"
        yield Hypothesis((one, two), words, rows, cost=1.1)


def sides_exchanged(evidence: Evidence) -> Iterator[Hypothesis]:
    """What two parts of a car have, each under the other's names."""
    for one, two in combinations(evidence.scene.mechanism.topology.sides, 2):
        other = {one: two, two: one}
        parts = {row: row[1].partition(".") for row in evidence.held}
        others = {
            row: (row[0], f"{other[part]}.{name}") if dot and part in other else row
            for row, (part, dot, name) in parts.items()
        }
        words = f"what is of {one} stands under {two}, and the other way"
        yield Hypothesis((one, two), words, _of_others(evidence, others), whole=True)


def of_another_instant(evidence: Evidence) -> Iterator[Hypothesis]:
    """Every number is in the row after or before its own."""
    for words, moved in SAMPLES.items():
        rows = {row: (moved(evidence.held[row]), moved(evidence.allowed[row])) for row in evidence.looked}
        yield Hypothesis(words, words, rows, cost=1.2)
