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
from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import unit
from validate.hard.cars import CARS, drawn_angle, drawn_at, scene_content
from validate.hard.case import RIGHT, Case, Expected, Values, case, reason_of, whole
from validate.hard.subjects import NAMED, Content, Subject, hyphens

Array = NDArray[np.float64]
Points = Mapping[str, Array]
Draw = Callable[[Points, float], Points]
"""The points of a car at a value of the parameter."""

# A millimetre or so, as there may be in a car, must be solved; nearer a model may decline.
SOLVED = Expected(("right", "refused"), right_from=1e-2)
# A thousand times the rest of the car is as mixed as parts of one machine are.
MIXED = Expected(("right", "refused"), right_from=1e-3)
OFF = 37.0  # mm: how far the axis is from the ball joint in the car beside
VALUES = (1.0, 1e-2, 1e-6, 1e-12)
# A refusal takes half a second and more here.
SLOW = (1.0, 1e-3, 1e-6, 1e-12)
AND_THERE = (1.0, 1e-4, 1e-8, 1e-12, 0.0)
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


lengthened = partial(put, times=operator.truediv)


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


def upper_arm_flat(p: Points, value: float) -> Points:
    """The upper arm is drawn near where it locks: rounding may choose the side of its ball joint."""
    normal = unit(np.cross(p[UPPER_REAR] - p[UPPER_FRONT], p[BALL] - p[UPPER_FRONT]))
    height = float((p[UPPER_BALL] - p[UPPER_FRONT]) @ normal)
    return {**p, UPPER_BALL: p[UPPER_BALL] - (1.0 - value) * height * normal}


def tie_rod_short(p: Points, value: float) -> Points:
    """The tie rod's ends nearly coincide, so its direction is made of rounding."""
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


def ball_joint_near_the_axis(p: Points, value: float) -> Points:
    """The ball joint comes to lie on the axis of the strut: the general strut becomes the collinear one."""
    foot = p[BALL] + OFF * value * _inboard(p)
    return with_axis(p, foot + 0.2 * (p[TOP] - foot))


def axis_in_the_knuckle_plane(p: Points, value: float) -> Points:
    """The axis lies in the plane of ball joint, tie rod end and strut_lower."""
    ball, top, outer = p[BALL], p[TOP], p[OUTER]
    normal = unit(np.cross(top - ball, outer - ball))
    return with_axis(p, ball + 0.1 * (top - ball) + 0.5 * (outer - ball) + 100.0 * value * normal)


def axis_across_the_knuckle_plane(p: Points, value: float) -> Points:
    """The axis stands at right angles to the plane of ball joint, tie rod end and strut_lower."""
    beside = p[BALL] + OFF * _inboard(p)
    axis = unit(p[TOP] - beside)
    lower = beside + ((p[BALL] - beside) @ axis) * axis
    climb = (p[OUTER] - lower) @ axis
    return with_axis({**p, OUTER: p[OUTER] - (1.0 - value) * climb * axis}, lower)


def knuckle_in_line_beside(p: Points, value: float) -> Points:
    """Ball joint, strut_lower and tie rod end lie nearly in line, the axis across: a sound mechanism."""
    return with_axis(p, p[BALL] + 0.4 * (p[OUTER] - p[BALL]) + OFF * value * _inboard(p))


def axis_through_the_tie_rod_end(p: Points, value: float) -> Points:
    """The strut's axis passes through the tie rod's outer end, which is no steering axis."""
    there = p[OUTER] + OFF * value * _inboard(p)
    return with_axis(p, there + 0.3 * (there - p[TOP]))


def strut_lower_near_the_ball_joint(p: Points, value: float) -> Points:
    """The axis passes near the ball joint, and is drawn by a point there: the knuckle has no long side."""
    return with_axis(p, p[BALL] + value * (p[LOWER] - p[BALL]))


def slide_drawn_run_out(p: Points, value: float) -> Points:
    """The drawing is close to where two places of the top on the axis meet: rounding may choose.

    The line from top to ball joint is at a right angle to the axis, but for this.
    """
    down = unit(p[BALL] - p[TOP])
    axis = unit(unit(np.cross(down, (1.0, 0.0, 0.0))) + value * down)
    return {**p, LOWER: p[TOP] + 300.0 * axis, ROD_END: p[TOP] + 100.0 * axis}


class Row(NamedTuple):
    """A way to draw a car.

    Attributes:
        name, why: of the case; those of the drawing if not given.
        shrinks: whether its motion shrinks with the value: a short link follows no more than its own length.
        parameter, expected, values: where they differ from those of the table.
    """

    draw: Draw
    name: str = ""
    why: str = ""
    shrinks: bool = False
    parameter: str = ""
    expected: Expected | None = None
    values: Values = ()


