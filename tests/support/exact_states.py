"""What the reference says of a mechanism in plain data, in many digits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from many_digits import DIGITS, Points, vector
from mpmath import mp

from validate.reference import Design, Instant, instants_of


def exact_states(
    plain: Mapping[str, Any], path: Sequence[Mapping[str, Sequence[Any]]], clearness: float = 0.0
) -> list[tuple[Points, ...]]:
    """Places of the points and their rates at some inputs, in the order in which they are reached, mm and s.

    Args:
        path: value, rate and acceleration of each input.
        clearness: how far another assembly must be from the drawing, in parts of the mechanism's size.
    Raises:
        NoReferenceError: with what is in the way.
    """
    return [_in_digits(instant) for instant in instants_of(Design.from_plain(plain), path, DIGITS, clearness)]


def _in_digits(instant: Instant) -> tuple[Points, ...]:
    with mp.workdps(DIGITS):
        return tuple({name: vector(p) for name, p in of.items()} for of in instant.derivatives)
