"""Numbers with their derivatives: an equation is differentiated by evaluating it with jets."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, nan
from operator import add
from typing import ClassVar

import numpy as np
from flint import arb

from validate.arrays import Flags
from validate.reference.vectors import Scalar, Vector, each, root


@dataclass(frozen=True, init=False)
class Jet:
    """(x, x', x'', ...), by time or by one parameter; the parts may be jets by another parameter.

    Products, quotients and roots follow Leibniz: (x y)'' = x'' y + 2 x' y' + x y''. Eq. (23) of the paper
    drops this factor 2; here no equation is differentiated by hand.

    Attributes:
        parts: the number and its derivatives; missing derivatives are zero.
    """

    __array_ufunc__: ClassVar[None] = None  # numpy leaves sums and products of an array and a jet to the jet

    parts: tuple[Scalar, ...]

    def __init__(self, *parts: Scalar) -> None:
        object.__setattr__(self, "parts", parts)

    @property
    def value(self) -> Scalar:
        """The number itself."""
        return self.parts[0]

    @property
    def slope(self) -> Scalar:
        """Its first derivative."""
        return self.part(1)

    def part(self, order: int) -> Scalar:
        """A derivative; order 0 is the number itself."""
        return self.parts[order] if order < len(self.parts) else 0

    def __add__(self, other: Scalar) -> Jet:
        one, two = self.parts, _parts(other)
        return Jet(*map(add, one, two), *one[len(two) :], *two[len(one) :])

    def __mul__(self, other: Scalar) -> Jet:
        one, two = self.parts, _parts(other)
        return Jet(*(_leibniz(one, two, order) for order in range(max(len(one), len(two)))))

    def __truediv__(self, other: Scalar) -> Jet:
        """q with q y = x: each derivative of q follows from that of x and from lower derivatives of q."""
        divisor = _parts(other)
        found = [self.value / divisor[0]]
        for order in range(1, max(len(self.parts), len(divisor))):
            found.append((self.part(order) - _leibniz(found, divisor, order)) / divisor[0])
        return Jet(*found)

    def __neg__(self) -> Jet:
        return Jet(*(-part for part in self.parts))

    def __sub__(self, other: Scalar) -> Jet:
        return self.__add__(-other)

    def __rsub__(self, other: Scalar) -> Jet:
        return self.__neg__().__add__(other)

    def __rtruediv__(self, other: Scalar) -> Jet:
        return Jet(other) / self

    __radd__ = __add__
    __rmul__ = __mul__

    def sqrt(self) -> Jet:
        """The root r of a positive number: from r r = x, as for a quotient."""
        found = [root(self.value)]
        for order in range(1, len(self.parts)):
            found.append((self.part(order) - _leibniz(found, found, order)) / (2 * found[0]))
        return Jet(*found)

    def sin_cos(self) -> tuple[Jet, Jet]:
        """The sine and the cosine: sin' = cos x', cos' = -sin x', and their derivatives by Leibniz."""
        x = self.value
        sine, cosine = ([y] for y in ((np.sin(x), np.cos(x)) if isinstance(x, np.ndarray) else x.sin_cos()))
        for order in range(len(self.parts) - 1):
            further = _leibniz(cosine, self.parts[1:], order), -_leibniz(sine, self.parts[1:], order)
            sine.append(further[0])
            cosine.append(further[1])
        return Jet(*sine), Jet(*cosine)


def value_of(number: Scalar) -> Scalar:
    """The value of a jet; another number is returned as it is."""
    return number.value if isinstance(number, Jet) else number


def slope_of(number: Scalar) -> Scalar:
    """The first derivative of a jet; zero for another number."""
    return number.slope if isinstance(number, Jet) else 0


def part_of(vector: Vector, order: int) -> Vector:
    """A derivative of a vector of jets; order 0 is the vector itself."""
    return each(lambda jet: jet.part(order), vector)


def only_where(number: Scalar, holds: Flags | bool) -> Scalar:
    """The number where a condition holds, otherwise NaN."""
    return number + (np.where(holds, 0.0, nan) if isinstance(holds, np.ndarray) else 0.0 if holds else nan)


def angle(y: Scalar, x: Scalar) -> Scalar:
    """atan2(y, x), rad, of balls, arrays, or jets with one derivative; NaN if both balls contain 0."""
    if isinstance(y, arb) and isinstance(x, arb):
        return arb("nan") if y.contains(0) and x.contains(0) else arb.atan2(y, x)
    if not (isinstance(y, Jet) or isinstance(x, Jet)):
        return np.arctan2(y, x)
    across, along = value_of(y), value_of(x)
    turning = along * slope_of(y) - across * slope_of(x)
    return Jet(angle(across, along), turning / (along * along + across * across))


def _parts(number: Scalar) -> tuple[Scalar, ...]:
    return number.parts if isinstance(number, Jet) else (number,)


def _leibniz(one: Sequence[Scalar], two: Sequence[Scalar], order: int) -> Scalar:
    """A derivative of a product; missing derivatives of a factor are zero."""
    total: Scalar | None = None
    for i in range(min(order, len(one) - 1), max(order - len(two), -1), -1):
        product = one[i] * two[order - i]
        count = comb(order, i)
        term = product if count == 1 else count * product
        total = term if total is None else total + term
    return one[0] * 0 if total is None else total
