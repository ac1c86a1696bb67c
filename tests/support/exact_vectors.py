"""Vectors of fractions and of many digits."""

from __future__ import annotations

from fractions import Fraction

import mpmath
from mpmath import mpf

from validate.reference.vectors import Vector, cross, dot, plus, times

Points = dict[str, Vector]


def rational_turn(quaternion: tuple[int, int, int, int]) -> tuple[Vector, Vector, Vector]:
    """The columns of a turn, exact, from a quaternion of whole numbers."""
    w, *v = (Fraction(n) for n in quaternion)
    axis, size = (v[0], v[1], v[2]), sum(Fraction(n) ** 2 for n in quaternion)
    units = ((1, 0, 0), (0, 1, 0), (0, 0, 1))

    def column(e: Vector) -> Vector:
        across = cross(axis, e)
        return times(
            plus(
                times(e, w * w - dot(axis, axis)), plus(times(axis, 2 * dot(axis, e)), times(across, 2 * w))
            ),
            1 / size,
        )

    return column(units[0]), column(units[1]), column(units[2])


def turned(columns: tuple[Vector, Vector, Vector], p: Vector) -> Vector:
    return plus(plus(times(columns[0], p[0]), times(columns[1], p[1])), times(columns[2], p[2]))


def unit(v: Vector) -> Vector:
    return times(v, 1 / size(v))


def size(v: Vector) -> mpf:
    return mpmath.sqrt(dot(v, v))


def number(value: object) -> mpf:
    if isinstance(value, mpf):
        return value
    fraction = Fraction(value)
    return mpf(fraction.numerator) / fraction.denominator


def numbers(vector: Vector) -> Vector:
    return number(vector[0]), number(vector[1]), number(vector[2])
