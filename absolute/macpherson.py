"""The MacPherson strut, described as data: its axis as drawn, or through the lower ball joint."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from absolute.description import Axis, Carried, Input, Joint, Model, Side, Vector, point_of, vector_of
from absolute.errors import DescriptionError

BODIES = {
    "chassis": ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"),
    "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
    "knuckle": ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre"),
    "strut_rod": ("strut_top", "strut_rod_end"),
    "tie_rod": ("tie_rod_outer", "tie_rod_inner"),
    "rack": ("tie_rod_inner",),
}
# In an order of its own: it is that of a sum, and so of the digits.
POINTS = tuple(dict.fromkeys(point for names in BODIES.values() for point in names))
# Where nothing is drawn: the rack's line passes through the drawn end of the tie rod; no spin axis is kept.
DEFAULTS = {"rack_centre": "tie_rod_inner"}
CARRIED = ("wheel_axis_inner",)
OPTIONAL = (*DEFAULTS, *CARRIED)
CLOSURES = ("drawn", "collinear")

# `up` and `right` are axes of one car. 1e-6 rad lets rounded directions pass and stops wrong ones.
LARGEST_SKEW = 1e-6

ARM_LINKS = ("link lower_ball_joint - lower_arm_front", "link lower_ball_joint - lower_arm_rear")
TIE_ROD = ("link tie_rod_inner - tie_rod_outer",)
STRUT = ("strut axis",)


def macpherson(
    points: Mapping[str, Sequence[float]],
    *,
    up: Sequence[float] = (0.0, 0.0, 1.0),
    right: Sequence[float] = (0.0, 1.0, 0.0),
    closure: str = "drawn",
) -> Model:
    """A MacPherson strut with the inputs `arm_angle` (rad) and `rack` (mm).

    (lower_ball_joint - lower_arm_front) . up = d cos(arm_angle), d their drawn distance (eq. 12);
    tie_rod_inner = rack_centre - rack * right (eqs. 13-15). The strut rod slides in the knuckle and
    does not turn in it. A tie rod may spin about its own line without any effect; here its ball at
    the rack is a universal joint, so its angular velocity along that line is a convention.

    The rod's line, strut_rod_end to strut_top, slides along an axis of the knuckle:
        "drawn"      strut_lower to strut_top as drawn, wherever the lower ball joint is;
        "collinear"  lower_ball_joint to strut_lower (the paper's strut, eqs. 1-11).

    Args:
        points: those named in POINTS and OPTIONAL, mm. `rack_centre` is the drawn tie_rod_inner and
            the knuckle carries no `wheel_axis_inner` where they are not given.
        up, right: where the car's up and right point in the frame of the points; any length.
        closure: one of CLOSURES.
    Raises:
        DescriptionError: a point is missing, unknown, not finite or beyond LARGEST_COORDINATE; the
            closure is unknown; up and right are no directions at a right angle; points that make an
            axis coincide.
    """
    if closure not in CLOSURES:
        raise DescriptionError(
            f"closure is {closure!r}; it must be one of {list(CLOSURES)}", "closure", closure
        )
    drawn = _drawn(points)
    upward, rightward = (
        _unit("up", vector_of("up", "up", up)),
        _unit("right", vector_of("right", "right", right)),
    )
    skew = float(upward @ rightward)
    if abs(skew) > LARGEST_SKEW:
        raise DescriptionError(
            f"up and right are {np.degrees(np.arccos(skew)):.6g} degrees apart; a right angle is needed",
            "right",
            skew,
        )
    along = _between(drawn, "tie_rod_inner", "tie_rod_outer")
    # Pins of the cross at right angles to the tie rod, made from the car's axis it is least along,
    # so that they turn with the car.
    sideways = min(
        (upward, np.cross(rightward, upward), rightward), key=lambda axis: abs(float(axis @ along))
    )
    pin_of_rack = _unit("tie_rod", _plain(np.cross(along, sideways)))
    pin_of_rod = np.cross(along, pin_of_rack)
    _between(drawn, "lower_arm_front", "lower_ball_joint")
    # Without the squares of a norm, which are zero for the smallest numbers.
    arm_length = math.hypot(*(drawn["lower_ball_joint"] - drawn["lower_arm_front"]).tolist())
    arm_axis = Axis("lower_arm_front", "lower_arm_rear")
    ball = Axis("lower_ball_joint")
    slide = _plain(rightward)
    joints = {
        "arm_pivot": Joint("revolute", "chassis", "lower_arm", arm_axis, arm_axis),
        "lower_ball": Joint("spherical", "lower_arm", "knuckle", ball, ball),
        "strut": Joint("prismatic", "knuckle", "strut_rod", *_strut_axes(drawn, closure)),
        "top_mount": Joint("spherical", "chassis", "strut_rod", Axis("strut_top"), Axis("strut_top")),
        "tie_rod_outer_ball": Joint(
            "spherical", "knuckle", "tie_rod", Axis("tie_rod_outer"), Axis("tie_rod_outer")
        ),
        "tie_rod_inner_cross": Joint(
            "universal",
            "rack",
            "tie_rod",
            Axis("tie_rod_inner", _plain(pin_of_rack)),
            Axis("tie_rod_inner", _plain(pin_of_rod)),
        ),
        "rack_slide": Joint(
            "prismatic", "chassis", "rack", Axis("rack_centre", slide), Axis("tie_rod_inner", slide)
        ),
    }
    inputs = {
        "arm_angle": Input(
            "chassis",
            Axis("lower_arm_front", _plain(upward)),
            "lower_arm",
            "lower_ball_joint",
            "cosine",
            arm_length,
        ),
        "rack": Input("chassis", Axis("rack_centre", slide), "rack", "tie_rod_inner", "linear", -1.0),
    }
    carried = tuple(name for name in CARRIED if name in drawn)
    bodies = {**BODIES, "knuckle": (*BODIES["knuckle"], *carried)}
    drawn_points = {name: _plain(place) for name, place in drawn.items()}
    return Model(drawn_points, "chassis", bodies, joints, inputs, _sides(_plain(upward), closure))


def _drawn(points: Mapping[str, Sequence[float]]) -> dict[str, np.ndarray]:
    missing = sorted(set(POINTS) - set(points) - set(OPTIONAL))
    unknown = sorted(set(points) - set(POINTS) - set(OPTIONAL))
    if missing or unknown:
        needed = [name for name in POINTS if name not in OPTIONAL]
        raise DescriptionError(
            f"a MacPherson strut has the points {needed} and, if wanted, {list(OPTIONAL)}; "
            f"missing: {missing}, unknown: {unknown}",
            (missing or unknown)[0],
        )
    given = {**{name: points[source] for name, source in DEFAULTS.items()}, **points}
    return {name: np.array(point_of(name, given[name])) for name in (*POINTS, *CARRIED) if name in given}


def _strut_axes(drawn: Mapping[str, np.ndarray], closure: str) -> tuple[Axis, Axis]:
    """The axis that slides in the knuckle, and the rod's line in the same sense."""
    rod = Axis("strut_rod_end", "strut_top")
    if closure == "collinear":
        return Axis("lower_ball_joint", "strut_lower"), rod
    axis = _between(drawn, "strut_lower", "strut_top")
    # The rod end stays on the side of the top mount where it is drawn.
    below = float(axis @ _between(drawn, "strut_rod_end", "strut_top")) >= 0
    return Axis("strut_lower", "strut_top"), rod if below else Axis("strut_top", "strut_rod_end")


def _sides(upward: Vector, closure: str) -> dict[str, Side]:
    front_to_ball = ("lower_arm_front", "lower_ball_joint")
    kingpin = ("lower_ball_joint", "strut_top")
    if closure == "collinear":
        # Where the knuckle's own line is not the kingpin yet, it is the knuckle's line that counts: tie
        # rod and steering arm stand in one plane with it where they are at their dead point as drawn.
        steered = ("lower_ball_joint", "strut_lower")
        strut = {
            "knuckle along the kingpin": Side((steered, kingpin), STRUT),
            "strut rod along the kingpin": Side((("strut_rod_end", "strut_top"), kingpin), STRUT),
        }
    else:
        # The top mount is on the strut axis, and as far from the ball joint as on the chassis: at two
        # places, one on each side of the foot of the ball joint on the axis.
        steered = kingpin
        axis = Carried("knuckle", "strut_lower", "strut_top")
        strut = {"strut axis along the kingpin": Side((axis, kingpin), STRUT)}
    steering = (steered, ("lower_ball_joint", "tie_rod_inner"), ("lower_ball_joint", "tie_rod_outer"))
    return {
        "ball joint beside the arm axis": Side(
            (front_to_ball, ("lower_arm_front", "lower_arm_rear"), upward), ARM_LINKS
        ),
        **strut,
        "tie rod beside the kingpin": Side(steering, TIE_ROD),
    }


def _unit(name: str, vector: Vector) -> np.ndarray:
    array = np.array(vector)
    largest = float(np.abs(array).max())
    if largest == 0:
        raise DescriptionError(f"{name} is {vector}; a direction must not be zero", name, vector)
    array = array / largest
    return np.asarray(array / np.linalg.norm(array))


def _between(drawn: Mapping[str, np.ndarray], start: str, end: str) -> np.ndarray:
    line = drawn[end] - drawn[start]
    if not np.any(line):
        raise DescriptionError(
            f"points {start!r} and {end!r} coincide at {_plain(drawn[start])}; move one of them",
            start,
            _plain(drawn[start]),
        )
    return _unit(start, _plain(line))


def _plain(vector: np.ndarray) -> Vector:
    return (float(vector[0]), float(vector[1]), float(vector[2]))
