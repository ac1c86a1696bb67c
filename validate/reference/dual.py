"""A number with its derivative by one parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from flint import arb

from validate.reference.vectors import Scalar, root


@dataclass(frozen=True)
class Dual:
    """(x, dx): sums, products and quotients follow the rules of differentiation."""

    __array_ufunc__: ClassVar[None] = None  # numpy's arrays leave sums and products with a dual to the dual

    value: Scalar
    slope: Scalar = 0

    def __add__(self, other: Scalar) -> Dual:
        return Dual(self.value + value_of(other), self.slope + slope_of(other))

    def __sub__(self, other: Scalar) -> Dual:
        return Dual(self.value - value_of(other), self.slope - slope_of(other))

    def __mul__(self, other: Scalar) -> Dual:
        if not isinstance(other, Dual):
            return Dual(self.value * other, self.slope * other)
        return Dual(self.value * other.value, self.slope * other.value + self.value * other.slope)

    def __truediv__(self, other: Scalar) -> Dual:
        x = value_of(other)
        quotient = self.value / x
        return Dual(quotient, (self.slope - quotient * slope_of(other)) / x)

    def __neg__(self) -> Dual:
        return Dual(-self.value, -self.slope)

    def __rsub__(self, other: Scalar) -> Dual:
        return self.__neg__().__add__(other)

    def __rtruediv__(self, other: Scalar) -> Dual:
        return Dual(other).__truediv__(self)

    def sin_cos(self) -> tuple[Dual, Dual]:
        """The sine and the cosine."""
        sine, cosine = self.value.sin_cos()
        return Dual(sine, cosine * self.slope), Dual(cosine, -sine * self.slope)

    def sqrt(self) -> Dual:
        """The root of a positive number."""
        value = root(self.value)
        return Dual(value, self.slope / (2 * value))

    __radd__ = __add__
    __rmul__ = __mul__


def value_of(number: Scalar) -> Scalar:
    """x of a dual; any other number is itself."""
    return number.value if isinstance(number, Dual) else number


def slope_of(number: Scalar) -> Scalar:
    """dx of a dual; any other number does not depend on the parameter."""
    return number.slope if isinstance(number, Dual) else 0


def angle(y: Scalar, x: Scalar) -> Scalar:
    """atan2(y, x), rad, of balls, of arrays or of duals of these; no number of two balls about 0."""
    if isinstance(y, arb) and isinstance(x, arb):
        return arb("nan") if y.contains(0) and x.contains(0) else arb.atan2(y, x)
    if not (isinstance(y, Dual) or isinstance(x, Dual)):
        return np.arctan2(y, x)
    across, along = value_of(y), value_of(x)
    turning = along * slope_of(y) - across * slope_of(x)
    return Dual(angle(across, along), turning / (along * along + across * across))
