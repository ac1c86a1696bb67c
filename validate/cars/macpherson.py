r"""The MacPherson strut on the cars' side: its closed form, base cars and random drawings.

In the knuckle the strut's axis is fixed: l + s d, with d a unit vector. The strut's top t is on it, as far
from the ball joint b as it is now:

    |l - b + s d| = |t - b|,    s = h +- sqrt(|t - b|^2 - a^2),

with h the foot of the ball joint on the axis and a its distance from it; the sign is that of the drawing. The
collinear strut is the one whose axis passes through the ball joint: a = 0.

A random strut is drawn about the paper's. Free points lie up to two hundred millimetres from the paper's in
every coordinate, which changes link lengths and proportions by half; the wheel stays outboard of the strut's
top, and a tie rod lies behind the ball joint or ahead of it. A drawn strut closes: its ball joint lies up to
120 mm beside the strut's axis, now and then on it or all but on it; what belongs on a line is there to
rounding, or to what a drawing leaves. The inner points of a collinear strut lie near its line, but not on
it: its two halves are bent by up to 8 degrees each, as in the paper's own Table 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from validate.cars import random_parts as parts
from validate.cars.arithmetic import Array, dot, length, root, sign, unit
from validate.cars.car import Car, Closure, Drawing, Uniform, random_vector
from validate.cars.closed_form import BALL, FRONT, INNER, OUTER, RACK, REAR, ClosedForm, Kingpin
from validate.cars.paper_car import PAPER
from validate.cars.suspension import Suspension

TOP, LOWER, ROD_END = "strut_top", "strut_lower", "strut_rod_end"
STRUT = "strut"

# The paper's car with the axis of its strut 37 mm inboard of the ball joint, in whole millimetres and exactly
# in line, and the spin axis of its wheel drawn by itself.
BESIDE = PAPER | {
    LOWER: (452.0, -270.0, 60.0),
    ROD_END: (456.0, -225.0, 265.0),
    "wheel_axis_inner": (452.0, -330.0, 22.0),
}


@dataclass(frozen=True)
class StrutForm(ClosedForm):
    """A strut with what its drawing fixes.

    Attributes:
        axis: direction of the strut's axis as drawn, towards its top.
        foot: of the ball joint on the axis, drawn from the ball joint.
        rod_end: how far the rod's end lies beyond the top, along the axis.
        slide_side: sign of the drawing: on which side of that foot the top is.
    """

    axis: Array
    foot: Array
    rod_end: Any
    slide_side: int

    chassis = (FRONT, REAR, RACK, TOP)
    knuckle = (BALL, OUTER, LOWER, "wheel_centre", "wheel_axis_inner")

    @classmethod
    def own_of(cls, p: Mapping[str, Array], car: Car) -> tuple[dict[str, Any], Array]:
        """The axis in the knuckle; the kingpin of a collinear strut is drawn along the knuckle's own line."""
        ball, top, lower, beyond = p[BALL], p[TOP], p[LOWER], p[ROD_END] - p[TOP]
        if car.closure == "drawn":
            axis = unit(top - lower)
            foot = lower - ball + dot(ball - lower, axis)[..., None] * axis
            leaning, slid, side = top - ball, axis, sign(dot(top - ball, axis))
        else:
            axis = sign(dot(lower - ball, top - ball)) * unit(lower - ball)
            foot = np.zeros_like(ball)
            leaning, slid, side = axis, top - ball, 1
        rod_end = sign(dot(beyond, slid)) * length(beyond)
        return {"axis": axis, "foot": foot, "rod_end": rod_end, "slide_side": side}, leaning

    def kingpin(self, angle: ArrayLike) -> Kingpin:
        """The line from ball joint to top.

        Its `spare` says how far the slide is from running out, (r^2 - a^2) / r^2.
        """
        ball = self.ball_joint(angle)
        strut = self.p[TOP] - ball
        squared, beside = dot(strut, strut), dot(self.foot, self.foot)
        slid = self.slide_side * root(squared - beside)
        in_knuckle = unit(self.foot + slid[..., None] * self.axis)
        return Kingpin(ball, unit(strut), in_knuckle, np.asarray((squared - beside) / squared))

    def of_upper_end(self, turned: Callable[[Array], Array]) -> dict[str, Array]:
        """The rod's end, on the axis as the knuckle is turned."""
        return {ROD_END: self.p[TOP] + self.rod_end * turned(self.axis)}


BESIDE_MOST = 120.0  # mm: a real ball joint lies 20 to 90 mm beside the axis
OUTBOARD = 20.0  # mm, of the strut's top, at least
FINE = 8.0  # steps of a millimetre: few enough bits that a share of them is exact
FREE = (FRONT, REAR, RACK, TOP, BALL, OUTER, "wheel_centre")


