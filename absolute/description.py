"""Reads a mechanism's description: points, directions, the data of its wheels; checks numbers and names."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from absolute.errors import DescriptionError
from absolute.model import CAR, ROLES, Corner
from absolute.vectors import EPS, Array

# Products of three vectors between points below this limit, mm^3, are normal numbers.
LARGEST_COORDINATE = 1e100
# Error of a product of directions that were rotated in doubles.
ROUNDED = 16.0 * EPS
# Largest error of the right angle between `up` and `right`, rad: more than rounding.
LARGEST_SKEW = 1e-6
SIDES = ("left", "right")
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


def corners_of(
    mechanism: Mapping[str, Any],
    points: Mapping[str, Array],
    bodies: Mapping[str, tuple[str, ...]],
    directions: Mapping[str, Array],
) -> dict[str, Corner]:
    """Part -> its wheel, whose names begin with the part; "" -> the only wheel."""
    numbers, roles, side = _numbers_of(mechanism), mechanism.get("roles", {}), mechanism.get("side")
    corners = {}
    for part, own_side in (mechanism.get("sides") or {"": "left" if side is None else side}).items():
        one_of(f"side of {part!r}" if part else "side", SIDES, own_side)
        prefix = f"{part}." if part else ""
        given: dict[str, Any] = dict(numbers)
        for role in ROLES:
            if ends := roles.get(prefix + role):
                one_of(f"an end of the {prefix}{role}", points, *ends)
                given[role] = tuple(ends)
        if knuckle := roles.get(f"{prefix}knuckle"):
            one_of(f"the {prefix}knuckle", bodies, knuckle)
        elif "wheel_axis" in given:
            knuckle = next((body for body, own in bodies.items() if given["wheel_axis"][1] in own), "")
        if knuckle:
            given["knuckle"] = knuckle
        axes = np.array([directions[name] for name in (own_side, "rearward", "up")])
        corners[part] = Corner(own_side, axes, given)
    return corners


def _numbers_of(mechanism: Mapping[str, Any]) -> dict[str, float]:
    """The wheel's radius and the numbers of the car, as far as they are given."""
    car, radius = mechanism.get("car"), mechanism.get("wheel_radius")
    if not isinstance(car, Mapping | None):
        raise DescriptionError(f"car is {car!r}; a table of {list(CAR)} is needed", "car", car)
    one_of("a name in car", CAR, *(car or {}))
    numbers = {}
    for name, value in {**(car or {}), **({} if radius is None else {"wheel_radius": radius})}.items():
        if name == "axle":
            one_of("axle", CAR_AXLES, value)
        elif not (is_number(value) and (0.0 <= value <= 1.0 if name.endswith("share") else value > 0.0)):
            allowed = "from 0 to 1" if name.endswith("share") else "above 0, in mm or N/mm,"
            raise DescriptionError(f"{name} is {value!r}; a number {allowed} is needed", name, value)
        numbers[name] = CAR_AXLES[value] if name == "axle" else float(value)
    return numbers


def loads_of(given: Mapping[str, Mapping[str, Any]], corners: Mapping[str, Corner]) -> dict[str, Array]:
    """Part -> (2, 3) force and moment on its wheel."""
    one_of("the part of a load", corners, *given)
    return {
        part: np.array(
            [
                vector_of(f"force of load {part!r}", part, load.get("force")),
                vector_of(f"moment of load {part!r}", part, load.get("moment", np.zeros(3))),
            ]
        )
        for part, load in given.items()
    }


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
