"""What random drawings of all suspensions share: free points, tie rod and rack, and what is nearly singular.

Everything is drawn by one function, `uniform(low, high)`, so that a generator of numbers or a search for
examples can be behind it; what is nearly singular by a generator alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from validate.cars.car import Array, Drawing, Uniform, random_vector, unit
from validate.cars.closed_form import BALL, FRONT, INNER, OUTER, RACK, REAR
from validate.cars.suspension import Nearly

SLID = 5.0  # mm, of the rack in its drawing


def free_points(
    uniform: Uniform, base: Mapping[str, Sequence[float]], names: Sequence[str], reach: float
) -> Drawing:
    """Points of a base car, each up to `reach` off in every coordinate."""
    return {name: np.array(base[name]) + random_vector(uniform, reach) for name in names}


def steered_from_ahead(uniform: Uniform, points: Drawing) -> Drawing:
    """The drawing, or one with the tie rod on the other side of the ball joint, in one of two."""
    if uniform(0.0, 1.0) >= 0.5:
        return points
    ball = points[BALL]
    ahead = {n: points[n] * (-1.0, 1.0, 1.0) + (2.0 * ball[0], 0.0, 0.0) for n in (OUTER, RACK)}
    return points | ahead


def with_rack(uniform: Uniform, points: Drawing, left_over: float) -> Drawing:
    """The tie rod's inner end on the rack's line, now and then beside it by no more than is left over.

    Now and then the drawing has no rack_centre, so that the inner end is on its line in any case.
    """
    inner = points[RACK] + (0.0, uniform(-SLID, SLID), 0.0)
    if uniform(0.0, 1.0) < 0.2:
        return {name: place for name, place in points.items() if name != RACK} | {INNER: inner}
    if uniform(0.0, 1.0) < 0.3:
        inner = inner + random_vector(uniform, left_over)
    return points | {INNER: inner}


def spin_axis(uniform: Uniform, centre: Array) -> Drawing:
    """The inner point of the wheel's spin axis."""
    inwards = np.array([uniform(-20.0, 20.0), uniform(50.0, 150.0), uniform(-20.0, 20.0)])
    return {"wheel_axis_inner": centre + inwards}


def dead_arm(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
    """The ball joint moved towards the vertical plane through the arm's axis, where its dead points are."""
    pivot, ball = points[FRONT], points[BALL]
    across = unit(np.cross(points[REAR] - pivot, (0.0, 0.0, 1.0)))
    return points | {BALL: ball - (1.0 - left) * ((ball - pivot) @ across) * across}


def flat_tie_rod(upper: str) -> Nearly:
    """The tie rod's outer end moved towards the plane of kingpin and rack, where it locks.

    Args:
        upper: the kingpin's upper point.
    """

    def moved(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
        ball, outer = points[BALL], points[OUTER]
        across = unit(np.cross(points[upper] - ball, points[INNER] - ball))
        return points | {OUTER: outer - (1.0 - left) * ((outer - ball) @ across) * across}

    return moved


def thin_knuckle(upper: str) -> Nearly:
    """The tie rod's outer end moved towards the kingpin, about which it then hardly turns the knuckle."""

    def moved(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
        ball, outer = points[BALL], points[OUTER]
        along = unit(points[upper] - ball)
        foot = ball + ((outer - ball) @ along) * along
        return points | {OUTER: foot + left * (outer - foot)}

    return moved


def without_rack_centre(nearly: Nearly) -> Nearly:
    """The same of a drawing whose tie rod ends on its rack's line.

    Near a lock what is left over on that line would move the car far, or it could not close.
    """

    def moved(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
        return nearly(rng, {name: place for name, place in points.items() if name != RACK}, left)

    return moved
