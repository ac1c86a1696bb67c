"""Cars in motion whose points are drawn out of proportion: nearly in line, nearly coincident, or far away.

Links between near points lose digits when coordinates are subtracted, and directions through them turn by
rounding. A case takes an assembled car and changes nothing else.

A strut's axis is fixed in the knuckle, and so it may stand in any way to the three points that carry the
knuckle: through any of them, in their plane or at right angles to it, with its own two points far off or
close together. None of this makes the mechanism singular. What does is a slide that runs out: the ball joint
comes as near to the strut's top as it lies beside the axis, and two places of the top on the axis meet.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import Car, unit
from validate.hard.cars import CARS, drawn_angle, drawn_at, scene_content
from validate.hard.case import RIGHT, Case, Expected, decades
from validate.hard.family import NAMED, SOLVERS, Content
from validate.hard.trial import scene_case

Array = NDArray[np.float64]
Points = Mapping[str, Array]
Draw = Callable[[Points, float], Points]
"""The points of a car at a value of the parameter."""

# A millimetre or so, as there may be in a car, must be solved; nearer a model may decline.
SOLVED = Expected(("right", "refused"), right_from=1e-2)
# A thousand times the rest of the car is as mixed as parts of one machine are.
MIXED = Expected(("right", "refused"), right_from=1e-3)
OFF = 37.0  # mm: how far the axis is from the ball joint in the car beside
SLOW = decades()[::3]  # a refusal takes half a second here
EVERY, SECOND = (*decades(), 0.0), (*decades()[::2], 0.0)
AT_FIRST = (*decades(-4), 1e-6, 1e-9, 1e-12)  # where it is refused, each refusal takes a second
BALL, OUTER, INNER = "lower_ball_joint", "tie_rod_outer", "tie_rod_inner"
FRONT, REAR, LOWER = "lower_arm_front", "lower_arm_rear", "strut_lower"
TOP, ROD_END = "strut_top", "strut_rod_end"
UPPER_BALL, UPPER_FRONT, UPPER_REAR = "upper_ball_joint", "upper_arm_front", "upper_arm_rear"


@cache
def assembled(car: str = "paper") -> dict[str, Array]:
    """A car at its own inputs, each coordinate the nearest number to the true one, mm."""
    if CARS[car].closure == "drawn":
        return CARS[car].array
    return drawn_at(CARS[car], NAMED[car].drawn).array


def put(*moved: str, from_: str, times: Callable[[Array, float], Array | float] = operator.mul) -> Draw:
    """Points at a share of their distance from another, on their lines through it."""

    def points(p: Points, value: float) -> Points:
        return {n: p[from_] + times(x - p[from_], value) if n in moved else x for n, x in p.items()}

    return points


def aside(moved: str, way: tuple[float, float, float]) -> Draw:
    """A point that the drawing has beside its line, mm."""
    return lambda p, value: {**p, moved: p[moved] + value * np.array(way)}


def thin_knuckle(upper: str) -> Draw:
    """The tie rod's outer end nearly on the line through the knuckle's other two points."""

    def points(p: Points, value: float) -> Points:
        line = unit(p[upper] - p[BALL])
        foot = p[BALL] + ((p[OUTER] - p[BALL]) @ line) * line
        return {**p, OUTER: foot + value * (p[OUTER] - foot)}

    return points


def flat_upper_arm(p: Points, value: float) -> Points:
    """The upper ball joint near the plane of the upper pivots and the lower ball joint."""
    normal = unit(np.cross(p[UPPER_REAR] - p[UPPER_FRONT], p[BALL] - p[UPPER_FRONT]))
    height = float((p[UPPER_BALL] - p[UPPER_FRONT]) @ normal)
    return {**p, UPPER_BALL: p[UPPER_BALL] - (1.0 - value) * height * normal}


def short_tie_rod(p: Points, value: float) -> Points:
    """The rack's end comes near the tie rod's outer end."""
    inner = p[OUTER] + value * (p[INNER] - p[OUTER])
    return {**p, INNER: inner, "rack_centre": inner}


def with_axis(p: Points, lower: Array) -> Points:
    """The strut's axis through another place of strut_lower, its rod end on it."""
    return {**p, LOWER: lower, ROD_END: p[TOP] + 0.4 * (lower - p[TOP])}


def _inboard(p: Points) -> Array:
    """Unit vector from the line through ball joint and top to the drawn axis."""
    along = unit(p[TOP] - p[BALL])
    off = p[LOWER] - p[BALL]
    return unit(off - (off @ along) * along)


def ball_joint_near_axis(p: Points, value: float) -> Points:
    """The axis passes the ball joint at a distance."""
    foot = p[BALL] + OFF * value * _inboard(p)
    return with_axis(p, foot + 0.2 * (p[TOP] - foot))


