"""The strut's motion to 50 digits: circle, quadratic and A cos + B sin = C, with two derivatives over time.

The coordinates given are taken as they are, to the last binary digit: they are the drawing.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from jets import (
    DIGITS,
    NOTHING,
    Drawing,
    Jet,
    Moving,
    Vector,
    axes,
    cross,
    dot,
    fixed,
    length,
    less,
    number,
    plus,
    side,
    spin,
    unit,
)
from mpmath import mp, mpf, sqrt


def strut_motion(p: Drawing, angle: Sequence[float], rack: Sequence[float], closure: str) -> Moving | None:
    """Motion for value, rate and acceleration of both inputs; None beyond a limit."""
    with mp.workdps(DIGITS):
        return _strut(p, Jet(*map(mpf, angle)), Jet(*map(mpf, rack)), closure)


UP, RIGHT = fixed((0, 0, 1)), fixed((0, 1, 0))


def arm_end(drawn: Mapping[str, Vector], angle: Jet, as_drawn: int = 1) -> tuple[Vector, Vector, Any] | None:
    """The lower ball joint on its circle about the arm's axis, at the height of the arm angle; the axis; how
    far it is from the top or bottom of the circle, 0 to 1. None beyond these. At each height there are two
    places: that on the drawn side, or on the other for as_drawn = -1."""
    front, ball = drawn["lower_arm_front"], drawn["lower_ball_joint"]
    axis, arm = unit(less(drawn["lower_arm_rear"], front)), less(ball, front)
    sideways = unit(cross(axis, UP))
    upward = cross(sideways, axis)
    along, radius = dot(axis, arm), length(cross(axis, arm))
    rise = (length(arm) * angle.cosine() - along * dot(axis, UP)) * (radius * dot(upward, UP)).inverse()
    if abs(rise.x) >= 1:
        return None
    beside = number(as_drawn) * side(dot(arm, sideways)) * (number(1) - rise * rise).root()
    new_ball = plus(front, (along, axis), (radius * rise, upward), (radius * beside, sideways))
    return new_ball, axis, 1 - abs(rise.x)


def _strut(p: Drawing, angle: Jet, rack: Jet, closure: str) -> Moving | None:
    drawn = {name: fixed(point) for name, point in p.items()}
    front, top, ball, outer = (
        drawn[n] for n in ("lower_arm_front", "strut_top", "lower_ball_joint", "tie_rod_outer")
    )
    arm = arm_end(drawn, angle)
    if arm is None:
        return None
    new_ball, axis, arm_margin = arm
    # The top mount on the strut axis of the knuckle: |foot + s d| is its distance from the ball joint.
    bottom = ball if closure == "collinear" else drawn["strut_lower"]
    line = unit(less(drawn["strut_lower" if closure == "collinear" else "strut_top"], bottom))
    foot = plus(less(bottom, ball), (number(-1) * dot(less(bottom, ball), line), line))
    sight = less(top, new_ball)
    slide = dot(sight, sight) - dot(foot, foot)
    if slide.x <= 0:
        return None
    mount = plus(foot, (side(dot(line, less(top, ball))) * slide.root(), line))
    kingpin, new_kingpin = unit(mount), unit(sight)
    # The tie rod's outer end on its circle about the kingpin and its sphere about the inner end.
    inner = plus(drawn["rack_centre"], (number(-1) * rack, RIGHT))
    steer, reached = less(outer, ball), less(inner, new_ball)
    height, reach = dot(steer, kingpin), length(cross(steer, kingpin))
    lift = dot(reached, new_kingpin)
    across = plus(reached, (number(-1) * lift, new_kingpin))
    far, rod = length(across), less(outer, drawn["tie_rod_inner"])
    cosine = (reach * reach + far * far + (height - lift) * (height - lift) - dot(rod, rod)) * (
        number(2) * reach * far
    ).inverse()
    if abs(cosine.x) >= 1:
        return None
    pole = line if closure == "collinear" else unit(less(top, ball))
    sense = side(dot(steer, cross(pole, less(drawn["tie_rod_inner"], ball))))
    toward = unit(across)
    turned = (
        (reach * cosine, toward),
        (
            reach * sense * (number(1) - cosine * cosine).root(),
            cross(new_kingpin, toward),
        ),
    )
    new_outer = plus(new_ball, (height, new_kingpin), *turned)
    # The knuckle carries the rest; the rod end is on the strut axis, on its side of the top mount.
    old, new = axes(kingpin, steer), axes(new_kingpin, less(new_outer, new_ball))

    def carry(vector: Vector) -> Vector:
        return plus(NOTHING, *((dot(a, vector), b) for a, b in zip(old, new, strict=True)))

    rod_line = less(top, drawn["strut_rod_end"])
    carried = [n for n in ("strut_lower", "wheel_centre", "wheel_axis_inner") if n in p]
    points = {
        "lower_ball_joint": new_ball,
        "tie_rod_outer": new_outer,
        "tie_rod_inner": inner,
        "strut_rod_end": plus(top, (number(-1) * side(dot(rod_line, line)) * length(rod_line), carry(line))),
        **{name: plus(new_ball, (number(1), carry(less(drawn[name], ball)))) for name in carried},
    }
    unmoved = fixed((1, 0, 0)), fixed((0, 1, 0)), fixed((0, 0, 1))
    knuckle = spin((carry(unmoved[0]), carry(unmoved[1]), carry(unmoved[2])))
    spins = {
        "lower_arm": spin(axes(axis, less(new_ball, front))),
        "knuckle": knuckle,
    }
    margins = arm_margin, slide.x / dot(sight, sight).x, 1 - abs(cosine.x)
    return Moving(points, spins, margins)


def drawn_inputs(p: Drawing) -> tuple[float, float]:
    """Arm angle and rack of the drawing, rounded once."""
    with mp.workdps(DIGITS):
        arm = [mpf(b) - mpf(a) for a, b in zip(p["lower_arm_front"], p["lower_ball_joint"], strict=True)]
        slide = mpf(p["rack_centre"][1]) - mpf(p["tie_rod_inner"][1])
        return float(mp.acos(arm[2] / sqrt(sum(x * x for x in arm)))), float(slide)
