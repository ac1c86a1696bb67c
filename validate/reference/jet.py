"""A number with its time derivatives: differentiating an equation is evaluating it with jets."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from math import comb
from typing import Any, ClassVar

import numpy as np

from validate.reference.vectors import Scalar, Vector, each


@dataclass(frozen=True, init=False)
class Jet:
    """(x, x', x'', ...), the derivatives by time. Sums, differences and products follow Leibniz.

    (x y)'' = x'' y + 2 x' y' + x y'': the factor 2 that eq. (23) of the paper drops cannot be
    forgotten here, because no equation is differentiated by hand.

    Attributes:
        parts: the number and its derivatives; those that are missing are zero.
    """

    __array_ufunc__: ClassVar[None] = None  # numpy's arrays leave sums and products with a jet to the jet

    parts: tuple[Scalar, ...]

    def __init__(self, *parts: Scalar) -> None:
        object.__setattr__(self, "parts", parts)

    @property
    def value(self) -> Scalar:
        """The number itself."""
        return self.parts[0]

    def part(self, order: int) -> Scalar:
        """A derivative; the number itself is that of order 0."""
        return self.parts[order] if order < len(self.parts) else 0

    def __add__(self, other: Scalar) -> Jet:
        return Jet(*(a + b for a, b in zip_longest(self.parts, _jet(other).parts, fillvalue=0)))

    def __sub__(self, other: Scalar) -> Jet:
        return Jet(*(a - b for a, b in zip_longest(self.parts, _jet(other).parts, fillvalue=0)))

    def __mul__(self, other: Scalar) -> Jet:
        if not isinstance(other, Jet):
            return Jet(*(part * other for part in self.parts))
        one, two = self.parts, other.parts
        return Jet(*(_leibniz(one, two, order) for order in range(max(len(one), len(two)))))

    def __neg__(self) -> Jet:
        return Jet(*(-part for part in self.parts))

    def __rsub__(self, other: Scalar) -> Jet:
        return self.__neg__().__add__(other)

    def sin_cos(self) -> tuple[Jet, Jet]:
        """The sine and the cosine: sin' = cos x', cos' = -sin x', and their derivatives by Leibniz."""
        sine, cosine = ([number] for number in _sin_cos(self.value))
        for order in range(len(self.parts) - 1):
            # Both of the derivatives that are known so far.
            further = _leibniz(cosine, self.parts[1:], order), -_leibniz(sine, self.parts[1:], order)
            sine.append(further[0])
            cosine.append(further[1])
        return Jet(*sine), Jet(*cosine)

    __radd__ = __add__
    __rmul__ = __mul__


def part_of(vector: Vector, order: int) -> Vector:
    """A derivative of a vector of jets, or with 0 the vector itself."""
    return each(lambda jet: jet.part(order), vector)


def _leibniz(one: Any, two: Any, order: int) -> Scalar:
    """A derivative of a product; what a factor lacks is zero."""
    total: Scalar | None = None
    for i in range(min(order, len(one) - 1), max(order - len(two), -1), -1):
        product = one[i] * two[order - i]
        count = comb(order, i)
        term = product if count == 1 else count * product
        total = term if total is None else total + term
    return one[0] * 0 if total is None else total


def _sin_cos(number: Scalar) -> tuple[Scalar, Scalar]:
    return (np.sin(number), np.cos(number)) if isinstance(number, np.ndarray) else number.sin_cos()


def _jet(number: Scalar) -> Jet:
    return number if isinstance(number, Jet) else Jet(number)