def axis_in_the_triangle(p: Points, value: float) -> Points:
    """The axis leans out of the plane of ball joint, tie rod end and strut_lower by this share."""
    ball, top, outer = p[BALL], p[TOP], p[OUTER]
    normal = unit(np.cross(top - ball, outer - ball))
    return with_axis(p, ball + 0.1 * (top - ball) + 0.5 * (outer - ball) + 100.0 * value * normal)


def axis_across_the_triangle(p: Points, value: float) -> Points:
    """Ball joint, tie rod end and strut_lower in one plane across the axis, but for a share."""
    beside = p[BALL] + OFF * _inboard(p)
    axis = unit(p[TOP] - beside)
    lower = beside + ((p[BALL] - beside) @ axis) * axis
    climb = (p[OUTER] - lower) @ axis
    return with_axis({**p, OUTER: p[OUTER] - (1.0 - value) * climb * axis}, lower)


def axis_near_line_to_tie_rod_end(p: Points, value: float) -> Points:
    """strut_lower, and the axis there, near the line from the ball joint to the tie rod's end."""
    return with_axis(p, p[BALL] + 0.4 * (p[OUTER] - p[BALL]) + OFF * value * _inboard(p))


def axis_near_tie_rod_end(p: Points, value: float) -> Points:
    """The axis passes the tie rod's outer end at a distance."""
    there = p[OUTER] + OFF * value * _inboard(p)
    return with_axis(p, there + 0.3 * (there - p[TOP]))


def axis_near_ball_joint(p: Points, value: float) -> Points:
    """The axis drawn by a point near the ball joint."""
    return with_axis(p, p[BALL] + value * (p[LOWER] - p[BALL]))


