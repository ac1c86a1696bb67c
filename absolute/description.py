"""Checks of a mechanism's description: numbers, names, points, directions."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from absolute.errors import DescriptionError
from absolute.model import CAR
from absolute.vectors import EPS, Array

# Products of three vectors between points below this limit, mm^3, are normal numbers.
LARGEST_COORDINATE = 1e100
# Error of a product of directions that were rotated in doubles.
ROUNDED = 16.0 * EPS
# Largest error of the right angle between `up` and `right`, rad: more than rounding.
LARGEST_SKEW = 1e-6
# Direction from the middle of the car to the axle, rearward.
CAR_AXLES = {"front": -1.0, "rear": 1.0}


def directions_of(mechanism: Mapping[str, Any]) -> dict[str, Array]:
    """Unit vectors along the directions of the car, by name."""
    up, right = (unit_of(name, vector_of(name, name, mechanism[name])) for name in ("up", "right"))
    skew = float(up @ right)
    if abs(skew) > LARGEST_SKEW:
        raise DescriptionError(
            f"up and right are {np.degrees(np.arccos(skew)):.6g} degrees apart; a right angle is needed",
            "right",
            skew,
        )
    directions = {"up": up, "right": right, "forward": np.cross(up, right)}
    return directions | {"down": -up, "left": -right, "rearward": np.cross(right, up)}


def car_of(given: Any) -> dict[str, float]:
    """The numbers of a car; DescriptionError if a name is unknown, or a value has a wrong type or range."""
    if not isinstance(given, Mapping | None):
        raise DescriptionError(f"car is {given!r}; a table of {list(CAR)} is needed", "car", given)
    car = {}
    for name, value in (given or {}).items():
        one_of("a name in car", CAR, name)
        if name == "axle":
            one_of("axle", CAR_AXLES, value)
        elif not (is_number(value) and (0.0 <= value <= 1.0 if name.endswith("share") else value > 0.0)):
            allowed = "from 0 to 1" if name.endswith("share") else "above 0, in mm or N/mm,"
            raise DescriptionError(f"{name} is {value!r}; a number {allowed} is needed", name, value)
        car[name] = CAR_AXLES[value] if name == "axle" else float(value)
    return car


def is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def one_of(what: str, allowed: Iterable[str], *values: object) -> None:
    """Raise a DescriptionError that names `what` and the allowed values unless all values are among them."""
    names = list(allowed)
    for value in values:
        if value not in names:
            raise DescriptionError(f"{what} is {value!r}; it must be one of {names}", str(value), value)


def vector_of(what: str, name: str, value: object) -> Array:
    """Three finite floats; otherwise a DescriptionError that names `what` and the value."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != (3,) or not np.isfinite(array).all():
        raise DescriptionError(f"{what} is {value!r}; three finite numbers are needed", name, value)
    return array


def point_of(name: str, value: object) -> Array:
    """Coordinates of a point, mm; otherwise a DescriptionError that names the point and the value."""
    point = vector_of(f"point {name!r}", name, value)
    if np.abs(point).max() > LARGEST_COORDINATE:
        raise DescriptionError(
            f"point {name!r} is {point.tolist()}; products of such coordinates overflow: correct it or use a "
            f"larger unit of length, so that all are below {LARGEST_COORDINATE:g} mm",
            name,
            point.tolist(),
        )
    return point


def unit_of(name: str, vector: Array) -> Array:
    """The direction of a vector; a vector of length 1 to rounding is returned as it is.

    Raises:
        DescriptionError: it is zero.
    """
    largest = float(np.abs(vector).max())
    if largest < 2.0 and abs(float(vector @ vector) - 1.0) <= ROUNDED:
        return vector
    if largest == 0:
        raise DescriptionError(
            f"{name} is {vector.tolist()}; a direction must not be zero", name, vector.tolist()
        )
    # Scaled first, because squares of the smallest and largest numbers under- or overflow.
    scaled = vector / largest
    return np.asarray(scaled / np.linalg.norm(scaled))
