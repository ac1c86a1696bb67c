"""Struts whose axis passes beside the ball joint, as drawn, where their own geometry gets hard.

The axis is fixed in the knuckle, and so it may stand in any way to the three points that carry the knuckle:
through any of them, in their plane or at right angles to it, with its own two points far off or close
together. None of this makes the mechanism singular. What does is a slide that runs out: the ball joint comes
as near to the strut's top as it lies beside the axis, and two places of the top on the axis meet.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import as_tuples
from validate.hard.cars import BESIDE, BESIDE_CAR, drawn_angle
from validate.hard.case import RIGHT, Case, Expected, decades
from validate.hard.cases.near_points import motion_from
from validate.hard.family import SOLVERS, Content
from validate.hard.trial import scene_case

Array = NDArray[np.float64]
Points = Mapping[str, Array]

GROUP = "The strut's axis beside the ball joint"
OFF = 37.0  # mm: how far the axis is from the ball joint in the car that the cases are made from
# A millimetre or so, as there may be in a car, must be solved; nearer a model may decline.
SOLVED = Expected(("right", "refused"), right_from=1e-2)
EVERY, SECOND = (*decades(), 0.0), decades()[::2]
AT_FIRST = (*decades(-4), 1e-6, 1e-9, 1e-12)  # where it is refused, each refusal takes a second


def drawn() -> dict[str, Array]:
    """The car that the cases change."""
    return {name: np.array(place) for name, place in BESIDE.items()}


def with_axis(p: Points, lower: Array) -> dict[str, Array]:
    """The strut's axis through another place of strut_lower, its rod end on it."""
    return {**p, "strut_lower": lower, "strut_rod_end": p["strut_top"] + 0.4 * (lower - p["strut_top"])}


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def _inboard(p: Points) -> Array:
    """Unit vector from the line through ball joint and top to the drawn axis."""
    along = _unit(p["strut_top"] - p["lower_ball_joint"])
    off = p["strut_lower"] - p["lower_ball_joint"]
    return _unit(off - (off @ along) * along)


def ball_joint_near_axis(value: float) -> Points:
    """The axis passes the ball joint at a distance."""
    p = drawn()
    foot = p["lower_ball_joint"] + OFF * value * _inboard(p)
    return with_axis(p, foot + 0.2 * (p["strut_top"] - foot))


def axis_in_the_triangle(value: float) -> Points:
    """The axis leans out of the plane of ball joint, tie rod end and strut_lower by this share."""
    p = drawn()
    ball, top, outer = p["lower_ball_joint"], p["strut_top"], p["tie_rod_outer"]
    normal = _unit(np.cross(top - ball, outer - ball))
    return with_axis(p, ball + 0.1 * (top - ball) + 0.5 * (outer - ball) + 100.0 * value * normal)


def axis_across_the_triangle(value: float) -> Points:
    """Ball joint, tie rod end and strut_lower in one plane across the axis, but for a share."""
    p = drawn()
    beside = p["lower_ball_joint"] + OFF * _inboard(p)
    axis = _unit(p["strut_top"] - beside)
    lower = beside + ((p["lower_ball_joint"] - beside) @ axis) * axis
    climb = (p["tie_rod_outer"] - lower) @ axis
    return with_axis({**p, "tie_rod_outer": p["tie_rod_outer"] - (1.0 - value) * climb * axis}, lower)


def thin_knuckle(value: float) -> Points:
    """strut_lower, and the axis there, near the line from the ball joint to the tie rod's end."""
    p = drawn()
    middle = p["lower_ball_joint"] + 0.4 * (p["tie_rod_outer"] - p["lower_ball_joint"])
    return with_axis(p, middle + OFF * value * _inboard(p))


def axis_near_tie_rod_end(value: float) -> Points:
    """The axis passes the tie rod's outer end at a distance."""
    p = drawn()
    there = p["tie_rod_outer"] + OFF * value * _inboard(p)
    return with_axis(p, there + 0.3 * (there - p["strut_top"]))


