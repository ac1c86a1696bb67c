"""What no point of the suspension says of the car: its directions, sides, lengths, shares and springs."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from validate.reference.errors import BadInputError
from validate.reference.exact import as_fraction
from validate.reference.vectors import Vector, cross, times

AXLE, WHEELBASE, HEIGHT = "axle", "wheelbase", "centre_of_gravity_height"
BRAKE_SHARE, DRIVE_SHARE = "brake_share", "drive_share"
SPRING_RATE, FREE_LENGTH = "spring_rate", "spring_free_length"
RADIUS = "wheel_radius"

DATA = (AXLE, WHEELBASE, HEIGHT, BRAKE_SHARE, DRIVE_SHARE, SPRING_RATE, FREE_LENGTH)
LENGTHS = (WHEELBASE, HEIGHT, FREE_LENGTH, RADIUS)
AXLES = {"front": Fraction(-1), "rear": Fraction(1)}
"""Of each axle where it lies, seen from the car's middle: -1 ahead, 1 behind."""


def car_data(plain: Mapping[str, Any]) -> dict[str, Fraction]:
    """What a description gives of `DATA` under "car": mm, N/mm, shares of 1, of an axle that in `AXLES`.

    And its `RADIUS`, mm, if it gives one.

    Raises:
        BadInputError: a key is unknown, or its value cannot be.
    """
    given, radius = plain.get("car", {}), plain.get(RADIUS)
    if not isinstance(given, Mapping):
        raise BadInputError("car", given, f"a table with any of {', '.join(DATA)}")
    found = {key: _number(key, f"car.{key}", value) for key, value in given.items()}
    return found if radius is None else {**found, RADIUS: _number(RADIUS, RADIUS, radius)}


def corners(plain: Mapping[str, Any]) -> dict[str, int]:
    """The prefix of each part's names, and 1 where outboard is `right` there, -1 where it is the opposite.

    Without parts there is one, whose names have none.
    """
    sides = {(f"{part}.", f"sides[{part!r}]"): side for part, side in plain.get("sides", {}).items()}
    found = {}
    for (prefix, what), side in (sides or {("", "side"): plain["side"]}).items():
        if side not in ("left", "right"):
            raise BadInputError(what, side, "'left' or 'right'")
        found[prefix] = -1 if side == "left" else 1
    return found


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


def _number(key: str, what: str, value: object) -> Fraction:
    if key not in (*DATA, RADIUS):
        raise BadInputError(what, value, f"no such key: only {', '.join(DATA)}")
    if key == AXLE:
        if not (isinstance(value, str) and value in AXLES):
            raise BadInputError(what, value, " or ".join(repr(axle) for axle in AXLES))
        return AXLES[value]
    number = as_fraction(value, what)
    if key in (BRAKE_SHARE, DRIVE_SHARE):
        if not 0 <= number <= 1:
            raise BadInputError(what, value, "a share, 0 to 1")
    elif not number > 0:
        raise BadInputError(what, value, f"a number of {'mm' if key in LENGTHS else 'N/mm'} above 0")
    return number
