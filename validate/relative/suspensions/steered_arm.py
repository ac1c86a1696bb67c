"""What suspensions share: the lower arm that an angle drives, the rack, and the tie rod to the knuckle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.errors import HardpointsError
from validate.relative.linkage import (
    CHASSIS,
    Distance,
    Drive,
    Joint,
    Place,
    Points,
    Side,
    length,
    triple,
)

Array = NDArray[np.float64]

FRONT, REAR, BALL = "lower_arm_front", "lower_arm_rear", "lower_ball_joint"
OUTER, INNER, RACK = "tie_rod_outer", "tie_rod_inner", "rack_centre"
ARM, RACK_BODY, KNUCKLE = "lower_arm", "rack", "knuckle"
APART = "points apart from each other"


@dataclass(frozen=True)
class Axes:
    """Directions of the car, as given, (3,)."""

    up: Array
    right: Array


def direction(points: Points, start: str, end: str) -> Array:
    """Unit vector from one point to another.

    Raises:
        HardpointsError: they are at one place.
    """
    vector = points[end] - points[start]
    size = length(vector)
    if size == 0.0:
        raise HardpointsError(f"{start}", f"is where {end} is, so that their line has no direction", APART)
    return np.asarray(vector / size)


def hinged_arm(body: str, points: Points, front: str, rear: str, ball: str) -> Joint:
    """An arm on two pivots of the chassis.

    Raises:
        HardpointsError: the pivots are at one place, or the ball joint is on their line.
    """
    axis = direction(points, front, rear)
    if length(np.cross(axis, points[ball] - points[front])) == 0.0:
        raise HardpointsError(
            ball, f"lies on the line through {front} and {rear}", "a place beside that line"
        )
    return Joint(body, CHASSIS, "revolute", points[front], axis)


def arm_drive(points: Points, axes: Axes) -> Drive:
    """The lower arm's angle: (ball joint - front pivot) . up = d cos(angle)."""
    reach = points[BALL] - points[FRONT]
    size = length(reach)
    share = min(1.0, max(-1.0, float(reach @ axes.up) / size))
    return Drive(
        "arm_angle", "angle", Place(ARM, points[BALL]), points[FRONT], axes.up, size, math.acos(share)
    )


def arm_side(points: Points, axes: Axes) -> Side:
    """The ball joint beside the arm's axis: ((ball - front) x (rear - front)) . up."""
    front, rear, ball = points[FRONT], points[REAR], points[BALL]
    above = front + axes.up
    return Side(
        "the lower arm is at a dead point",
        (Place(CHASSIS, front), Place(ARM, ball), Place(CHASSIS, rear), Place(CHASSIS, above)),
        triple(front, ball, rear, above),
        length(ball - front) * length(rear - front),
    )


@dataclass(frozen=True)
class Steering:
    """The rack, and the tie rod's closure.

    Attributes:
        joint: of the rack. drive: its travel.
        inner: the tie rod's inner end where the rack's line has it nearest to the drawing.
        tie_rod: its closure.
    """

    joint: Joint
    drive: Drive
    inner: Place
    tie_rod: Distance


def steering(points: Points, axes: Axes, outer: Array) -> Steering:
    """The rack runs along `right` through its centre, p = rack_centre - S right.

    Args:
        outer: where the knuckle has the tie rod's outer end in the reference pose, (3,).
    Raises:
        HardpointsError: the tie rod has no length.
    """
    centre, drawn = points[RACK], points[INNER]
    along = axes.right / length(axes.right)
    squared = float(axes.right @ axes.right)
    miss = drawn - centre
    travel = -float(miss @ axes.right) / squared
    aside = miss - float(miss @ along) * along
    inner = centre + float(miss @ along) * along if np.any(aside) else drawn
    rod = length(points[OUTER] - drawn)
    if rod == 0.0:
        raise HardpointsError(OUTER, f"is where {INNER} is, so that the tie rod has no length", APART)
    place = Place(RACK_BODY, inner)
    gap = (inner - outer) - (drawn - points[OUTER])
    return Steering(
        Joint(RACK_BODY, CHASSIS, "prismatic", inner, along),
        Drive("rack", "travel", place, centre, -axes.right, squared, travel),
        place,
        Distance(place, Place(KNUCKLE, outer), rod, gap),
    )


def tie_side(start: Place, end: Place, inner: Place, outer: Array, points: Points, kingpin: Array) -> Side:
    """The tie rod beside the kingpin: (k x (inner - ball)) . (outer - ball).

    Args:
        start, end: of the kingpin, the first one the ball joint.
        inner: the tie rod's. outer: where the knuckle has it in the reference pose, (3,).
        kingpin: as drawn, (3,).
    """
    ball = points[BALL]
    reach, arm = points[INNER] - ball, points[OUTER] - ball
    return Side(
        "tie rod and steering arm lie in line",
        (start, end, inner, Place(KNUCKLE, outer)),
        float(np.cross(kingpin, reach) @ arm),
        length(kingpin) * length(reach) * length(arm),
    )
