"""Arithmetic in which an effect's formula is written once: floats, enclosures, and either with derivatives.

With floats a formula gives its value, with enclosures bounds of its exact value. With duals it also gives the
derivative along one direction of motion: (a + a' d)(b + b' d) = a b + (a b' + a' b) d. Value and derivative
of a dual may be duals themselves, with derivatives along another direction.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, cast

import numpy as np

from pointcoord.numerics import enclosure, vectors
from pointcoord.numerics.arrays import Array, Flags
from pointcoord.numerics.enclosure import Enclosed

P = TypeVar("P", Array, Enclosed, "Dual[Any]")


@dataclass(frozen=True, eq=False)
class Dual(Generic[P]):
    """A number or a vector, and its derivative along a direction."""

    value: P
    slope: P

    def __add__(self, other: Dual[P]) -> Dual[P]:
        return Dual(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other: Dual[P]) -> Dual[P]:
        return Dual(self.value - other.value, self.slope - other.slope)

    def __neg__(self) -> Dual[P]:
        return Dual(-self.value, -self.slope)

    def __mul__(self, other: Dual[P]) -> Dual[P]:
        return Dual(self.value * other.value, self.value * other.slope + self.slope * other.value)


S = TypeVar("S", Array, Enclosed, Dual[Any])


def _product(of_floats: Callable[..., Any], of_enclosed: Callable[..., Any]) -> Callable[[S, S], S]:
    """A product of two numbers or vectors, from its float and its enclosed version; (a b)' = a b' + a' b."""

    def product(a: Any, b: Any) -> Any:
        if isinstance(a, Dual):
            return Dual(product(a.value, b.value), product(a.value, b.slope) + product(a.slope, b.value))
        return of_enclosed(a, b) if isinstance(a, Enclosed) else np.asarray(of_floats(a, b))

    return product


dot = _product(np.vecdot, enclosure.dot)
"""Scalar product of vectors."""
cross = _product(vectors.cross, enclosure.cross)
"""Vector product."""
times = _product(lambda factor, vector: factor[..., None] * vector, lambda factor, v: factor.spread_out * v)
"""A number times a vector."""


def linear(function: Callable[..., Any], x: S, *more: Any) -> S:
    """A linear function of numbers without derivatives, applied to any number; more: its arguments."""
    if isinstance(x, Dual):
        return Dual(linear(function, x.value, *more), linear(function, x.slope, *more))
    return cast("S", function(x, *more))


def still(x: S) -> S:
    """Zero in the arithmetic of a number: the derivative of a constant."""
    if isinstance(x, Dual):
        return Dual(still(x.value), still(x.slope))
    return Enclosed.of(np.zeros_like(x.middle)) if isinstance(x, Enclosed) else np.zeros_like(x)


def plain(x: Any) -> Array:
    """The float values of a number that may have derivatives."""
    return plain(x.value) if isinstance(x, Dual) else np.asarray(x)


def multiple(factor: float, x: P) -> P:
    """A constant times a number."""
    if isinstance(x, Dual):
        return Dual(multiple(factor, x.value), multiple(factor, x.slope))
    return Enclosed.of(factor) * x if isinstance(x, Enclosed) else np.asarray(factor * x)


def root(x: S) -> S:
    """Square root of a number that is not negative; (sqrt x)' = x' / (2 sqrt x)."""
    if isinstance(x, Dual):
        half = root(x.value)
        return Dual(half, ratio(x.slope, half + half))
    if isinstance(x, Enclosed):
        return enclosure.root(x)
    return np.asarray(np.sqrt(x))


def ratio(x: S, y: S) -> S:
    """x / y; (x / y)' = (x' - (x / y) y') / y. NaN or infinite where y is 0."""
    if isinstance(x, Dual):
        value = ratio(x.value, y.value)
        return Dual(value, ratio(x.slope - value * y.slope, y.value))
    if isinstance(x, Enclosed):
        return enclosure.quotient(x, y)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(x / y)


def reciprocal(x: P) -> P:
    """1 / x; (1 / x)' = -x' / x^2."""
    if isinstance(x, Dual):
        value = reciprocal(x.value)
        return Dual(value, -(value * value * x.slope))
    return enclosure.quotient(Enclosed.of(1.0), x) if isinstance(x, Enclosed) else np.asarray(1.0 / x)


def positive(x: P) -> Flags:
    """Where a number is above 0."""
    if isinstance(x, Dual):
        return positive(x.value)
    return np.asarray((x.middle if isinstance(x, Enclosed) else x) > 0.0)


def sign_of(x: P) -> P:
    """1 where a number is above 0, -1 elsewhere."""
    if isinstance(x, Dual):
        return Dual(sign_of(x.value), still(x.slope))
    signs = np.where(positive(x), 1.0, -1.0)
    return Enclosed.of(signs) if isinstance(x, Enclosed) else signs


def chosen(where: Flags, one: P, other: P) -> P:
    """`one` where the condition holds, `other` elsewhere."""
    if isinstance(one, Dual):
        return Dual(chosen(where, one.value, other.value), chosen(where, one.slope, other.slope))
    if not isinstance(one, Enclosed):
        return np.asarray(np.where(where, one, other))
    parts = zip(*(part.parts for part in (one.alone, other.alone)), strict=True)
    return Enclosed(*(np.where(where, *both) for both in parts))


def angle(sine: S, cosine: S) -> S:
    """atan2(sine, cosine), rad; its derivative (c s' - s c') / (s^2 + c^2)."""
    if isinstance(sine, Dual):
        s, c = sine.value, cosine.value
        return Dual(angle(s, c), ratio(c * sine.slope - s * cosine.slope, s * s + c * c))
    if isinstance(sine, Enclosed):
        return enclosure.angle(sine, cosine)
    return np.asarray(np.arctan2(sine, cosine))