def near(row: Row, subject: Subject, value: float) -> Content:
    """From no rack travel by 0.1 rad and 20 mm in a second, with accelerations as large."""
    there = subject.car.drawn_as(row.draw(assembled(subject.name), value))
    angle = subject.drawn["arm_angle"] if subject.name == "paper" else drawn_angle(there)
    share = value if row.shrinks else 1.0
    arm, rack = 0.05 * share, 10.0 * share
    return scene_content(there, (angle, arm, arm), (0.0, rack, rack), stop=1.0)


def mixed(row: Row, subject: Subject, value: float) -> Content:
    """By 0.15 rad and 15 mm in a second."""
    there = subject.car.drawn_as(row.draw(assembled(subject.name), value))
    share = value if row.shrinks else 1.0
    arm = (subject.drawn["arm_angle"], 0.1 * share, 0.05 * share)
    return scene_content(there, arm, (0.0, 10.0 * share, 5.0 * share), stop=1.0)


LINE = "The arm turns about a line through two points that nearly coincide; the {} one is moved."
IN_LINE = "Three points that carry the knuckle lie nearly in line, so they hardly tell how it is turned."
STEERING = "The tie rod's outer end nearly coincides with the ball joint, and so the rack hardly moves it."
NO_LONG_SIDE = "{} nearly coincide, so the knuckle has no long side."
FROM_TWO = "The {} comes from two points that nearly coincide."
LONG = "The {} is up to 1e14 mm long."
PARTS = "in parts of what it is in the car"
FROM_TOP = "drawn distance of strut_lower from the top over what it is"
ROD_FROM_TOP = f"distance of the rod's end from the top, {PARTS}"
ARM_AXIS, STRUT = (FRONT, REAR), (TOP, ROD_END)
FAR = (False, FROM_TOP, MIXED, SLOW)


def _of_every_car(upper: str) -> tuple[Row, ...]:
    """What both suspensions have; `upper` is the knuckle's third point."""
    return (
        Row(thin_knuckle(upper), "knuckle-in-line", IN_LINE, True),
        Row(put(REAR, from_=FRONT), "arm-axis-rear-near", LINE.format("rear")),
        Row(put(FRONT, from_=REAR), "arm-axis-front-near", LINE.format("front")),
        Row(put(OUTER, from_=BALL), "steering-arm-short", STEERING, True),
        Row(tie_rod_short, shrinks=True),
    )