def slide_drawn_run_out(p: Points, value: float) -> Points:
    """The line from top to ball joint at a right angle to the axis, but for this."""
    down = unit(p[BALL] - p[TOP])
    axis = unit(unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {**p, LOWER: p[TOP] + 300.0 * axis, ROD_END: p[TOP] + 100.0 * axis}


def motion_from(angle: float, car: Car, arm: Sequence[float], rack: Sequence[float]) -> Content:
    """A motion of one second from an arm angle and no rack travel; rates in rad and mm over s, and half
    accelerations.
    """
    return scene_content(car, (angle, *arm), (0.0, *rack), stop=1.0)


def _solved(car: str, draw: Draw, share: float, value: float) -> Content:
    """By 0.1 rad and 20 mm in a second, with accelerations as large."""
    there = CARS[car].drawn_as(draw(assembled(car), value))
    angle = NAMED[car].drawn["arm_angle"] if car == "paper" else drawn_angle(there)
    return motion_from(angle, there, (0.05 * share,) * 2, (10.0 * share,) * 2)


def _mixed(car: str, draw: Draw, share: float, value: float) -> Content:
    """By 0.15 rad and 15 mm in a second."""
    there = CARS[car].drawn_as(draw(assembled(car), value))
    rates = (0.1 * share, 0.05 * share), (10.0 * share, 5.0 * share)
    return motion_from(NAMED[car].drawn["arm_angle"], there, *rates)


class Row(NamedTuple):
    """A way to draw a car.

    Attributes:
        shrinks: whether its motion shrinks with the value: a short link follows no more than its own length.
        parameter, expected, values: where they differ from those of the table.
    """

    name: str
    why: str
    draw: Draw
    shrinks: bool = False
    parameter: str = ""
    expected: Expected | None = None
    values: tuple[float, ...] = ()


def _case(
    row: Row,
    group: str,
    car: str,
    suffix: str,
    motion: Callable[[str, Draw, float, float], Content],
    parameter: str,
    expected: Expected,
    values: tuple[float, ...],
) -> Case:
    expected = row.expected or expected

    def scene(value: float) -> Content:
        return motion(car, row.draw, value if row.shrinks else 1.0, value)

    return scene_case(
        name=row.name + suffix,
        group=group,
        why=row.why,
        parameter=row.parameter or parameter,
        values=row.values or values,
        expected=dict.fromkeys(SOLVERS, expected),
        scene=scene,
    )


LINE = "The arm turns about a line through two points that nearly coincide; the {} one is moved."


def _of_every_car(upper: str) -> tuple[Row, ...]:
    """What both suspensions have; `upper` is the knuckle's third point."""
    return (
        Row(
            "knuckle-in-line",
            "Three points that carry the knuckle lie nearly in line, so they hardly tell how it is turned.",
            thin_knuckle(upper),
            True,
        ),
        Row("arm-axis-rear-near", LINE.format("rear"), put(REAR, from_=FRONT)),
        Row("arm-axis-front-near", LINE.format("front"), put(FRONT, from_=REAR)),
        Row(
            "steering-arm-short",
            "The tie rod's outer end nearly coincides with the ball joint, and so the rack hardly moves it.",
            put(OUTER, from_=BALL),
            True,
        ),
        Row(
            "tie-rod-short",
            "The tie rod's ends nearly coincide, so its direction is made of rounding.",
            short_tie_rod,
            True,
        ),
    )


OF_STRUT = (
    Row(
        "strut-points-near",
        "The strut's direction comes from two points that nearly coincide.",
        put(ROD_END, from_=TOP),
    ),
    Row(
        "knuckle-foot-short",
        "The strut's lower point nearly coincides with the ball joint, so the knuckle has no long side.",
        put(LOWER, from_=BALL),
    ),
)
OF_WISHBONE = (
    Row(
        "kingpin-short",
        "The ball joints of a double wishbone nearly coincide, so the knuckle has no long side.",
        put(UPPER_BALL, from_=BALL),
        True,
    ),
    Row(
        "upper-arm-flat",
        "The upper arm is drawn near where it locks: rounding may choose the side of its ball joint.",
        flat_upper_arm,
        True,
    ),
    Row(
        "upper-arm-axis-near",
        "The upper arm turns about a line through two points that nearly coincide.",
        put(UPPER_REAR, from_=UPPER_FRONT),
    ),
)
NEAR: tuple[Case, ...] = tuple(
    _case(
        row,
        "Points nearly in line or nearly coincident",
        car,
        NAMED[car].suffix,
        _solved,
        "distance, in parts of what it is in the car",
        SOLVED,
        values,
    )
    for car, values, rows in (
        ("paper", decades(), _of_every_car(LOWER)),
        ("paper", SLOW, OF_STRUT),
        ("wishbone", SLOW, (*_of_every_car(UPPER_BALL), *OF_WISHBONE)),
    )
    for row in rows
)

lengthened = partial(put, times=operator.truediv)
ARM_AXIS, STRUT = (FRONT, REAR), (TOP, ROD_END)
WISHBONE_MIXED = (
    Row(
        "tie-rod-long-wishbone",
        "The tie rod of a double wishbone is up to 1e14 mm long.",
        lengthened(INNER, from_=OUTER),
    ),
    Row(
        "arm-long-wishbone",
        "The lower arm of a double wishbone is up to 1e14 mm long; its angle shrinks with it.",
        lengthened(*ARM_AXIS, from_=BALL),
        True,
    ),
    Row(
        "upper-arm-long-wishbone",
        "The upper arm is up to 1e14 mm long, so that its ball joint moves on what is nearly a plane.",
        lengthened(UPPER_FRONT, UPPER_REAR, from_=UPPER_BALL),
    ),
)
PAPER_MIXED = (
    Row(
        "tie-rod-long",
        "The tie rod is up to 1e14 mm long, so that its outer end moves on what is nearly a plane.",
        lengthened(INNER, "rack_centre", from_=OUTER),
    ),
    Row(
        "strut-long",
        "The strut is up to 1e14 mm long, so that its direction hardly changes.",
        lengthened(*STRUT, from_=BALL),
    ),
    Row(
        "arm-long",
        "The arm is up to 1e14 mm long, so that a small angle is a long way; the angle shrinks with it.",
        lengthened(*ARM_AXIS, from_=BALL),
        True,
    ),
)
BESIDE_MIXED = (
    Row(
        "strut-long-beside",
        "The strut's top is up to 5e14 mm above a ball joint beside its axis, in a car of 500 mm.",
        lengthened(*STRUT, from_=LOWER),
    ),
    Row(
        "arm-long-beside",
        "The arm is as long, its ball joint beside the axis of the strut.",
        lengthened(*ARM_AXIS, from_=BALL),
        True,
    ),
)
AT_THE_STRUT = Row(
    "tie-rod-at-the-strut",
    "The tie rod ends as little as 1e-10 mm from the strut's foot, in a car of 500 mm.",
    put(OUTER, from_=LOWER),
    True,
    "distance, in parts of what it is in the paper's car",
)
OUT_OF_PROPORTION: tuple[Case, ...] = tuple(
    _case(
        row,
        "Far from the origin, and mixed sizes",
        car,
        "",
        _mixed,
        "how long it is in the paper's car over how long it is",
        MIXED,
        values,
    )
    for car, values, rows in (
        # Where it is refused, each refusal takes a second.
        ("wishbone", (1.0, 1e-3, 1e-6, 1e-12), WISHBONE_MIXED),
        ("paper", AT_FIRST, PAPER_MIXED),
        ("beside", AT_FIRST, BESIDE_MIXED),
        ("paper", AT_FIRST, (AT_THE_STRUT,)),
    )
    for row in rows
)

PARTS = "in parts of what it is in the car"
FROM_TOP = "drawn distance of strut_lower from the top over what it is"
FROM_LINE = f"distance of strut_lower from the line of the others, in parts of {OFF:g} mm"
ROD_FROM_TOP = f"distance of the rod's end from the top, {PARTS}"
BESIDE_ROWS = (
    Row(
        "ball-joint-near-the-axis",
        "The ball joint comes to lie on the axis of the strut: the general strut becomes the collinear one.",
        ball_joint_near_axis,
        False,
        f"distance of the ball joint from the axis, in parts of {OFF:g} mm; then on it",
        RIGHT,
        EVERY,
    ),
    Row(
        "axis-in-the-knuckle-plane",
        "The axis lies in the plane of ball joint, tie rod end and strut_lower.",
        axis_in_the_triangle,
        False,
        "distance of strut_lower from the plane of the others and the top, in parts of 100 mm; then in it",
        RIGHT,
        SECOND,
    ),
    Row(
        "axis-across-the-knuckle-plane",
        "The axis stands at right angles to the plane of ball joint, tie rod end and strut_lower.",
        axis_across_the_triangle,
        False,
        f"height of the tie rod's end over that plane, {PARTS}; then in it",
        RIGHT,
        SECOND,
    ),
    Row(
        "knuckle-in-line-beside",
        "Ball joint, strut_lower and tie rod end lie nearly in line, the axis across: a sound mechanism.",
        axis_near_line_to_tie_rod_end,
        False,
        FROM_LINE,
    ),
    Row(
        "axis-through-the-tie-rod-end",
        "The strut's axis passes through the tie rod's outer end, which is no steering axis.",
        axis_near_tie_rod_end,
        False,
        f"distance of the axis from it, in parts of {OFF:g} mm; then through it",
        RIGHT,
        SECOND,
    ),
    Row(
        "kingpin-through-the-tie-rod-end",
        "The line from ball joint to top passes nearly through the tie rod's end: the rack hardly steers.",
        thin_knuckle(TOP),
        True,
        f"length of the steering arm, {PARTS}",
    ),
    Row(
        "strut-lower-far-below",
        "The axis is drawn by a point far below the ball joint, whose rounding turns it.",
        put(LOWER, from_=TOP, times=lambda off, value: 1.0 / value * off),
        False,
        FROM_TOP,
        MIXED,
        AT_FIRST,
    ),
    Row(
        "strut-lower-far-above",
        "The axis is drawn by a point above the top, so that top and rod end lie on its other side.",
        put(LOWER, from_=TOP, times=lambda off, value: -1.0 / value * off),
        False,
        FROM_TOP,
        MIXED,
        AT_FIRST,
    ),
    Row(
        "strut-lower-near-the-top",
        "The axis is drawn by two points that nearly coincide.",
        put(LOWER, from_=TOP),
        False,
        f"distance of strut_lower from the top, {PARTS}",
    ),
    Row(
        "strut-lower-near-the-ball-joint",
        "The axis passes near the ball joint, and is drawn by a point there: the knuckle has no long side.",
        axis_near_ball_joint,
        False,
        f"distance of strut_lower from the ball joint, {PARTS}",
        SOLVED,
        AT_FIRST,
    ),
    Row(
        "rod-end-near-the-top",
        "The rod is short: its two points nearly coincide.",
        put(ROD_END, from_=TOP),
        False,
        ROD_FROM_TOP,
    ),
    Row(
        "rod-end-beyond-the-top",
        "The rod's end is drawn above the top, by less and less.",
        put(ROD_END, from_=TOP, times=lambda off, value: -value * off),
        False,
        ROD_FROM_TOP,
    ),
    Row(
        "spin-axis-short",
        "The wheel's spin axis is drawn by two points that nearly coincide.",
        put("wheel_axis_inner", from_="wheel_centre"),
        False,
        f"distance of its inner point from the wheel centre, {PARTS}",
    ),
    Row(
        "rod-end-off-the-axis",
        "The drawing has the rod's end beside the axis, so it does not close.",
        aside(ROD_END, (1.0, 0.0, 0.0)),
        False,
        "distance of the rod's end from the axis, mm",
        RIGHT,
    ),
    Row(
        "rack-joint-off-its-line",
        "The drawing has the tie rod's inner end beside the line of the rack, so it does not close.",
        aside(INNER, (0.6, 0.0, 0.8)),
        False,
        "distance of the tie rod's inner end from that line, mm",
        RIGHT,
    ),
    Row(
        "slide-drawn-run-out",
        "The drawing is close to where two places of the top on the axis meet: rounding may choose.",
        slide_drawn_run_out,
        False,
        "what the axis is off a right angle to the line from top to ball joint, rad",
        Expected(("right", "refused"), right_from=1e-6),
    ),
)
BESIDE: tuple[Case, ...] = tuple(
    _case(
        row,
        "The strut's axis beside the ball joint",
        "beside",
        "",
        _solved,
        PARTS,
        SOLVED,
        decades(),
    )
    for row in BESIDE_ROWS
)
