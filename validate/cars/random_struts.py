"""How a random strut is drawn, for random cars by number and for property-based searches alike.

Free points lie up to two hundred millimetres from the paper's in every coordinate, which changes link lengths
and proportions by half; the wheel stays outboard of the strut's top, and a tie rod lies behind the ball
joint or ahead of it. A drawn strut closes: its ball joint lies up to 120 mm beside the strut's axis, now and
then on it or all but on it; what belongs on a line is there to rounding, or to what a drawing leaves. The
inner points of a collinear strut lie near its line, but not on it: its two halves are bent by up to 8 degrees
each, as in the paper's own Table 1.

Everything is drawn by one function, `uniform(low, high)`, so that a generator of numbers or a search for
examples can be behind it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from validate.cars.closed_form import Closure
from validate.cars.paper_car import PAPER

Array = NDArray[np.float64]
Uniform = Callable[[float, float], float]
Drawing = dict[str, Array]

REACH = 200.0  # mm, from the paper's points
BESIDE = 120.0  # mm: a real ball joint lies 20 to 90 mm beside the axis
LEFT_OVER = 0.05  # mm, by which a drawn point may miss its line: half of what is warned of
OUTBOARD = 20.0  # mm, of the strut's top, at least
FINE = 8.0  # steps of a millimetre: few enough bits that a share of them is exact
FREE = ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top", "lower_ball_joint", "tie_rod_outer")


def random_drawing(
    uniform: Uniform, closure: Closure, reach: float = REACH, left_over: float = LEFT_OVER
) -> Drawing:
    """A left-hand strut in the paper's axes, mm.

    Args:
        reach: how far free points lie from the paper's.
        left_over: by how much points of a drawn strut may miss the lines that they belong on.
    """
    points = {name: np.array(PAPER[name]) + _vector(uniform, reach) for name in (*FREE, "wheel_centre")}
    top, ball = points["strut_top"], points["lower_ball_joint"]
    points["wheel_centre"][1] = min(points["wheel_centre"][1], top[1] - OUTBOARD)
    if uniform(0.0, 1.0) < 0.5:
        for name in ("tie_rod_outer", "rack_centre"):
            points[name][0] = 2.0 * ball[0] - points[name][0]
    if closure == "collinear":
        return points | _bent_strut(uniform, top, ball) | _inner(points["rack_centre"], _vector(uniform, 5.0))
    if uniform(0.0, 1.0) < 0.1:
        points |= _strut_through_ball_joint(uniform, top, ball)
    elif uniform(0.0, 1.0) < 0.2:
        points |= _strut_beside(uniform, top, ball, 500.0 * 10.0 ** uniform(-12.0, -3.0))
    else:
        points |= _strut_beside(uniform, top, ball, uniform(0.0, BESIDE))
    points |= _inner(points["rack_centre"], np.array([0.0, uniform(-5.0, 5.0), 0.0]))
    if uniform(0.0, 1.0) < 0.2:
        del points["rack_centre"]
    elif uniform(0.0, 1.0) < 0.3:
        points["tie_rod_inner"] += _vector(uniform, left_over)
    if uniform(0.0, 1.0) < 0.3:
        points["strut_rod_end"] += _vector(uniform, left_over)
    if uniform(0.0, 1.0) < 0.4:
        inwards = np.array([uniform(-20.0, 20.0), uniform(50.0, 150.0), uniform(-20.0, 20.0)])
        points["wheel_axis_inner"] = points["wheel_centre"] + inwards
    return points


def with_slide_that_runs_out(uniform: Uniform, drawn: Drawing) -> Drawing:
    """The strut's axis turned about its top until the ball joint lies far beside it."""
    top, ball = drawn["strut_top"], drawn["lower_ball_joint"]
    sine = uniform(0.5, 0.95)
    # A point so far beside the ball joint that the line to the top passes it at this share of their distance.
    beside = float(np.linalg.norm(top - ball)) * sine / math.sqrt(1.0 - sine * sine)
    return drawn | _strut_beside(uniform, top, ball, beside)


def _bent_strut(uniform: Uniform, top: Array, ball: Array) -> Drawing:
    points, length = {}, float(np.linalg.norm(ball - top))
    for name, low, high in (("strut_lower", 0.55, 0.95), ("strut_rod_end", 0.2, 0.5)):
        place = uniform(low, high)
        nearer = min(place, 1.0 - place) * length
        points[name] = top + place * (ball - top) + 0.08 * nearer * _vector(uniform, 1.0)
    return points


def _strut_beside(uniform: Uniform, top: Array, ball: Array, beside: float) -> Drawing:
    """An axis from the top past the ball joint, `beside` from it measured across the line to the top."""
    along = (top - ball) / np.linalg.norm(top - ball)
    first = np.cross(along, (1.0, 0.0, 0.0))
    first /= np.linalg.norm(first)
    turn = uniform(-math.pi, math.pi)
    foot = ball + beside * (math.cos(turn) * first + math.sin(turn) * np.cross(along, first))
    lower, rod_end = _places(uniform)
    return {"strut_lower": foot + lower * (top - foot), "strut_rod_end": top + rod_end * (foot - top)}


def _strut_through_ball_joint(uniform: Uniform, top: Array, ball: Array) -> Drawing:
    """All four points on one line, to the last bit."""
    near, far = (np.round(FINE * place) / FINE for place in (top, ball))
    lower, rod_end = (round(64.0 * share) / 64.0 for share in _places(uniform))
    return {
        "strut_top": near,
        "lower_ball_joint": far,
        "strut_lower": far + lower * (near - far),
        "strut_rod_end": near + rod_end * (far - near),
    }


def _places(uniform: Uniform) -> tuple[float, float]:
    """strut_lower from the foot towards the top, the rod end from the top to the foot, in parts of the way.

    One in seven strut_lower is below the ball joint, one in twenty rod ends beyond the top.
    """
    lower = uniform(0.05, 0.45) * (-1.0 if uniform(0.0, 1.0) < 0.15 else 1.0)
    return lower, uniform(-0.3, -0.05) if uniform(0.0, 1.0) < 0.05 else uniform(0.2, 0.5)


def _inner(centre: Array, slid: Array) -> Drawing:
    return {"tie_rod_inner": centre + slid}


def _vector(uniform: Uniform, reach: float) -> Array:
    return np.array([uniform(-reach, reach) for _ in range(3)])


def placed(rng: np.random.Generator, drawn: Drawing) -> tuple[Drawing, Array, Array, float]:
    """The car scaled, turned and moved, each in one of two: points, up, right, and the scale."""
    scale = 10.0 ** rng.uniform(-3.0, 3.0) if rng.random() < 0.5 else 1.0
    turn = np.eye(3)
    if rng.random() < 0.5:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn = turn * np.sign(np.linalg.det(turn))
    away = np.zeros(3)
    if rng.random() < 0.5:
        away = rng.normal(size=3)
        away *= scale * 10.0 ** rng.uniform(0.0, 7.0) / np.linalg.norm(away)
    points = {name: turn @ place * scale + away for name, place in drawn.items()}
    return points, turn @ (0.0, 0.0, 1.0), turn @ (0.0, 1.0, 0.0), scale


def as_tuples(points: Drawing) -> dict[str, tuple[float, float, float]]:
    """Plain numbers, as a scene has them."""
    return {name: as_tuple(place) for name, place in points.items()}


def as_tuple(vector: Array) -> tuple[float, float, float]:
    """The three numbers of a vector."""
    x, y, z = (float(component) for component in vector)
    return x, y, z
