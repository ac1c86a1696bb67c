"""Vectors of fractions and of many digits."""

from __future__ import annotations

from fractions import Fraction

import mpmath
from mpmath import mpf

from validate.reference.vectors import Vector, dot

Points = dict[str, Vector]


def size(v: Vector) -> mpf:
    return mpmath.sqrt(dot(v, v))


def number(value: object) -> mpf:
    if isinstance(value, mpf):
        return value
    fraction = Fraction(value)
    return mpf(fraction.numerator) / fraction.denominator


def numbers(vector: Vector) -> Vector:
    return number(vector[0]), number(vector[1]), number(vector[2])
