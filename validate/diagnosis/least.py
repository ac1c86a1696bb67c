"""Parameters of another car or motion by least squares of the given numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# What a linear step from where the parameters are ours must leave of the difference, to be worth a search.
LIKELY = 0.5
# What the search may leave of it at most; or of what each number may be off by, which rounder ones, as they
# are meant, may leave less of.
PROMISING, NEARLY = 0.1, 2.0
MOST_STEPS = 12
# The search ends where a step lessens the sum of squares by less than this part: of what is explained whole
# that is at rounding, and of what is not it is soon.
SETTLED = 1e-3
# Of the largest difference, as which a number counts that the parameters do not give.
FAR = 1e3
# How many times what found amounts leave rounder ones may, where all numbers are within what they may be off,
# and elsewhere; of so many decimals at most. Least squares leave less of rounded numbers than what was meant:
# of 5 that one amount is fitted to by a root of 5/4 on average.
KEPT, CLOSE, DECIMALS = 1.5, 1.1, 5
# How near to a number of six digits a parameter is meant to be that number: it is found no better.
MEANT = 1e-8


def fitted(
    read: Callable[[Array], Array],
    start: Sequence[float],
    step: float,
    theirs: Array,
    off: Array | float = 0.0,
    rounded: bool = False,
) -> Array | None:
    """Parameters at which `read` is nearest to given numbers; None where that leaves much of the difference.

    Args:
        read: the numbers (B, M) at sets of parameters (B, P); NaN where there are none.
        start: where the parameters are ours. step: of differences by each.
        off: how far the numbers may be from theirs; if all are within it nothing is left.
        rounded: whether the roundest parameters that leave as little are taken, which are meant: those by
            which all numbers are within what they may be off go before rounder ones.
    """
    begin = np.array(start)
    (first,) = read(begin[None]) - theirs
    if not np.isfinite(first).all():
        return None
    far = FAR * float(np.abs(first).max())
    known: dict[bytes, Array] = {begin.tobytes(): first}

    def gap(parameters: Array) -> Array:
        key = parameters.tobytes()
        if key not in known:
            known[key] = np.nan_to_num(read(parameters[None])[0] - theirs, nan=far)
        return known[key]

    def slopes(parameters: Array) -> Array:
        beside: Array = np.nan_to_num(read(parameters - step * np.eye(len(begin))) - theirs, nan=far)
        return np.asarray((gap(parameters) - beside).T / step)

    def left(parameters: Array) -> float:
        return float(np.linalg.norm(gap(parameters)))

    def kept(near: Array) -> bool:
        return left(near) <= KEPT * least and bool((np.abs(gap(near)) <= off).all())

    apart, jacobian = left(begin), slopes(begin)
    change = np.linalg.lstsq(jacobian, -first, rcond=None)[0]
    if not float(np.linalg.norm(first + jacobian @ change)) <= LIKELY * apart:
        return None
    # Imported here: most comparisons have nothing to explain.
    from scipy.optimize import least_squares

    found = least_squares(
        gap, begin, slopes, x_scale="jac", xtol=1e-15, ftol=SETTLED, gtol=1e-15, max_nfev=MOST_STEPS
    ).x
    least = left(found)
    if least > PROMISING * apart and not (np.abs(gap(found)) <= NEARLY * np.asarray(off)).all():
        return None
    if not rounded:
        return np.asarray(found)
    near = roundest(found, DECIMALS, kept)
    return near if kept(near) else roundest(found, DECIMALS, lambda one: left(one) <= CLOSE * least)


def roundest(found: Array | float, decimals: int, fits: Callable[[Array], bool], unit: float = 1.0) -> Array:
    """The roundest of the numbers next to found ones that fits as they do; they themselves if none does.

    Least squares of printed digits miss what was meant by a little.

    Args:
        decimals: how many are tried, from none on. unit: in which the numbers are round.
    """
    rounder = (unit * np.round(np.asarray(found) / unit, places) for places in range(decimals))
    return np.asarray(next((near for near in rounder if fits(near)), found))


def decimals_of(amounts: Array) -> int:
    """How many decimals amounts have, as far as roundness is looked for."""
    return next((n for n in range(DECIMALS) if (np.round(amounts, n) == amounts).all()), DECIMALS)


def meant(amount: float, scale: float) -> float:
    """What an amount is meant to be: 0, 1 or -1, or a number of six digits, where that is nearly it."""
    near = (0.0, 1.0, -1.0, float(f"{amount:.6g}"))
    sizes = (scale, 1.0, 1.0, abs(amount))
    found = zip(near, sizes, strict=True)
    return next((one for one, size in found if abs(amount - one) <= MEANT * size), amount)
