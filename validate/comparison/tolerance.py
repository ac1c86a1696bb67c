r"""Tolerances of a comparison: what two formulations claim of their own accuracy, number by number.

With e1 and e2 the errors that two formulations claim of a number at most (see `Accuracy`), a difference up to

    T = e1 + e2 + eps^2 M

is explained by the claims, and a larger one shows that one of them is broken. M is the largest number of the
quantity in the scene: a number that is zero is solved for together with others that are not, and keeps a
rounding of a rounding of these. The claims are those of each instant and each component: pointcoord's are
proven from its own equations in twice the working precision, but never more than its method loses where
nothing is wrong (`Proof.expected`); the absolute model's are estimated from what its equations are rounded
from.

A tolerance rests on the formulation that claims the larger part of it. Where that part is more than LOOSEST
times what the other formulation would claim, a fault of the other one that is so many times larger than its
own claim would pass: such a row is "not tested" and no agreement. What a formulation would claim is the
largest of its claims for the quantity at that instant, so that a component that happens to be exact does not
count against its partner, and not less than what rounding may do to any method: eps times its condition
number times the largest number of that quantity.
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


def largest_of(numbers: Iterable[Array]) -> float:
    """The largest finite number of a quantity, 0 if there is none."""
    finite = (np.where(np.isfinite(array), np.abs(array), 0.0) for array in numbers)
    return max((float(np.max(array, initial=0.0)) for array in finite), default=0.0)


def level(claims: Iterable[Array], numbers: Iterable[Array], condition: Array) -> Array:
    """What a formulation would give for any number of a quantity at each instant, (N,).

    Args:
        claims, numbers: of all points, bodies or angles of the quantity, each (N, ...).
        condition: of the matrix that gives the rates, (N,).
    """
    claimed = [_largest(claim) for claim in claims]
    rounded = [EPS * condition * _largest(np.where(np.isfinite(array), array, 0.0)) for array in numbers]
    return np.asarray(np.max([*claimed, *rounded], axis=0))


def untested(first: Array, second: Array, first_level: Array, second_level: Array) -> NDArray[np.bool_]:
    """At which instants a tolerance is too wide to test anything, (N,).

    Args:
        first, second: what both claim of one point, body or angle, (N, ...).
        first_level, second_level: what they would give for any of the quantity, (N,).
    """
    return (_largest(first) > LOOSEST * second_level) | (_largest(second) > LOOSEST * first_level)


def _largest(array: Array) -> Array:
    return np.asarray(np.abs(array).reshape(len(array), -1).max(axis=-1))
