"""An amount of another car or motion by least squares of the given numbers, and amounts as round as meant."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What a linear step from where the amount is ours must leave of the difference, to be worth a search.
LIKELY = 0.5
# What the search may leave of it at most; or of what each number may be off by, which a rounder amount, as
# it is meant, may leave less of.
PROMISING, NEARLY = 0.1, 2.0
MOST_STEPS = 12
# Of the difference: a step that lessens it by no more than half is the last one, for near the amount that is
# meant a step lessens it manifold, down to what remains.
MANIFOLD = 0.5
SHARES = (1.0, 0.25)  # of a step, of which the first that lessens the difference is gone
FAR = 1e3  # times the largest difference, as which a number counts that the amount does not give
# How many times what a found amount leaves a rounder one may, where all numbers are within what they may be
# off, and elsewhere; of so many decimals at most. Least squares leave less of rounded numbers than what was
# meant: of 5 that one amount is fitted to by a root of 5/4 on average.
KEPT, CLOSE, DECIMALS = 1.5, 1.1, 5


def fitted(
    read: Callable[[float], Array | None],
    start: float,
    step: float,
    numbers: tuple[Array, Array, Array],
    slope: Array | None = None,
) -> tuple[float, float] | None:
    """The amount at which `read` is nearest to given numbers, as round as these tell, and what is left then.

    By the secant method; None where that leaves much of the difference.

    Args:
        read: the numbers, (M,), by an amount; None where there are none.
        start: where the amount is ours. step: of a difference by it.
        numbers: ours there, those that are given, and how far each may be off, (M,).
        slope: of ours by the amount, (M,), where it is known.
    """
    ours, theirs, off = numbers
    first = ours - theirs
    if not np.isfinite(first).all():
        return None
    known, far = {start: first}, FAR * float(np.abs(first).max())

    def gap_at(amount: float) -> Array:
        if amount not in known:
            found = read(amount)
            known[amount] = np.nan_to_num(
                np.full(len(ours), far) if found is None else found - theirs, nan=far
            )
        return known[amount]

    def left(amount: float) -> float:
        return float(np.linalg.norm(gap_at(amount)))

    if slope is None:
        beside = read(start - step)
        slope = np.zeros_like(ours) if beside is None else (ours - beside) / step
    amount = start
    for count in range(MOST_STEPS):
        gap, square = gap_at(amount), float(slope @ slope)
        change = -float(slope @ gap) / square if square > 0.0 else 0.0
        if count == 0 and not np.linalg.norm(gap + change * slope) <= LIKELY * left(start):
            return None
        gone = next((share * change for share in SHARES if left(amount + share * change) < left(amount)), 0.0)
        if not gone:
            break
        slope = (gap_at(amount + gone) - gap) / gone
        settled = left(amount + gone) > MANIFOLD * left(amount)
        amount += gone
        if settled:
            break
    least = left(amount)
    near = bool((np.abs(gap_at(amount)) <= NEARLY * off).all())
    if least > PROMISING * left(start) and not near:
        return None

    def kept(one: Array) -> bool:
        return left(float(one)) <= KEPT * least and bool((np.abs(gap_at(float(one))) <= off).all())

    def close(one: Array) -> bool:
        return left(float(one)) <= CLOSE * least

    if near:
        meant = roundest(amount, DECIMALS, kept)
        amount = float(meant if kept(meant) else roundest(amount, DECIMALS, close))
    return amount, left(amount)


def roundest(found: Array | float, decimals: int, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The roundest of the numbers next to found ones that fits as they do; they themselves if none does.

    Least squares of printed digits miss what was meant by a little.

    Args:
        decimals: how many are tried, from none on. unit: in which the numbers are round.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(decimals))
    return np.asarray(next((near for near in rounder if fits(near)), found))


def decimals_of(amount: float) -> int:
    """How many decimals an amount has, as far as roundness is looked for."""
    return next((n for n in range(DECIMALS) if round(amount, n) == amount), DECIMALS)
