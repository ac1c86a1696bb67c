"""A number with its rate and acceleration: differentiating an equation is evaluating it with jets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from validate.reference.vectors import Scalar, Vector, each


@dataclass(frozen=True)
class Jet:
    """(x, x', x''), the derivatives by time. Sums, differences and products follow Leibniz.

    (x y)'' = x'' y + 2 x' y' + x y'': the factor 2 that eq. (23) of the paper drops cannot be
    forgotten here, because no equation is differentiated by hand.
    """

    __array_ufunc__: ClassVar[None] = None  # numpy's arrays leave sums and products with a jet to the jet

    value: Scalar
    rate: Scalar = 0
    acceleration: Scalar = 0

    def __add__(self, other: Scalar) -> Jet:
        other = _jet(other)
        return Jet(self.value + other.value, self.rate + other.rate, self.acceleration + other.acceleration)

    def __sub__(self, other: Scalar) -> Jet:
        other = _jet(other)
        return Jet(self.value - other.value, self.rate - other.rate, self.acceleration - other.acceleration)

    def __mul__(self, other: Scalar) -> Jet:
        if not isinstance(other, Jet):
            return Jet(self.value * other, self.rate * other, self.acceleration * other)
        return Jet(
            self.value * other.value,
            self.rate * other.value + self.value * other.rate,
            self.acceleration * other.value + 2 * self.rate * other.rate + self.value * other.acceleration,
        )

    def __neg__(self) -> Jet:
        return Jet(-self.value, -self.rate, -self.acceleration)

    def __rsub__(self, other: Scalar) -> Jet:
        return self.__neg__().__add__(other)

    def sin_cos(self) -> tuple[Jet, Jet]:
        """The sine and the cosine: sin' = cos x', sin'' = cos x'' - sin x'^2, and so on."""
        sine, cosine = _sin_cos(self.value)
        square = self.rate * self.rate
        return (
            Jet(sine, cosine * self.rate, cosine * self.acceleration - sine * square),
            Jet(cosine, -sine * self.rate, -(sine * self.acceleration) - cosine * square),
        )

    __radd__ = __add__
    __rmul__ = __mul__


def part_of(vector: Vector, name: str) -> Vector:
    """`value`, `rate` or `acceleration` of a vector of jets."""
    return each(lambda jet: getattr(jet, name), vector)


def _sin_cos(number: Scalar) -> tuple[Scalar, Scalar]:
    return (np.sin(number), np.cos(number)) if isinstance(number, np.ndarray) else number.sin_cos()


def _jet(number: Scalar) -> Jet:
    return number if isinstance(number, Jet) else Jet(number)
