"""The directions of a car: up, right, and those that follow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from validate.reference.errors import BadInputError
from validate.reference.vectors import Vector, cross, times


def direction_of(plain: Mapping[str, Any], word: str) -> Vector | None:
    """A direction of the car by its word, of exact axes; None for any other word."""
    up, right = plain["up"], plain["right"]
    ahead = cross(up, right)
    named = {"up": up, "right": right, "forward": ahead}
    opposite = {"down": up, "left": right, "rearward": ahead}
    return named[word] if word in named else times(opposite[word], -1) if word in opposite else None


def directed(plain: Mapping[str, Any], word: str) -> Vector:
    """A direction of the car by its word.

    Raises:
        BadInputError: it is none.
    """
    found = direction_of(plain, word)
    if found is None:
        raise BadInputError("a direction", word, "up, right, down, left, forward or rearward")
    return found
