"""Vectors of three scalars, whatever a scalar is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import frexp, sqrt
from typing import Any

import numpy as np
from flint import arb

# A scalar is anything with + - *: a ball (arb), a Fraction, a Jet, a float or a numpy array. So the equations
# are written once for all of them.
Scalar = Any
Vector = tuple[Scalar, Scalar, Scalar]
Exact = Callable[[Any], Scalar]
"""Converts a fraction, Python's or flint's, to one kind of scalar."""
X, Y, Z = AXES = ((1, 0, 0), (0, 1, 0), (0, 0, 1))


def each(change: Callable[[Scalar], Scalar], a: Vector) -> Vector:
    """A function of each component."""
    return change(a[0]), change(a[1]), change(a[2])


def plus(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def times(a: Vector, factor: Scalar) -> Vector:
    """a times a scalar."""
    return a[0] * factor, a[1] * factor, a[2] * factor


def dot(a: Vector, b: Vector) -> Scalar:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def root(number: Scalar) -> Scalar:
    """The square root of a scalar; of a ball, the root of its nonnegative part."""
    if isinstance(number, float | Fraction | int):
        return sqrt(number)
    if isinstance(number, np.ndarray):
        return np.sqrt(number)
    return number.nonnegative_part().sqrt() if isinstance(number, arb) else number.sqrt()


def length(a: Vector) -> Scalar:
    """|a|."""
    return root(dot(a, a))


def across(axis: Vector) -> tuple[Vector, Vector]:
    """Two vectors of fractions, perpendicular to a line and to each other."""
    # Rounded, so that a slightly different drawing gives slightly different vectors.
    least = min(range(3), key=lambda i: round(abs(float(axis[i])), 12))
    u = cross(axis, (Fraction(least == 0), Fraction(least == 1), Fraction(least == 2)))
    return near_one(u), near_one(cross(axis, u))


def near_one(vector: Vector) -> Vector:
    """A vector of fractions times the power of two that makes its length near one, if it is not zero."""
    return times(vector, Fraction(2) ** -frexp(max(abs(float(x)) for x in vector))[1])


@dataclass(frozen=True)
class Placement:
    """Where a body is: the columns of its rotation matrix R, and the position of the drawing's origin."""

    columns: tuple[Vector, Vector, Vector]
    origin: Vector

    @classmethod
    def of(cls, columns: tuple[Vector, Vector, Vector], drawn: Vector, place: Vector) -> Placement:
        """The one that moves the point `drawn` of the drawing to `place`."""
        return cls(columns, minus(place, cls(columns, place).turned(drawn)))

    def turned(self, v: Vector) -> Vector:
        """A vector fixed in the body, rotated with it: R v."""
        x, y, z = (times(column, part) for column, part in zip(self.columns, v, strict=True))
        return plus(plus(x, y), z)

    def turned_back(self, v: Vector) -> Vector:
        """The vector that is rotated to v: R^T v."""
        return dot(self.columns[0], v), dot(self.columns[1], v), dot(self.columns[2], v)

    def place(self, drawn: Vector) -> Vector:
        """Position of a point of the body, from its drawn position."""
        return plus(self.origin, self.turned(drawn))
