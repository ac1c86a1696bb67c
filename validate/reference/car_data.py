"""Data of the car other than its points: directions, sides, numbers; and the names of all these."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from validate.reference.exact import as_fraction
from validate.reference.vectors import Vector, cross, times

AXLE, WHEELBASE, HEIGHT = "axle", "wheelbase", "centre_of_gravity_height"
BRAKE_SHARE, DRIVE_SHARE = "brake_share", "drive_share"
SPRING_RATE, FREE_LENGTH = "spring_rate", "spring_free_length"
RADIUS = "wheel_radius"
WHEEL, STEERING, DAMPER = LINES = ("wheel_axis", "steering_axis", "damper")
KNUCKLE, PAIR = "knuckle", "pair"
TRAVEL, RACK, ROLL, TIME = "by_travel", "by_rack", "by_roll", "by_time"

LENGTHS = (WHEELBASE, HEIGHT, FREE_LENGTH, RADIUS)
AXLES = {"front": Fraction(-1), "rear": Fraction(1)}
"""Position of each axle relative to the car's middle: -1 in front, 1 behind."""


def car_data(plain: Mapping[str, Any]) -> dict[str, Fraction]:
    """The numbers under "car" in a description, and its wheel radius: mm, N/mm, shares; an axle as in
    `AXLES`.
    """
    radius = {} if plain.get(RADIUS) is None else {RADIUS: plain[RADIUS]}
    given = {**plain.get("car", {}), **radius}
    return {key: AXLES[value] if key == AXLE else as_fraction(value, key) for key, value in given.items()}


def corners(plain: Mapping[str, Any]) -> dict[str, int]:
    """The side of each part by the prefix of its names: 1 on the right, -1 on the left.

    A car without parts is one part with an empty prefix.
    """
    sides = {f"{part}.": side for part, side in plain.get("sides", {}).items()}
    return {prefix: 1 if side == "right" else -1 for prefix, side in (sides or {"": plain["side"]}).items()}


def directions(plain: Mapping[str, Any]) -> dict[str, Vector]:
    """The directions of the car by name, exact if its axes are."""
    ways = {"up": plain["up"], "right": plain["right"], "forward": cross(plain["up"], plain["right"])}
    opposite = {"up": "down", "right": "left", "forward": "rearward"}
    return ways | {opposite[word]: times(way, -1) for word, way in ways.items()}
