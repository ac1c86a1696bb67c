"""Parameters of another car or motion by least squares of the given numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

Array = NDArray[np.float64]

# What a linear step from where the parameters are ours must leave of the difference, to be worth a search.
LIKELY = 0.5
# What the search may leave of it at most.
PROMISING = 0.1
MOST_STEPS = 12
# Of the largest difference, as which a number counts that the parameters do not give.
FAR = 1e3
# How near to a number of six digits a parameter is meant to be that number: it is found no better.
MEANT = 1e-8


def fitted(
    read: Callable[[Array], Array | None], start: Sequence[float], step: float, theirs: Array
) -> Array | None:
    """Parameters at which `read` is nearest to given numbers; None where that leaves much of the difference.

    Args:
        read: the numbers (M,) at parameters (P,); None where there are none.
        start: where the parameters are ours. step: of differences by each.
    """
    known: dict[bytes, Array | None] = {}

    def gap(parameters: Array) -> Array | None:
        key = parameters.tobytes()
        if key not in known:
            numbers = read(parameters)
            known[key] = None if numbers is None else numbers - theirs
        return known[key]

    begin = np.array(start)
    first = gap(begin)
    if first is None or not np.isfinite(first).all():
        return None
    far = np.full(len(theirs), FAR * float(np.abs(first).max()))

    def or_far(parameters: Array) -> Array:
        found = gap(parameters)
        return far if found is None else np.nan_to_num(found, nan=far[0])

    def slopes(parameters: Array) -> Array:
        here = or_far(parameters)
        moved = (or_far(parameters - step * one) for one in np.eye(len(begin)))
        return np.stack([(here - there) / step for there in moved], axis=1)

    apart, jacobian = float(np.linalg.norm(first)), slopes(begin)
    change = np.linalg.lstsq(jacobian, -first, rcond=None)[0]
    if not float(np.linalg.norm(first + jacobian @ change)) <= LIKELY * apart:
        return None
    found = least_squares(
        or_far, begin, slopes, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=MOST_STEPS
    )
    return np.asarray(found.x) if float(np.linalg.norm(found.fun)) <= PROMISING * apart else None


def meant(amount: float) -> float:
    """A number of six digits where that is nearly it."""
    rounded = float(f"{amount:.6g}")
    return rounded if abs(rounded - amount) <= MEANT * abs(amount) else amount
