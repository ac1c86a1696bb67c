"""Numbers of the car that no point of the suspension says: its axle, wheelbase, height, shares."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from validate.reference.errors import BadInputError
from validate.reference.exact import as_fraction

AXLE, WHEELBASE, HEIGHT = "axle", "wheelbase", "centre_of_gravity_height"
BRAKE_SHARE, DRIVE_SHARE = "brake_share", "drive_share"
SPRING_RATE, FREE_LENGTH = "spring_rate", "spring_free_length"

DATA = (AXLE, WHEELBASE, HEIGHT, BRAKE_SHARE, DRIVE_SHARE, SPRING_RATE, FREE_LENGTH)
LENGTHS = (WHEELBASE, HEIGHT, FREE_LENGTH)
AXLES = {"front": Fraction(-1), "rear": Fraction(1)}
"""Of each axle where it lies, seen from the car's middle: -1 ahead, 1 behind."""


def car_data(plain: Mapping[str, Any]) -> dict[str, Fraction]:
    """What a description gives of `DATA` under "car": mm, N/mm, shares of 1, of an axle that in `AXLES`.

    Raises:
        BadInputError: a key is unknown, or its value cannot be.
    """
    given = plain.get("car", {})
    if not isinstance(given, Mapping):
        raise BadInputError("car", given, f"a table with any of {', '.join(DATA)}")
    return {key: _number(key, value) for key, value in given.items()}


def _number(key: str, value: object) -> Fraction:
    what = f"car.{key}"
    if key not in DATA:
        raise BadInputError(what, value, f"no such key: only {', '.join(DATA)}")
    if key == AXLE:
        if not (isinstance(value, str) and value in AXLES):
            raise BadInputError(what, value, " or ".join(repr(axle) for axle in AXLES))
        return AXLES[value]
    number = as_fraction(value, what)
    if key in LENGTHS and not number > 0:
        raise BadInputError(what, value, "a number of mm above 0")
    if key == SPRING_RATE and not number > 0:
        raise BadInputError(what, value, "a number of N/mm above 0")
    if key in (BRAKE_SHARE, DRIVE_SHARE) and not 0 <= number <= 1:
        raise BadInputError(what, value, "a share, 0 to 1")
    return number