def kingpin_near_tie_rod_end(value: float) -> Points:
    """The tie rod's outer end near the line from ball joint to top, about which the knuckle is steered."""
    p = drawn()
    along = _unit(p["strut_top"] - p["lower_ball_joint"])
    off = p["tie_rod_outer"] - p["lower_ball_joint"]
    foot = p["lower_ball_joint"] + (off @ along) * along
    return {**p, "tie_rod_outer": foot + value * (p["tie_rod_outer"] - foot)}


def axis_near_ball_joint(value: float) -> Points:
    """The axis drawn by a point near the ball joint."""
    p = drawn()
    return with_axis(p, p["lower_ball_joint"] + value * (p["strut_lower"] - p["lower_ball_joint"]))


def moved_to(moved: str, onto: str, share: Callable[[float], float]) -> Callable[[float], Points]:
    """A point on its line through another one, at a share of its drawn distance from it."""

    def points(value: float) -> Points:
        p = drawn()
        return {**p, moved: p[onto] + share(value) * (p[moved] - p[onto])}

    return points


def off_its_line(moved: str, way: tuple[float, float, float]) -> Callable[[float], Points]:
    """A point that the drawing has beside its line."""

    def points(value: float) -> Points:
        p = drawn()
        return {**p, moved: p[moved] + value * np.array(way)}

    return points


