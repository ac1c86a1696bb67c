"""Inputs and chassis motion over the instants, checked."""

from collections.abc import Mapping, Sequence

import numpy as np

from absolute.errors import InputError
from absolute.solution import Array

# Angle (beyond, no digit of it is left), rate and acceleration of a turn of the chassis: times lengths up to
# LARGEST_COORDINATE they are far from the end of the floating-point range.
FASTEST = np.array([1e16, 1e100, 1e200])


def input_series(names: Sequence[str], inputs: Mapping[str, Array]) -> Array:
    """(N, 3, inputs): value, rate and acceleration of every input of the model, in its order.

    Raises:
        InputError: an input is missing, unknown, of another length, or not finite.
    """
    unknown = sorted(set(inputs) - set(names))
    missing = sorted(set(names) - set(inputs))
    if unknown or missing:
        raise InputError(
            f"inputs must be exactly {sorted(names)}; unknown: {unknown}, missing: {missing}",
            (unknown or missing)[0],
        )
    content, columns = "value, rate and acceleration at each instant", list[Array]()
    for name in names:
        columns.append(checked(name, inputs[name], (3,), content, len(columns[0]) if columns else None))
    return np.stack(columns, axis=-1) if columns else np.zeros((0, 3, 0))


def turn_series(names: Sequence[str], inputs: Mapping[str, Array], count: int) -> dict[str, Array]:
    """name -> (N, 3): angle, rate and acceleration of those turns of the chassis that are told.

    Raises:
        InputError: one is of another length, not finite, or faster than products with lengths may be.
    """
    told: dict[str, Array] = {}
    for name in names:
        if name not in inputs:
            continue
        content = "angle, rate and acceleration at each instant"
        told[name] = column = checked(name, inputs[name], (3,), content, count)
        fast = np.flatnonzero((np.abs(column) > FASTEST).any(axis=1))
        if fast.size:
            instant = int(fast[0])
            found = column[instant].tolist()
            raise InputError(
                f"turn {name!r} is {found} at instant {instant}; products with it overflow: it may be up to "
                f"{FASTEST.tolist()}",
                name,
                instant,
                found,
            )
    return told


def chassis_series(chassis: Array | None, count: int) -> Array:
    """(N, 3, 3): translation, velocity, acceleration of the chassis; zeros for None.

    Raises:
        InputError: another shape or length, or not finite.
    """
    if chassis is None:
        return np.zeros((count, 3, 3))
    content = "translation, velocity and acceleration at each instant"
    return checked("chassis", chassis, (3, 3), content, count)


def checked(
    name: str, values: object, shape: tuple[int, ...], content: str, count: int | None = None
) -> Array:
    """A copy of `values` as floats of shape (N, *shape), finite throughout; N is `count` if that is given."""
    try:
        array = np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name!r} is not an array of numbers: {error}", name, None, values) from error
    wanted = "(N, " + ", ".join(str(length) for length in shape) + ")"
    if array.shape[1:] != shape or array.ndim != 1 + len(shape):
        raise InputError(
            f"{name!r} has shape {array.shape}; {wanted} is needed: {content}", name, None, array.shape
        )
    bad = np.flatnonzero(~np.isfinite(array).all(axis=tuple(range(1, array.ndim))))
    if bad.size:
        instant = int(bad[0])
        raise InputError(
            f"{name!r} is {array[instant].tolist()} at instant {instant}; all its numbers must be finite",
            name,
            instant,
            array[instant].tolist(),
        )
    if count is not None and len(array) != count:
        raise InputError(
            f"{name!r} has {len(array)} instants, the others have {count}; give all as many",
            name,
            None,
            len(array),
        )
    return array
