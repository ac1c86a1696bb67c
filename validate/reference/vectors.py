"""Vectors of three scalars, whatever a scalar is."""

from __future__ import annotations

from typing import Any

# A scalar is anything with + - *: a ball (arb), a Fraction, a Jet, a float or a numpy array. One text
# of the equations serves them all.
Scalar = Any
Vector = tuple[Scalar, Scalar, Scalar]


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


def squares(*vectors: Vector) -> Scalar:
    """|a|^2 |b|^2 ...: the scale, squared, of a product of these vectors."""
    product = dot(vectors[0], vectors[0])
    for vector in vectors[1:]:
        product = product * dot(vector, vector)
    return product
