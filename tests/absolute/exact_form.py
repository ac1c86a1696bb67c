"""The strut's pose to 60 digits: the circles and spheres of `closed_form` in exact numbers.

The coordinates given are taken as they are, to the last binary digit: they are the drawing.
"""

from collections.abc import Mapping, Sequence

from mpmath import acos, cos, mp, mpf, sign, sqrt

Vector = tuple[mpf, mpf, mpf]
Points = Mapping[str, Sequence[float]]
DIGITS = 60


def exact_form(points: Points, angle: float, rack: float) -> tuple[dict[str, Vector], mpf] | None:
    """Moving points, mm, and how far from a limit the pose is (0 to 1), or None beyond the limits."""
    with mp.workdps(DIGITS):
        p = {name: vector(point) for name, point in points.items()}
        up, right = vector((0.0, 0.0, 1.0)), vector((0.0, 1.0, 0.0))
        front, top, ball, outer = (
            p[n] for n in ("lower_arm_front", "strut_top", "lower_ball_joint", "tie_rod_outer")
        )
        # The ball joint on its circle about the arm axis, at the height of the arm angle.
        axis, arm = unit(less(p["lower_arm_rear"], front)), less(ball, front)
        sideways = unit(cross(axis, up))
        upward = cross(sideways, axis)
        radius = length(cross(axis, arm))
        height = length(arm) * cos(mpf(angle)) - dot(axis, arm) * dot(axis, up)
        rise = height / (radius * dot(upward, up))
        if abs(rise) >= 1:
            return None
        beside = sign(dot(arm, sideways)) * sqrt(1 - rise**2)
        new_ball = plus(front, (dot(axis, arm), axis), (radius * rise, upward), (radius * beside, sideways))
        # Knuckle and strut rod along the kingpin, in the sense in which they are drawn.
        line = unit(less(p["strut_lower"], ball))
        sense = sign(dot(line, less(top, ball)))
        new_line = unit(less(top, new_ball))
        new_line = plus(vector((0.0, 0.0, 0.0)), (sense, new_line))
        # The tie rod's outer end on its circle about the kingpin and its sphere about the inner end.
        inner = plus(p["rack_centre"], (-mpf(rack), right))
        steer, sight = less(outer, ball), less(inner, new_ball)
        along, reach = dot(steer, line), length(cross(steer, line))
        lift = dot(sight, new_line)
        across = plus(sight, (-lift, new_line))
        far, rod = length(across), length(less(outer, p["tie_rod_inner"]))
        cosine = (reach**2 + far**2 + (along - lift) ** 2 - rod**2) / (2 * reach * far)
        if abs(cosine) >= 1:
            return None
        side = sign(dot(steer, cross(line, less(p["tie_rod_inner"], ball))))
        toward = unit(across)
        turned = (reach * cosine, toward), (reach * side * sqrt(1 - cosine**2), cross(new_line, toward))
        new_outer = plus(new_ball, (along, new_line), *turned)
        # The knuckle carries the wheel centre.
        drawn, placed = axes(line, steer), axes(new_line, less(new_outer, new_ball))
        wheel = less(p["wheel_centre"], ball)
        return {
            "lower_ball_joint": new_ball,
            "tie_rod_outer": new_outer,
            "tie_rod_inner": inner,
            "strut_lower": plus(new_ball, (length(less(p["strut_lower"], ball)), new_line)),
            "strut_rod_end": plus(top, (-length(less(top, p["strut_rod_end"])), new_line)),
            "wheel_centre": plus(
                new_ball, *((dot(old, wheel), new) for old, new in zip(drawn, placed, strict=True))
            ),
        }, min(1 - abs(rise), 1 - abs(cosine))


def drawn_angle(points: Points) -> float:
    """Arm angle of the drawing, rad."""
    with mp.workdps(DIGITS):
        arm = less(vector(points["lower_ball_joint"]), vector(points["lower_arm_front"]))
        return float(acos(arm[2] / length(arm)))


def distance(a: Vector, b: Sequence[float]) -> float:
    """Between an exact and a floating-point place, mm."""
    with mp.workdps(DIGITS):
        return float(length(less(a, vector(b))))


def vector(values: Sequence[float]) -> Vector:
    x, y, z = (mpf(float(value)) for value in values)
    return x, y, z


def less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def plus(start: Vector, *parts: tuple[mpf, Vector]) -> Vector:
    x, y, z = (start[k] + sum(share * part[k] for share, part in parts) for k in range(3))
    return x, y, z


def dot(a: Vector, b: Vector) -> mpf:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def length(a: Vector) -> mpf:
    return sqrt(dot(a, a))


def unit(a: Vector) -> Vector:
    size = length(a)
    return a[0] / size, a[1] / size, a[2] / size


def axes(line: Vector, other: Vector) -> tuple[Vector, Vector, Vector]:
    x = unit(plus(other, (-dot(other, line), line)))
    return x, cross(line, x), line
