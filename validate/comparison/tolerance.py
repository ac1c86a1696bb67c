r"""Tolerances of a comparison, from the error bounds that two formulations return with each number.

Let e1 and e2 be the error bounds of the two formulations for a number (see `Accuracy`). The tolerance is

    T = e1 + e2 + eps^2 M.

A larger difference shows that an error bound is violated. M is the largest number of the quantity in the
scene: a number that is zero is solved for together with nonzero numbers, and is off by a rounding error of
their rounding errors. There is an error bound for each instant and each component. The bounds of pointcoord
are proven from its own equations in twice the working precision, but are never wider than the error that its
method makes where nothing is wrong (`Proof.expected`). The bounds of models that prove nothing follow from a
stated accuracy of their points (`formulations.stated_accuracy`).

A tolerance is limited by the formulation with the larger error bound. If this bound is more than LOOSEST
times the error level of the other formulation, an error of the other one of LOOSEST times its level would
pass: the row is "not tested", and does not agree. The error level of a formulation is the largest error bound
of the quantity at the instant, so that a component that happens to be exact does not count against its
partner. The level is at least the effect of rounding on any method, eps times condition number times the
largest number of the quantity. The level is also at least the usual error of the method (`Accuracy.usual`),
because a proven bound may be almost zero by chance, as for a pitch that is 0 everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

LOOSEST = 1000.0


def tolerance(first: Array, second: Array, largest: float) -> Array:
    """The tolerance of a difference of two numbers with these error bounds; `largest` is M."""
    return np.asarray(first + second + EPS**2 * largest)


def largest_numbers(numbers: Iterable[Array], count: int) -> Array:
    """The largest magnitude of the finite numbers of a quantity at each instant, (count,); 0 without any."""
    found = np.zeros(count)
    for array in numbers:
        np.maximum(found, _largest(np.where(np.isfinite(array), array, 0.0)), out=found)
    return found


def level(claims: Iterable[Array], numbers: Array, condition: Array, usual: Array | None = None) -> Array:
    """The error level of a formulation for a quantity at each instant, (N,), see the top of this file.

    Args:
        claims: error bounds of all points, bodies or angles of the quantity, each (N, ...).
        numbers: the largest number of the quantity, (N,).
        condition: condition number of the matrix that gives the rates, (N,).
        usual: see `Accuracy.usual`, (N,).
    """
    found = EPS * condition * numbers
    if usual is not None:
        np.maximum(found, usual, out=found)
    for claim in claims:
        np.maximum(found, _largest(claim), out=found)
    return np.asarray(found)


def untested(first: Array, second: Array, first_level: Array, second_level: Array) -> NDArray[np.bool_]:
    """The instants at which a tolerance is too wide to test anything, (..., N).

    Args:
        first, second: largest error bound of any component of a point, body or angle, (..., N).
        first_level, second_level: error levels of both formulations for the quantity, (N,).
    """
    return np.asarray((first > LOOSEST * second_level) | (second > LOOSEST * first_level))


def _largest(array: Array) -> Array:
    """The largest magnitude of any component at each instant, (N,), of numbers (N, ...)."""
    return np.asarray(np.abs(array).max(axis=tuple(range(1, array.ndim))))
