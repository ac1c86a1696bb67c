r"""Bounds of a function and of its first and second derivatives, anywhere on a patch.

A series f(s) = sum_k c_k s^k on |s_i| <= 1 has  |f| <= sum |c_k|,  |f_i| <= sum k_i |c_k|  and
|f_ij| <= sum k_i k_j |c_k|  (k_i (k_i - 1) where i = j); so have sums and, by Leibniz' rule, products.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Jet:
    """Bounds of functions in p variables, for P patches; none of them negative.

    Attributes:
        value: shape (P, ...).
        first: by each variable, shape (P, p, ...).
        second: by each two, shape (P, p, p, ...).
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
        """Of functions that do not depend on the variables."""
        head, tail = value.shape[:1], value.shape[1:]
        zero = np.zeros((*head, variables, variables, *tail))
        return cls(np.abs(value), zero[:, 0], zero)

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: Jet) -> Jet:
        """Of products, element by element."""
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
        """Times a number, or an array that broadcasts against the functions from the last axis on."""
        return Jet(self.value * factor, self.first * factor, self.second * factor)

    def each(self, operation: Callable[[Array], Array]) -> Jet:
        """The same linear operation, which makes nothing negative, on all bounds, along their last axes."""
        return Jet(operation(self.value), operation(self.first), operation(self.second))

    def where(self, proven: NDArray[np.bool_]) -> Jet:
        """The same on some of the patches, and no bound at all on others, shape (P,)."""

        def only(part: Array) -> Array:
            return np.where(proven.reshape(-1, *[1] * (part.ndim - 1)), part, np.inf)

        return self.each(only)

    def taken(self, places: Indices | list[int]) -> Jet:
        """Some of the functions, by their places along the last axis."""
        return self.each(lambda part: part[..., places])

    @classmethod
    def joined(cls, jets: Sequence[Jet], axis: int) -> Jet:
        """Those of some patches after those of others, along axis 0; or of some functions, along axis -1."""
        parts = zip(*(jet.parts for jet in jets), strict=True)
        return cls(*(np.concatenate(part, axis=axis) for part in parts))

    @property
    def parts(self) -> tuple[Array, Array, Array]:
        """Value, first and second."""
        return self.value, self.first, self.second