def random_strut(uniform: Uniform, closure: Closure, reach: float, left_over: float) -> Drawing:
    """A left-hand strut (see `suspension.RandomDrawing`)."""
    points = parts.steered_from_ahead(uniform, parts.free_points(uniform, PAPER, FREE, reach))
    top, ball = points[TOP], points[BALL]
    points["wheel_centre"][1] = min(points["wheel_centre"][1], top[1] - OUTBOARD)
    if closure == "collinear":
        inner = points[RACK] + random_vector(uniform, parts.SLID)
        return points | _bent_strut(uniform, top, ball) | {INNER: inner}
    if uniform(0.0, 1.0) < 0.1:
        points |= _strut_through_ball_joint(uniform, top, ball)
    elif uniform(0.0, 1.0) < 0.2:
        points |= _strut_beside(uniform, top, ball, 500.0 * 10.0 ** uniform(-12.0, -3.0))
    else:
        points |= _strut_beside(uniform, top, ball, uniform(0.0, BESIDE_MOST))
    points = parts.with_rack(uniform, points, left_over)
    if uniform(0.0, 1.0) < 0.3:
        points[ROD_END] = points[ROD_END] + random_vector(uniform, left_over)
    if uniform(0.0, 1.0) < 0.4:
        points |= parts.spin_axis(uniform, points["wheel_centre"])
    return points


def with_slide_that_runs_out(uniform: Uniform, drawn: Drawing) -> Drawing:
    """The strut's axis turned about its top until the ball joint lies far beside it."""
    top, ball = drawn[TOP], drawn[BALL]
    sine = uniform(0.5, 0.95)
    # A point so far beside the ball joint that the line to the top passes it at this share of their distance.
    beside = float(np.linalg.norm(top - ball)) * sine / math.sqrt(1.0 - sine * sine)
    return drawn | _strut_beside(uniform, top, ball, beside)


def _bent_strut(uniform: Uniform, top: Array, ball: Array) -> Drawing:
    points, reach = {}, float(np.linalg.norm(ball - top))
    for name, low, high in ((LOWER, 0.55, 0.95), (ROD_END, 0.2, 0.5)):
        place = uniform(low, high)
        nearer = min(place, 1.0 - place) * reach
        points[name] = top + place * (ball - top) + 0.08 * nearer * random_vector(uniform, 1.0)
    return points


def _strut_beside(uniform: Uniform, top: Array, ball: Array, beside: float) -> Drawing:
    """An axis from the top past the ball joint, `beside` from it measured across the line to the top."""
    along = unit(top - ball)
    first = unit(np.cross(along, (1.0, 0.0, 0.0)))
    turn = uniform(-math.pi, math.pi)
    foot = ball + beside * (math.cos(turn) * first + math.sin(turn) * np.cross(along, first))
    lower, rod_end = _places(uniform)
    return {LOWER: foot + lower * (top - foot), ROD_END: top + rod_end * (foot - top)}


def _strut_through_ball_joint(uniform: Uniform, top: Array, ball: Array) -> Drawing:
    """All four points on one line, to the last bit."""
    near, far = (np.round(FINE * place) / FINE for place in (top, ball))
    lower, rod_end = (round(64.0 * share) / 64.0 for share in _places(uniform))
    return {TOP: near, BALL: far, LOWER: far + lower * (near - far), ROD_END: near + rod_end * (far - near)}


def _places(uniform: Uniform) -> tuple[float, float]:
    """strut_lower from the foot towards the top, the rod end from the top to the foot, in parts of the way.

    One in seven strut_lower is below the ball joint, one in twenty rod ends beyond the top.
    """
    lower = uniform(0.05, 0.45) * (-1.0 if uniform(0.0, 1.0) < 0.15 else 1.0)
    return lower, uniform(-0.3, -0.05) if uniform(0.0, 1.0) < 0.05 else uniform(0.2, 0.5)


def _slide_nearly_out(rng: np.random.Generator, points: Drawing, left: float) -> Drawing:
    """The axis at a right angle to the line from the top to the ball joint, but for this."""
    down = unit(points[BALL] - points[TOP])
    axis = unit(unit(np.cross(down, rng.normal(size=3))) + left * down)
    return points | {LOWER: points[TOP] + 400.0 * axis, ROD_END: points[TOP] + 150.0 * axis}


NEARLY = {
    "dead arm": parts.dead_arm,
    "toggle": parts.flat_tie_rod(TOP),
    "thin knuckle": parts.thin_knuckle(TOP),
}

MACPHERSON = Suspension(
    name="macpherson",
    form=StrutForm,
    base={"drawn": Car(BESIDE), "collinear": Car(PAPER, closure="collinear")},
    drawing=random_strut,
    kingpin=(BALL, TOP),
    links=((FRONT, BALL), (BALL, OUTER), (OUTER, LOWER), (OUTER, INNER), (LOWER, BALL)),
    upper_lock=STRUT,
    with_arm_lock=lambda uniform, drawn: drawn,
    with_upper_lock=with_slide_that_runs_out,
    # A collinear strut's knuckle is drawn about its own line, which its top need not lie on.
    sides={"drawn": {"tie": (BALL, TOP, INNER, OUTER)}, "collinear": {"tie": (BALL, LOWER, INNER, OUTER)}},
    nearly_singular={
        "drawn": {
            name: parts.without_rack_centre(nearly)
            for name, nearly in (NEARLY | {"slide": _slide_nearly_out}).items()
        },
        "collinear": NEARLY,
    },
)
