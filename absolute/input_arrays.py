"""Checks the arrays of inputs and of the chassis' motion that a user gives, and puts them in order."""

from collections.abc import Mapping, Sequence

import numpy as np

from absolute.errors import InputError
from absolute.solution import Array


def orders_of(inputs: Mapping[str, Array]) -> int:
    """How many numbers each input has at an instant: value, rate and acceleration, and more with the jerk."""
    return max([3, *(int(np.shape(law)[1]) for law in inputs.values() if np.ndim(law) == 2)])


def input_series(names: Sequence[str], inputs: Mapping[str, Array], orders: int) -> Array:
    """(N, orders, inputs): value and rates of every input of the model, in its order.

    Raises:
        InputError: an input is missing, unknown, of another length, or not finite.
    """
    unknown, missing = sorted(set(inputs) - set(names)), sorted(set(names) - set(inputs))
    if unknown or missing:
        raise InputError(
            f"inputs must be exactly {sorted(names)}; unknown: {unknown}, missing: {missing}",
            (unknown or missing)[0],
        )
    columns = list[Array]()
    for name in names:
        columns.append(checked(name, inputs[name], (orders,), len(columns[0]) if columns else None))
    return np.stack(columns, axis=-1) if columns else np.zeros((0, orders, 0))


def checked(name: str, values: object, shape: tuple[int, ...], count: int | None = None) -> Array:
    """A copy of `values` as floats of shape (N, *shape), finite throughout; N is `count` if that is given."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name!r} is not an array of numbers: {error}", name, None, values) from error
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        raise InputError(
            f"{name!r} has shape {array.shape}; {('N', *shape)} is needed: value, rate and acceleration at "
            "each instant, and as many more of its rates as another input has",
            name,
            None,
            array.shape,
        )
    bad = np.flatnonzero(~np.isfinite(array).all(axis=tuple(range(1, array.ndim))))
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
