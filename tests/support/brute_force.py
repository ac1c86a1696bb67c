"""Whether a car has a pose, looked for place by place on its circles and lines, and not calculated."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import Car

Array = NDArray[np.float64]
PLACES = 200_001


class Found(NamedTuple):
    """Whether arm and upper end of the knuckle have a place, and whether the tie rod has one as well."""

    upper_end: bool
    tie_rod: bool


def circle(middle: Array, axis: Array, arm: Array) -> Array:
    """The places of an arm's end that turns about an axis through `middle`, (PLACES, 3)."""
    turns = np.linspace(-math.pi, math.pi, PLACES)[:, None]
    along = (arm @ axis) * axis
    return np.asarray(middle + along + np.cos(turns) * (arm - along) + np.sin(turns) * np.cross(axis, arm))


def crossings(values: Array) -> list[int]:
    """Where a sequence of numbers changes its sign."""
    return [i for i, (a, b) in enumerate(pairwise(values)) if a * b <= 0.0]


def look_for_pose(car: Car, angle: float, rack: float) -> Found:
    """Look for a pose on the side of the drawing at an arm angle (rad) and a rack travel (mm)."""
    p = car.array
    front, ball = p["lower_arm_front"], p["lower_ball_joint"]
    axis = _unit(p["lower_arm_rear"] - front)
    places = circle(front, axis, ball - front)
    height = (places - front) @ np.array(car.up) - math.cos(angle) * np.linalg.norm(ball - front)
    aside = np.cross(axis, car.up)
    side = aside @ (ball - front)
    found = [places[i] for i in crossings(height) if (aside @ (places[i] - front)) * side > 0]
    if not found:
        return Found(False, False)
    line = (
        _wishbone_kingpin(p, found[0])
        if car.suspension == "double_wishbone"
        else _strut_kingpin(car, found[0])
    )
    if line is None:
        return Found(False, False)
    now, drawn = line
    outer = p["tie_rod_outer"] - ball
    climb, radius = outer @ drawn, np.linalg.norm(np.cross(drawn, outer))
    beside = _unit(np.cross(now, (0.6, 0.0, 0.8)))
    ring = circle(found[0], now, climb * now + radius * beside)
    inner = p.get("rack_centre", p["tie_rod_inner"]) - rack * np.array(car.right)
    gap = np.linalg.norm(ring - inner, axis=1) - np.linalg.norm(p["tie_rod_outer"] - p["tie_rod_inner"])
    return Found(True, bool((gap <= 0.0).any() and (gap >= 0.0).any()))


def _wishbone_kingpin(p: dict[str, Array], ball: Array) -> tuple[Array, Array] | None:
    """Direction of the kingpin, now and as drawn: the upper ball joint is looked for on its circle."""
    pivot, upper, drawn = p["upper_arm_front"], p["upper_ball_joint"], p["lower_ball_joint"]
    axis = _unit(p["upper_arm_rear"] - pivot)
    places = circle(pivot, axis, upper - pivot)
    gap = np.linalg.norm(places - ball, axis=1) - np.linalg.norm(upper - drawn)
    side = np.cross(axis, drawn - pivot) @ (upper - pivot)
    found = [
        places[i] for i in crossings(gap) if np.cross(axis, ball - pivot) @ (places[i] - pivot) * side > 0
    ]
    return (_unit(found[0] - ball), _unit(upper - drawn)) if found else None


def _strut_kingpin(car: Car, ball: Array) -> tuple[Array, Array] | None:
    """The same of a strut: its top is looked for on the axis in the knuckle."""
    p = car.array
    drawn, top, lower = p["lower_ball_joint"], p["strut_top"], p["strut_lower"] - p["lower_ball_joint"]
    base, toward = (lower, top - p["strut_lower"]) if car.closure == "drawn" else (np.zeros(3), lower)
    carried = base + np.linspace(-5e3, 5e3, PLACES)[:, None] * _unit(toward)
    gap = np.linalg.norm(carried, axis=1) - np.linalg.norm(top - ball)
    side = (top - drawn) @ toward
    found = [carried[i] for i in crossings(gap) if (carried[i] @ toward) * side > 0.0]
    return (_unit(top - ball), _unit(found[0])) if found and (gap <= 0.0).any() else None


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
