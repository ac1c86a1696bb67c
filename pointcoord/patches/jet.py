r"""Bounds of the magnitudes of a function and of its first and second derivatives, everywhere on a patch.

For a series f(s) = sum_k c_k s^k on |s_i| <= 1:  |f| <= sum |c_k|,  |f_i| <= sum k_i |c_k|  and
|f_ij| <= sum k_i k_j |c_k|  (k_i (k_i - 1) for i = j). Bounds of sums and products follow by addition and by
the product rule.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Indices


@dataclass(frozen=True)
class Jet:
    """Bounds of functions of p variables, for P patches; no bound is negative.

    Attributes:
        value: bounds of the functions, shape (P, ...).
        first: bounds of the first derivatives, shape (P, p, ...).
        second: bounds of the second derivatives, shape (P, p, p, ...).
    """

    value: Array
    first: Array
    second: Array

    @classmethod
    def of(cls, coefficients: Array, exponents: Indices) -> Jet:
        """Bounds of series.

        Args:
            coefficients: shape (P, powers, ...). exponents: shape (powers, p).
        """
        sizes = np.abs(coefficients)
        k = exponents.astype(float)
        twice = k[:, :, None] * k[:, None, :] - np.eye(k.shape[1]) * k[:, :, None]
        flat = sizes.reshape(*sizes.shape[:2], int(np.prod(sizes.shape[2:])))
        weights = np.concatenate([np.ones((len(k), 1)), k, twice.reshape(len(k), -1)], axis=1)
        found = (weights.T @ flat).reshape(len(sizes), weights.shape[1], *sizes.shape[2:])
        p = k.shape[1]
        rest = found[:, p + 1 :].reshape(len(sizes), p, p, *sizes.shape[2:])
        return cls(found[:, 0], found[:, 1 : p + 1], rest)

    @classmethod
    def constant(cls, value: Array, variables: int) -> Jet:
        """Bounds of constants of given values, shape (P, ...)."""
        head, tail = value.shape[:1], value.shape[1:]
        zero = np.zeros((*head, variables, variables, *tail))
        return cls(np.abs(value), zero[:, 0], zero)

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: Jet) -> Jet:
        """Bounds of products, element by element."""
        a, b = self, other
        crossed = a.first[:, :, None] * b.first[:, None]
        return Jet(
            a.value * b.value,
            a.first * b.value[:, None] + a.value[:, None] * b.first,
            a.second * b.value[:, None, None]
            + crossed
            + np.swapaxes(crossed, 1, 2)
            + a.value[:, None, None] * b.second,
        )

    def scaled(self, factor: float | Array) -> Jet:
        """The bounds times a number, or times an array that broadcasts against the last axes."""
        return Jet(self.value * factor, self.first * factor, self.second * factor)

    def each(self, operation: Callable[[Array], Array]) -> Jet:
        """A linear operation without negative factors, applied to all bounds along their last axes."""
        return Jet(operation(self.value), operation(self.first), operation(self.second))

    def where(self, proven: Flags) -> Jet:
        """The bounds on the patches marked by `proven`, (P,); infinite on the others."""

        def only(part: Array) -> Array:
            return np.where(proven.reshape(-1, *[1] * (part.ndim - 1)), part, np.inf)

        return self.each(only)

    def taken(self, places: Indices | list[int]) -> Jet:
        """The bounds of some functions, by their places along the last axis."""
        return self.each(lambda part: part[..., places])

    @classmethod
    def joined(cls, jets: Sequence[Jet], axis: int) -> Jet:
        """Bounds joined along axis 0, of several sets of patches, or along axis -1, of several functions."""
        parts = zip(*(jet.parts for jet in jets), strict=True)
        return cls(*(np.concatenate(part, axis=axis) for part in parts))

    @property
    def parts(self) -> tuple[Array, Array, Array]:
        """The arrays `value`, `first` and `second`."""
        return self.value, self.first, self.second
