"""The double wishbone's motion to 50 digits: a circle and twice three spheres, with two time derivatives.

The coordinates given are taken as they are, to the last binary digit: they are the drawing.
"""

from collections.abc import Sequence
from itertools import product
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
    less,
    number,
    plus,
    side,
    spin,
    unit,
)
from mpmath import mp, mpf
from strut_motion import RIGHT, arm_end

# Signs of an assembly against those of the drawing: lower ball joint, upper ball joint, tie rod.
Signs = tuple[int, int, int]
AS_DRAWN: Signs = (1, 1, 1)
ASSEMBLIES: list[Signs] = [(a, b, c) for a, b, c in product((1, -1), repeat=3)]


def wishbone_motion(
    p: Drawing, angle: Sequence[float], rack: Sequence[float], signs: Signs = AS_DRAWN
) -> Moving | None:
    """Motion for value, rate and acceleration of both inputs; None beyond a limit."""
    with mp.workdps(DIGITS):
        return _moving(p, Jet(*map(mpf, angle)), Jet(*map(mpf, rack)), signs)


def three_spheres(centres: Sequence[Vector], squares: Sequence[Jet], sign: Jet) -> tuple[Vector, Any] | None:
    """The point whose squared distances from three centres a, b, c are given, on the side of their plane to
    which  sign (b - a) x (c - a)  points; how far it is from the plane, as a share of its distance from a.
    """
    first, a, b = centres[0], less(centres[1], centres[0]), less(centres[2], centres[0])
    # |x|^2 = s0, |x - a|^2 = s1, |x - b|^2 = s2 give a . x and b . x, and these its part in the plane.
    along_a = (dot(a, a) + squares[0] - squares[1]) * number(0.5)
    along_b = (dot(b, b) + squares[0] - squares[2]) * number(0.5)
    aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
    shrink = (aa * bb - ab * ab).inverse()
    in_plane = plus(
        NOTHING,
        ((bb * along_a - ab * along_b) * shrink, a),
        ((aa * along_b - ab * along_a) * shrink, b),
    )
    rest = squares[0] - dot(in_plane, in_plane)
    if rest.x <= 0:
        return None
    share = mp.sqrt(rest.x / squares[0].x)
    return plus(plus(first, (number(1), in_plane)), (sign * rest.root(), unit(cross(a, b)))), share


def square(a: Vector, b: Vector) -> Jet:
    """Squared distance."""
    return dot(less(a, b), less(a, b))


def beside(centres: Sequence[Vector], point: Vector) -> Jet:
    """On which side of the plane of three centres a point is: 1 or -1."""
    normal = cross(less(centres[1], centres[0]), less(centres[2], centres[0]))
    return side(dot(normal, less(point, centres[0])))


def _moving(p: Drawing, angle: Jet, rack: Jet, signs: Signs) -> Moving | None:
    drawn = {name: fixed(point) for name, point in p.items()}
    ball, top, outer = (drawn[n] for n in ("lower_ball_joint", "upper_ball_joint", "tie_rod_outer"))
    pivots = drawn["upper_arm_front"], drawn["upper_arm_rear"]
    arm = arm_end(drawn, angle, signs[0])
    if arm is None:
        return None
    new_ball, axis, arm_margin = arm
    upper = three_spheres(
        (new_ball, *pivots),
        (square(top, ball), *(square(top, pivot) for pivot in pivots)),
        number(signs[1]) * beside((ball, *pivots), top),
    )
    if upper is None:
        return None
    new_top, upper_margin = upper
    inner = plus(drawn["rack_centre"], (number(-1) * rack, RIGHT))
    ends = ball, top, drawn["tie_rod_inner"]
    steered = three_spheres(
        (new_ball, new_top, inner),
        tuple(square(outer, end) for end in ends),
        number(signs[2]) * beside(ends, outer),
    )
    if steered is None:
        return None
    new_outer, tie_rod_margin = steered
    # The knuckle carries the rest.
    old = axes(unit(less(top, ball)), less(outer, ball))
    new = axes(unit(less(new_top, new_ball)), less(new_outer, new_ball))

    def carry(vector: Vector) -> Vector:
        return plus(NOTHING, *((dot(a, vector), b) for a, b in zip(old, new, strict=True)))

    points = {
        "lower_ball_joint": new_ball,
        "upper_ball_joint": new_top,
        "tie_rod_outer": new_outer,
        "tie_rod_inner": inner,
        **{
            name: plus(new_ball, (number(1), carry(less(drawn[name], ball))))
            for name in ("wheel_axis_inner", "wheel_centre")
        },
    }
    upper_axis = unit(less(pivots[1], pivots[0]))
    unmoved = fixed((1, 0, 0)), fixed((0, 1, 0)), fixed((0, 0, 1))
    spins = {
        "lower_arm": spin(axes(axis, less(new_ball, drawn["lower_arm_front"]))),
        "upper_arm": spin(axes(upper_axis, less(new_top, pivots[0]))),
        "knuckle": spin((carry(unmoved[0]), carry(unmoved[1]), carry(unmoved[2]))),
    }
    return Moving(points, spins, (arm_margin, upper_margin**2, tie_rod_margin**2))