OF_STRUT = (
    Row(put(ROD_END, from_=TOP), "strut-points-near", FROM_TWO.format("strut's direction")),
    Row(put(LOWER, from_=BALL), "knuckle-foot-short", NO_LONG_SIDE.format("Strut's foot and ball joint")),
)
OF_WISHBONE = (
    Row(put(UPPER_BALL, from_=BALL), "kingpin-short", NO_LONG_SIDE.format("The ball joints"), True),
    Row(upper_arm_flat, shrinks=True),
    Row(put(UPPER_REAR, from_=UPPER_FRONT), "upper-arm-axis-near", FROM_TWO.format("upper arm's hinge")),
)
WISHBONE_MIXED = (
    Row(lengthened(INNER, from_=OUTER), "tie-rod-long", LONG.format("tie rod")),
    Row(lengthened(*ARM_AXIS, from_=BALL), "arm-long", LONG.format("lower arm"), True),
    Row(lengthened(UPPER_FRONT, UPPER_REAR, from_=UPPER_BALL), "upper-arm-long", LONG.format("upper arm")),
)
PAPER_MIXED = (
    Row(lengthened(INNER, "rack_centre", from_=OUTER), "tie-rod-long", LONG.format("tie rod")),
    Row(lengthened(*STRUT, from_=BALL), "strut-long", LONG.format("strut")),
    Row(lengthened(*ARM_AXIS, from_=BALL), "arm-long", LONG.format("arm"), True),
)
BESIDE_MIXED = (
    Row(lengthened(*STRUT, from_=LOWER), "strut-long", LONG.format("strut beside its ball joint")),
    Row(
        lengthened(*ARM_AXIS, from_=BALL),
        "arm-long",
        LONG.format("arm, its ball joint beside the axis,"),
        True,
    ),
)
AT_THE_STRUT = Row(
    put(OUTER, from_=LOWER),
    "tie-rod-at-the-strut",
    "The tie rod ends as little as 1e-10 mm from the strut's foot, in a car of 500 mm.",
    *(True, "distance, in parts of what it is in the paper's car"),
)
# Draw, and parameter, of what all models have to solve.
THROUGH = (
    (
        ball_joint_near_the_axis,
        f"distance of the ball joint from the axis, in parts of {OFF:g} mm; then on it",
    ),
    (
        axis_in_the_knuckle_plane,
        "strut_lower off the plane of the others and the top, in parts of 100 mm; then in it",
    ),
    (
        axis_across_the_knuckle_plane,
        f"height of the tie rod's end over that plane, {PARTS}; then in it",
    ),
    (
        axis_through_the_tie_rod_end,
        f"distance of the axis from it, in parts of {OFF:g} mm; then through it",
    ),
)
BESIDE_ROWS = (
    *(Row(draw, "", "", False, parameter, RIGHT, AND_THERE) for draw, parameter in THROUGH),
    Row(
        knuckle_in_line_beside,
        parameter=f"distance of strut_lower from the line of the others, in parts of {OFF:g} mm",
    ),
    Row(
        thin_knuckle(TOP),
        "kingpin-through-the-tie-rod-end",
        "The line from ball joint to top passes nearly through the tie rod's end: the rack hardly steers.",
        *(True, f"length of the steering arm, {PARTS}"),
    ),
    Row(
        put(LOWER, from_=TOP, times=lambda off, value: 1.0 / value * off),
        "strut-lower-far-below",
        "The axis is drawn by a point far below the ball joint, whose rounding turns it.",
        *FAR,
    ),
    Row(
        put(LOWER, from_=TOP, times=lambda off, value: -1.0 / value * off),
        "strut-lower-far-above",
        "The axis is drawn by a point above the top, so that top and rod end lie on its other side.",
        *FAR,
    ),
    Row(
        put(LOWER, from_=TOP),
        "strut-lower-near-the-top",
        FROM_TWO.format("axis"),
        parameter=f"distance of strut_lower from the top, {PARTS}",
    ),
    Row(
        strut_lower_near_the_ball_joint,
        parameter=f"distance of strut_lower from the ball joint, {PARTS}",
        values=SLOW,
    ),
    Row(put(ROD_END, from_=TOP), "rod-end-near-the-top", FROM_TWO.format("rod"), parameter=ROD_FROM_TOP),
    Row(
        put(ROD_END, from_=TOP, times=lambda off, value: -value * off),
        "rod-end-beyond-the-top",
        "The rod's end is drawn above the top, by less and less.",
        parameter=ROD_FROM_TOP,
    ),
    Row(
        put("wheel_axis_inner", from_="wheel_centre"),
        "spin-axis-short",
        FROM_TWO.format("wheel's spin axis"),
        parameter=f"distance of its inner point from the wheel centre, {PARTS}",
    ),
    Row(
        aside(ROD_END, (1.0, 0.0, 0.0)),
        "rod-end-off-the-axis",
        "The drawing has the rod's end beside the axis, so it does not close.",
        *(False, "distance of the rod's end from the axis, mm", RIGHT),
    ),
    Row(
        aside(INNER, (0.6, 0.0, 0.8)),
        "rack-joint-off-its-line",
        "The drawing has the tie rod's inner end beside the line of the rack, so it does not close.",
        *(False, "distance of the tie rod's inner end from that line, mm", RIGHT),
    ),
    Row(
        slide_drawn_run_out,
        parameter="what the axis is off a right angle to the line from top to ball joint, rad",
        expected=Expected(("right", "refused"), right_from=1e-6),
    ),
)

Table = tuple[Callable[[Row, Subject, float], Content], str, Expected, str, Values, tuple[Row, ...]]
BESIDE_GROUP, DISTANCE = (
    "The strut's axis beside the ball joint",
    "distance, in parts of what it is in the car",
)
NEAR = (near, "Points nearly in line or nearly coincident", SOLVED)
OUT_OF_PROPORTION = (mixed, "Far from the origin, and mixed sizes", MIXED)
# Motion, group, what has to come, car, values, ways to draw it.
TABLES: tuple[Table, ...] = (
    (near, BESIDE_GROUP, SOLVED, "beside", VALUES, BESIDE_ROWS),
    (*NEAR, "paper", VALUES, _of_every_car(LOWER)),
    (*NEAR, "paper", SLOW, OF_STRUT),
    (*NEAR, "wishbone", SLOW, (*_of_every_car(UPPER_BALL), *OF_WISHBONE)),
    (*OUT_OF_PROPORTION, "wishbone", SLOW, WISHBONE_MIXED),
    (*OUT_OF_PROPORTION, "paper", SLOW, PAPER_MIXED),
    (*OUT_OF_PROPORTION, "beside", SLOW, BESIDE_MIXED),
    (*OUT_OF_PROPORTION, "paper", SLOW, (AT_THE_STRUT,)),
)


def _cases() -> Iterator[Case]:
    for motion, group, expected, car, values, rows in TABLES:
        usual = "how long it is in the car over how long it is" if motion is mixed else DISTANCE
        for row in rows:
            yield case(
                partial(motion, row),
                row.parameter or usual,
                row.values or values,
                row.expected or expected,
                NAMED[car],
                name=row.name or hyphens(whole(row.draw).__name__),
                why=row.why or reason_of(row.draw),
                suffix="" if group == BESIDE_GROUP else None,
                group=group,
            )


CASES = tuple(_cases())
