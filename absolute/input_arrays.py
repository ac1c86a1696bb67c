"""Checks the arrays of inputs that a user gives."""

from collections.abc import Collection, Mapping

import numpy as np

from absolute.errors import InputError
from absolute.vectors import Array


def input_series(names: Collection[str], inputs: Mapping[str, object]) -> dict[str, Array]:
    """name -> (N, orders): value, rate, acceleration, and more with the jerk, of every input.

    Raises:
        InputError: an input is missing, unknown, of another length, or not finite.
    """
    unknown, missing = sorted({*inputs} - {*names}), sorted({*names} - {*inputs})
    if unknown or missing:
        raise InputError(
            f"inputs must be exactly {sorted(names)}; unknown: {unknown}, missing: {missing}",
            (unknown or missing)[0],
        )
    orders = max([3, *(np.shape(law)[1] for law in map(_array, inputs.items()) if np.ndim(law) == 2)])
    series = dict[str, Array]()
    for name, values in inputs.items():
        count = len(next(iter(series.values()))) if series else None
        series[name] = _checked(name, _array((name, values)), orders, count)
    return series


def _array(given: tuple[str, object]) -> Array:
    name, values = given
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name!r} is not an array of numbers: {error}", name, None, values) from error


def _checked(name: str, array: Array, orders: int, count: int | None) -> Array:
    """An array of shape (N, orders), finite throughout; N is `count` if that is given."""
    if array.shape[1:] != (orders,):
        raise InputError(
            f"{name!r} has shape {array.shape}; {('N', orders)} is needed: value, rate and acceleration at "
            "each instant, and as many more of its rates as another input has",
            name,
            None,
            array.shape,
        )
    bad = np.flatnonzero(~np.isfinite(array).all(axis=1))
    if bad.size:
        instant, found = int(bad[0]), array[bad[0]].tolist()
        raise InputError(
            f"{name!r} is {found} at instant {instant}; all its numbers must be finite", name, instant, found
        )
    if count is not None and len(array) != count:
        raise InputError(
            f"{name!r} has {len(array)} instants, the others have {count}; give all as many",
            name,
            None,
            len(array),
        )
    return array
