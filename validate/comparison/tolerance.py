r"""Tolerances of a comparison: what two formulations claim of their own accuracy, number by number.

With e1 and e2 the errors that two formulations claim of a number at most (see `Accuracy`), a difference up to

    T = e1 + e2 + eps^2 M

is explained by the claims, and a larger one shows that one of them is broken. M is the largest number of the
quantity in the scene: a number that is zero is solved for together with others that are not, and keeps a
rounding of a rounding of these. The claims are those of each instant and each component: pointcoord's are
proven from its own equations in twice the working precision, but never more than its method loses where
nothing is wrong (`Proof.expected`); those of models that prove nothing are what a stated
accuracy of their points makes of each number (`formulations.stated_accuracy`).

A tolerance rests on the formulation that claims the larger part of it. Where that part is more than LOOSEST
times what the other formulation would claim, a fault of the other one that is so many times larger than its
own claim would pass: such a row is "not tested" and no agreement. What a formulation would claim is the
largest of its claims for the quantity at that instant, so that a component that happens to be exact does not
count against its partner, and not less than what rounding may do to any method: eps times its condition
number times the largest number of that quantity. Nor is it less than what its own method usually loses of it
(`Accuracy.usual`): a proof may by chance find next to nothing, as of a pitch that is 0 everywhere.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

LOOSEST = 1000.0


def tolerance(first: Array, second: Array, largest: float) -> Array:
    """What a difference is held to."""
    return np.asarray(first + second + EPS**2 * largest)


def largest_numbers(numbers: Iterable[Array], count: int) -> Array:
    """The largest finite number of a quantity at each instant, (count,), 0 where there is none."""
    found = np.zeros(count)
    for array in numbers:
        np.maximum(found, _largest(np.where(np.isfinite(array), array, 0.0)), out=found)
    return found


def level(claims: Iterable[Array], numbers: Array, condition: Array, usual: Array | None = None) -> Array:
    """What a formulation would give for any number of a quantity at each instant, (N,).

    Args:
        claims: of all points, bodies or angles of the quantity, each (N, ...).
        numbers: the largest of them, (N,). condition: of the matrix that gives the rates, (N,).
        usual: see `Accuracy.usual`, (N,).
    """
    found = EPS * condition * numbers
    if usual is not None:
        np.maximum(found, usual, out=found)
    for claim in claims:
        np.maximum(found, _largest(claim), out=found)
    return np.asarray(found)


def untested(first: Array, second: Array, first_level: Array, second_level: Array) -> NDArray[np.bool_]:
    """At which instants a tolerance is too wide to test anything, (..., N).

    Args:
        first, second: the most that both claim of any component of a point, body or angle, (..., N).
        first_level, second_level: what they would give for any of the quantity, (N,).
    """
    return np.asarray((first > LOOSEST * second_level) | (second > LOOSEST * first_level))


def _largest(array: Array) -> Array:
    """The largest magnitude of any component at each instant, (N,), of numbers (N, ...)."""
    return np.asarray(np.abs(array).max(axis=tuple(range(1, array.ndim))))
