r"""How far the inputs of a MacPherson strut can go, in closed form: where the arm and the tie rod lock.

The ball joint runs on a circle about the arm's axis; its height is extreme where the circle crosses the
vertical plane through the axis. For a held arm the tie rod's outer end runs on a circle about the strut;
the rack can go to where the tie rod is as long as the shortest or the longest way to that circle. Plain
floating point, for test scenes only: nothing is proven here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SCANNED = 100  # steps of the search for the nearest limit
HALVINGS = 80  # leave 2^-80 of a step, less than rounding


def arm_limits(points: Mapping[str, Array], up: Array) -> tuple[float, float]:
    """Least and greatest arm angle, rad, at which the ball joint still has a place."""
    middle, half = _rises(points, up)
    length = float(np.linalg.norm(points["lower_ball_joint"] - points["lower_arm_front"]))
    least, greatest = (math.acos(max(-1.0, min(1.0, h / length))) for h in (middle + half, middle - half))
    return least, greatest


def _rises(points: Mapping[str, Array], up: Array) -> tuple[float, float]:
    """Middle and half width of the ball joint's heights over the arm's front pivot."""
    axis = _unit(points["lower_arm_rear"] - points["lower_arm_front"])
    arm = points["lower_ball_joint"] - points["lower_arm_front"]
    along = float(arm @ axis)
    radius = float(np.linalg.norm(arm - along * axis))
    return along * float(axis @ up), radius * float(np.linalg.norm(np.cross(axis, up)))


def ball_joint(points: Mapping[str, Array], up: Array, angle: float) -> Array | None:
    """The ball joint at an arm angle, on its drawn side of the vertical plane; None out of reach."""
    front, drawn = points["lower_arm_front"], points["lower_ball_joint"]
    axis = _unit(points["lower_arm_rear"] - front)
    arm = drawn - front
    along = float(arm @ axis) * axis
    upward = _unit(up - float(up @ axis) * axis)
    across = np.cross(axis, upward)
    middle, half = _rises(points, up)
    share = (float(np.linalg.norm(arm)) * math.cos(angle) - middle) / half
    if abs(share) > 1.0:
        return None
    radius = float(np.linalg.norm(arm - along))
    side = math.copysign(1.0, float(arm @ across))
    turned = share * upward + side * math.sqrt(1.0 - share * share) * across
    return np.asarray(front + along + radius * turned)


def rack_limits(
    points: Mapping[str, Array], up: Array, right: Array, angle: float, farthest: float
) -> tuple[float, ...]:
    """Rack travels to either side, mm, at which tie rod and steering arm lock; those within `farthest`."""
    ball = ball_joint(points, up, angle)
    if ball is None or spare(points, right, ball, 0.0) <= 0.0:
        return ()
    found = []
    for end in (farthest, -farthest):
        travels = np.linspace(0.0, end, SCANNED + 1)
        locked = [i for i, s in enumerate(travels) if spare(points, right, ball, float(s)) <= 0.0]
        if locked:
            free, stuck = float(travels[locked[0] - 1]), float(travels[locked[0]])
            for _ in range(HALVINGS):
                halfway = 0.5 * (free + stuck)
                if spare(points, right, ball, halfway) > 0.0:
                    free = halfway
                else:
                    stuck = halfway
            found.append(free)
    return tuple(found)


def spare(points: Mapping[str, Array], right: Array, ball: Array, travel: float) -> float:
    """How far the tie rod is from locking, mm^2: positive while its outer end has two places."""
    lower, outer = points["strut_lower"], points["tie_rod_outer"]
    along = _unit(points["strut_top"] - ball)
    drawn = points["lower_ball_joint"]
    edge = float(np.linalg.norm(lower - drawn))
    sense = math.copysign(1.0, float((lower - drawn) @ (points["strut_top"] - drawn)))
    arm, brace = float(np.linalg.norm(outer - drawn)), float(np.linalg.norm(outer - lower))
    place = (arm**2 + edge**2 - brace**2) / (2.0 * edge)
    radius = math.sqrt(max(arm**2 - place**2, 0.0))
    inner = points["rack_centre"] - travel * right - (ball + sense * place * along)
    height = float(inner @ along)
    off = float(np.linalg.norm(inner - height * along))
    rod = float(np.linalg.norm(outer - points["tie_rod_inner"]))
    longest, shortest = math.hypot(off + radius, height), math.hypot(off - radius, height)
    return min(longest**2 - rod**2, rod**2 - shortest**2)


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))