def slide_drawn_run_out(value: float) -> Points:
    """The line from top to ball joint at a right angle to the axis, but for this."""
    p = drawn()
    down = _unit(p["lower_ball_joint"] - p["strut_top"])
    axis = _unit(_unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {
        **p,
        "strut_lower": p["strut_top"] + 300.0 * axis,
        "strut_rod_end": p["strut_top"] + 100.0 * axis,
    }


def motion(points: Points, arm: float, rack: float) -> Content:
    """From the drawing by `arm` rad and `rack` mm in a second, with accelerations as large."""
    car = replace(BESIDE_CAR, points=as_tuples(dict(points)))
    return motion_from(drawn_angle(car), car, (0.5 * arm,) * 2, (0.5 * rack,) * 2)


def _content(points: Callable[[float], Points], shrinking: bool, value: float) -> Content:
    # A knuckle that is steered by a short arm follows no more than that arm's own length.
    share = value if shrinking else 1.0
    return motion(points(value), 0.1 * share, 20.0 * share)


def _case(
    name: str,
    why: str,
    parameter: str,
    points: Callable[[float], Points],
    expected: Expected,
    values: tuple[float, ...] = EVERY,
    shrinking: bool = False,
) -> Case:
    right_from = expected.right_from
    return scene_case(
        name=name,
        group=GROUP,
        why=why,
        parameter=parameter,
        values=values,
        expected=dict.fromkeys(SOLVERS, expected),
        behaviour="right within the bound"
        if expected == RIGHT
        else f"right within the bound, or refused with a reason; right from {right_from:g} up",
        scene=partial(_content, points, shrinking),
    )


PARTS = "in parts of what it is in the car"
CASES: tuple[Case, ...] = (
    _case(
        "ball-joint-near-the-axis",
        "The ball joint comes to lie on the axis of the strut: the general strut becomes the collinear one.",
        f"distance of the ball joint from the axis, in parts of {OFF:g} mm; then on it",
        ball_joint_near_axis,
        RIGHT,
    ),
    _case(
        "axis-in-the-knuckle-plane",
        "The axis lies in the plane of ball joint, tie rod end and strut_lower.",
        "distance of strut_lower from the plane of the others and the top, in parts of 100 mm; then in it",
        axis_in_the_triangle,
        RIGHT,
        (*SECOND, 0.0),
    ),
    _case(
        "axis-across-the-knuckle-plane",
        "The axis stands at right angles to the plane of ball joint, tie rod end and strut_lower.",
        f"height of the tie rod's end over that plane, {PARTS}; then in it",
        axis_across_the_triangle,
        RIGHT,
        (*SECOND, 0.0),
    ),
    _case(
        "knuckle-in-line-beside",
        "Ball joint, strut_lower and tie rod end lie nearly in line, the axis across: a sound mechanism.",
        f"distance of strut_lower from the line of the others, in parts of {OFF:g} mm",
        thin_knuckle,
        SOLVED,
        decades(),
    ),
    _case(
        "axis-through-the-tie-rod-end",
        "The strut's axis passes through the tie rod's outer end, which is no steering axis.",
        f"distance of the axis from it, in parts of {OFF:g} mm; then through it",
        axis_near_tie_rod_end,
        RIGHT,
        (*SECOND, 0.0),
    ),
    _case(
        "kingpin-through-the-tie-rod-end",
        "The line from ball joint to top passes nearly through the tie rod's end: the rack hardly steers.",
        f"length of the steering arm, {PARTS}",
        kingpin_near_tie_rod_end,
        SOLVED,
        decades(),
        True,
    ),
    _case(
        "strut-lower-far-below",
        "The axis is drawn by a point far below the ball joint, whose rounding turns it.",
        "drawn distance of strut_lower from the top over what it is",
        moved_to("strut_lower", "strut_top", lambda value: 1.0 / value),
        Expected(("right", "refused"), right_from=1e-3),
        AT_FIRST,
    ),
    _case(
        "strut-lower-far-above",
        "The axis is drawn by a point above the top, so that top and rod end lie on its other side.",
        "drawn distance of strut_lower from the top over what it is",
        moved_to("strut_lower", "strut_top", lambda value: -1.0 / value),
        Expected(("right", "refused"), right_from=1e-3),
        AT_FIRST,
    ),
    _case(
        "strut-lower-near-the-top",
        "The axis is drawn by two points that nearly coincide.",
        f"distance of strut_lower from the top, {PARTS}",
        moved_to("strut_lower", "strut_top", lambda value: value),
        SOLVED,
        decades(),
    ),
    _case(
        "strut-lower-near-the-ball-joint",
        "The axis passes near the ball joint, and is drawn by a point there: the knuckle has no long side.",
        f"distance of strut_lower from the ball joint, {PARTS}",
        axis_near_ball_joint,
        SOLVED,
        AT_FIRST,
    ),
    _case(
        "rod-end-near-the-top",
        "The rod is short: its two points nearly coincide.",
        f"distance of the rod's end from the top, {PARTS}",
        moved_to("strut_rod_end", "strut_top", lambda value: value),
        SOLVED,
        decades(),
    ),
    _case(
        "rod-end-beyond-the-top",
        "The rod's end is drawn above the top, by less and less.",
        f"distance of the rod's end from the top, {PARTS}",
        moved_to("strut_rod_end", "strut_top", lambda value: -value),
        SOLVED,
        decades(),
    ),
    _case(
        "spin-axis-short",
        "The wheel's spin axis is drawn by two points that nearly coincide.",
        f"distance of its inner point from the wheel centre, {PARTS}",
        moved_to("wheel_axis_inner", "wheel_centre", lambda value: value),
        SOLVED,
        decades(),
    ),
    _case(
        "rod-end-off-the-axis",
        "The drawing has the rod's end beside the axis, so it does not close.",
        "distance of the rod's end from the axis, mm",
        off_its_line("strut_rod_end", (1.0, 0.0, 0.0)),
        RIGHT,
        decades(),
    ),
    _case(
        "rack-joint-off-its-line",
        "The drawing has the tie rod's inner end beside the line of the rack, so it does not close.",
        "distance of the tie rod's inner end from that line, mm",
        off_its_line("tie_rod_inner", (0.6, 0.0, 0.8)),
        RIGHT,
        decades(),
    ),
    _case(
        "slide-drawn-run-out",
        "The drawing is close to where two places of the top on the axis meet: rounding may choose.",
        "what the axis is off a right angle to the line from top to ball joint, rad",
        slide_drawn_run_out,
        Expected(("right", "refused"), right_from=1e-6),
        decades(),
    ),
)
