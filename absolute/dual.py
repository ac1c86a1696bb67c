"""Dual numbers, values with derivatives: a formula is differentiated while it is evaluated."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from absolute.vectors import Array


@dataclass(frozen=True)
class Dual:
    """A number or a vector (components first) at N instants, and its derivatives by K inputs.

    Attributes:
        value: (..., N). slopes: (..., N, K). N or K may be 1 if all values are equal.
    """

    value: Array
    slopes: Array

    def __getitem__(self, component: int) -> "Dual":
        return Dual(self.value[component], self.slopes[component])

    def __iter__(self) -> Iterator["Dual"]:
        return map(Dual, self.value, self.slopes)

    def __neg__(self) -> "Dual":
        return _chain(-self.value, (-1.0, self))

    def __add__(self, other: "Dual") -> "Dual":
        return _chain(self.value + other.value, (1.0, self), (1.0, other))

    def __sub__(self, other: "Dual") -> "Dual":
        return _chain(self.value - other.value, (1.0, self), (-1.0, other))

    def __mul__(self, other: "Dual") -> "Dual":
        return _chain(self.value * other.value, (other.value, self), (self.value, other))

    def __truediv__(self, other: "Dual") -> "Dual":
        ratio = self.value / other.value
        return _chain(ratio, (1.0 / other.value, self), (-ratio / other.value, other))

    def along(self, directions: Array) -> "Dual":
        """Components of a vector (3, N) along directions (3, 3), one direction per row."""
        return Dual(directions @ self.value, np.tensordot(directions, self.slopes, 1))


def constant(value: Array | float) -> Dual:
    """A constant of shape (...) or (..., N), with zero derivatives."""
    value = np.asarray(value, dtype=float)
    return Dual(value, np.zeros((*value.shape, 1)))


def hypot(*parts: Dual) -> Dual:
    """The square root of the sum of squares; it has no derivative where it is zero."""
    length = np.sqrt(np.sum([part.value * part.value for part in parts], axis=0))
    return _chain(length, *((part.value / length, part) for part in parts))


def arctan2(rise: Dual, run: Dual) -> Dual:
    """The angle whose tangent is rise / run, between -pi and pi."""
    square = rise.value * rise.value + run.value * run.value
    # A rise of zero may be -0, which would turn pi into -pi.
    angle = np.arctan2(rise.value + 0.0, run.value)
    return _chain(angle, (run.value / square, rise), (-rise.value / square, run))


def _chain(value: Array, *parts: tuple[Array | float, Dual]) -> Dual:
    """A function value with its derivatives, from the partial derivatives by each argument."""
    first, *others = (np.asarray(partial)[..., None] * of.slopes for partial, of in parts)
    return Dual(value, np.asarray(sum(others, first)))
