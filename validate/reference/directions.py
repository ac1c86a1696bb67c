"""The directions of a car: up, right, and those that follow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from validate.reference.errors import BadInputError
from validate.reference.vectors import Vector, cross, times


def directions(plain: Mapping[str, Any]) -> dict[str, Vector]:
    """By their words, of exact axes."""
    ways = {"up": plain["up"], "right": plain["right"], "forward": cross(plain["up"], plain["right"])}
    opposite = {"up": "down", "right": "left", "forward": "rearward"}
    return ways | {opposite[word]: times(way, -1) for word, way in ways.items()}


def directed(plain: Mapping[str, Any], word: str) -> Vector:
    """A direction of the car by its word.

    Raises:
        BadInputError: it is none.
    """
    known = directions(plain)
    if word not in known:
        raise BadInputError("a direction", word, f"one of {', '.join(known)}")
    return known[word]
