"""The strut's motion to 50 digits: circle, quadratic and A cos + B sin = C, with two derivatives over time.

The coordinates given are taken as they are, to the last binary digit: they are the drawing.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import cos, mp, mpf, sign, sin, sqrt
from numpy.typing import NDArray

DIGITS = 50
Drawing = Mapping[str, Any]


@dataclass(frozen=True)
class Jet:
    """A number and its first and second derivative over time."""

    x: Any
    v: Any
    a: Any

    def __add__(self, other: "Jet") -> "Jet":
        return Jet(self.x + other.x, self.v + other.v, self.a + other.a)

    def __sub__(self, other: "Jet") -> "Jet":
        return Jet(self.x - other.x, self.v - other.v, self.a - other.a)

    def __mul__(self, o: "Jet") -> "Jet":
        return Jet(self.x * o.x, self.v * o.x + self.x * o.v, self.a * o.x + 2 * self.v * o.v + self.x * o.a)

    def root(self) -> "Jet":
        r = sqrt(self.x)
        r1 = self.v / (2 * r)
        return Jet(r, r1, (self.a / 2 - r1 * r1) / r)

    def inverse(self) -> "Jet":
        i = 1 / self.x
        return Jet(i, -self.v * i * i, (2 * self.v * self.v * i - self.a) * i * i)

    def cosine(self) -> "Jet":
        c, s = cos(self.x), sin(self.x)
        return Jet(c, -s * self.v, -c * self.v**2 - s * self.a)


Vector = tuple[Jet, Jet, Jet]


@dataclass(frozen=True)
class Moving:
    """Exact motion at one instant.

    Attributes:
        points: the moving points. spins: (w, w') by body, each three numbers.
        margins: how far from their limits arm, slide and tie rod are, 0 to 1.
    """

    points: dict[str, Vector]
    spins: dict[str, tuple[list[Any], list[Any]]]
    margins: tuple[Any, Any, Any]


def moving_form(p: Drawing, angle: Sequence[float], rack: Sequence[float], closure: str) -> Moving | None:
    """Motion for value, rate and acceleration of both inputs; None beyond a limit."""
    with mp.workdps(DIGITS):
        return _moving(p, Jet(*map(mpf, angle)), Jet(*map(mpf, rack)), closure)


def _moving(p: Drawing, angle: Jet, rack: Jet, closure: str) -> Moving | None:
    drawn = {name: fixed(point) for name, point in p.items()}
    up, right = fixed((0, 0, 1)), fixed((0, 1, 0))
    front, top, ball, outer = (
        drawn[n] for n in ("lower_arm_front", "strut_top", "lower_ball_joint", "tie_rod_outer")
    )
    # The ball joint on its circle about the arm axis, at the height of the arm angle.
    axis, arm = unit(less(drawn["lower_arm_rear"], front)), less(ball, front)
    sideways = unit(cross(axis, up))
    upward = cross(sideways, axis)
    along, radius = dot(axis, arm), length(cross(axis, arm))
    rise = (length(arm) * angle.cosine() - along * dot(axis, up)) * (radius * dot(upward, up)).inverse()
    if abs(rise.x) >= 1:
        return None
    beside = side(dot(arm, sideways)) * (number(1) - rise * rise).root()
    new_ball = plus(front, (along, axis), (radius * rise, upward), (radius * beside, sideways))
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
    inner = plus(drawn["rack_centre"], (number(-1) * rack, right))
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
    # The cross at the rack keeps the tie rod's second pin at a right angle to the first, which is still.
    drawn_rod = unit(rod)
    choices = (up, cross(right, up), right)
    still = unit(cross(drawn_rod, min(choices, key=lambda way: abs(dot(way, drawn_rod).x))))
    tie = unit(less(new_outer, inner))
    unmoved = fixed((1, 0, 0)), fixed((0, 1, 0)), fixed((0, 0, 1))
    knuckle = spin((carry(unmoved[0]), carry(unmoved[1]), carry(unmoved[2])))
    spins = {
        "lower_arm": spin(axes(axis, less(new_ball, front))),
        "knuckle": knuckle,
        "strut_rod": knuckle,
        "tie_rod": spin(axes(tie, cross(tie, still))),
        "rack": ([mpf(0)] * 3, [mpf(0)] * 3),
    }
    margins = 1 - abs(rise.x), slide.x / dot(sight, sight).x, 1 - abs(cosine.x)
    return Moving(points, spins, margins)


def drawn_inputs(p: Drawing) -> tuple[float, float]:
    """Arm angle and rack of the drawing, rounded once."""
    with mp.workdps(DIGITS):
        arm = [mpf(b) - mpf(a) for a, b in zip(p["lower_arm_front"], p["lower_ball_joint"], strict=True)]
        slide = mpf(p["rack_centre"][1]) - mpf(p["tie_rod_inner"][1])
        return float(mp.acos(arm[2] / sqrt(sum(x * x for x in arm)))), float(slide)


def errors_of(exact: Sequence[Any], found: Sequence[float]) -> NDArray[np.float64]:
    """|exact - found| for each of three numbers."""
    with mp.workdps(DIGITS):
        return np.array([float(abs(a - mpf(float(b)))) for a, b in zip(exact, found, strict=True)])


def number(value: Any) -> Jet:
    return Jet(mpf(value), mpf(0), mpf(0))


def side(value: Jet) -> Jet:
    return number(sign(value.x))


def fixed(values: Sequence[float]) -> Vector:
    x, y, z = (number(float(value)) for value in values)
    return x, y, z


NOTHING = fixed((0, 0, 0))


def less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def plus(start: Vector, *parts: tuple[Jet, Vector]) -> Vector:
    x, y, z = start
    for share, (u, v, w) in parts:
        x, y, z = x + share * u, y + share * v, z + share * w
    return x, y, z


def dot(a: Vector, b: Vector) -> Jet:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def length(a: Vector) -> Jet:
    return dot(a, a).root()


def unit(a: Vector) -> Vector:
    shrink = length(a).inverse()
    return a[0] * shrink, a[1] * shrink, a[2] * shrink


def axes(line: Vector, other: Vector) -> tuple[Vector, Vector, Vector]:
    x = unit(plus(other, (number(-1) * dot(other, line), line)))
    return x, cross(line, x), line


def spin(frame: tuple[Vector, Vector, Vector]) -> tuple[list[Any], list[Any]]:
    """w and w' of a frame: half the sum of its axes times their first and second derivatives."""

    def half(part: str) -> list[Any]:
        total = [mpf(0)] * 3
        for a in frame:
            x, d = [c.x for c in a], [getattr(c, part) for c in a]
            for k in range(3):
                total[k] += (x[k - 2] * d[k - 1] - x[k - 1] * d[k - 2]) / 2
        return total

    return half("v"), half("a")
