"""What is done to every number by a rule: other signs, axes or units, another definition of an angle."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import permutations, product
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pointcoord.effects.corner import Wheel
from pointcoord.effects.registry import angle_called
from pointcoord.numerics.rounding import EPS
from validate.diagnosis.evidence import Evidence, Row, kind_of, length_or_angle, order
from validate.diagnosis.hypothesis import Hypothesis, WouldBe
from validate.tables.units import FORCES

Array = NDArray[np.float64]

FEW = 64  # instants at which axes are tried first


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


def _turned(matrix: Array, axial: bool, row: Row, numbers: Array) -> Array:
    """Vectors of a row in other axes; those of a number of the car are no vectors.

    Args:
        axial: whether what a body turns by keeps its sense only where the axes stay right-handed.
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
    # Rows that agree as well, so that it is known whether they would under the fault.
    looked = (*evidence.wrong, *evidence.beside)
    cars = [row for row in evidence.wrong if kind_of(row) == "car"]
    for signs in product((1.0, -1.0), repeat=3):
        flipped = tuple(axis for axis, sign in zip("xyz", signs, strict=True) if sign < 0.0)
        if flipped and len(cars) < len(evidence.wrong):
            words, matrix = f"the other sign of {' and '.join(flipped)}", np.diag(signs)
            rows, undo = _in_axes(evidence, matrix, looked, axial=False), partial(_turned, matrix, False)
            yield Hypothesis(flipped, words, rows, cost=1.0 + 0.1 * len(flipped), undo=undo)
    if cars:
        yield Hypothesis(
            "car", "the other sign", {row: (-evidence.held[row], evidence.allowed[row]) for row in cars}
        )


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
            _in_axes(evidence, matrix, (*evidence.wrong, *evidence.beside)),
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


def _scale(unit: Unit, row: Row) -> float:
    return unit.factor ** order(row) if unit.of == "s" else unit.factor


def other_units(evidence: Evidence) -> Iterator[Hypothesis]:
    """Each unit, of all rows that may have it."""
    for unit in UNITS:
        rows = {
            row: (_scale(unit, row) * evidence.held[row], _scale(unit, row) * evidence.rounded(row))
            for row in evidence.wrong
            if order(row) in unit.orders and unit.of in ("s", length_or_angle(row))
        }
        if rows:
            # A velocity in m/s is one in mm per millisecond: the length is meant.
            cost = 1.05 if unit.of == "s" else 1.0
            yield Hypothesis(unit.words, unit.words, rows, cost=cost, undo=partial(_in_our_unit, unit))


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
