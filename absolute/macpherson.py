"""The MacPherson strut of the paper, described as data."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from absolute.description import Axis, Input, Joint, Model, Side, Vector, point_of, vector_of
from absolute.errors import DescriptionError

BODIES = {
    "chassis": ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"),
    "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
    "knuckle": ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre"),
    "strut_rod": ("strut_top", "strut_rod_end"),
    "tie_rod": ("tie_rod_outer", "tie_rod_inner"),
    "rack": ("tie_rod_inner",),
}
POINTS = tuple(dict.fromkeys(point for names in BODIES.values() for point in names))

# `up` and `right` are axes of one car. 1e-6 rad lets rounded directions pass and stops wrong ones.
LARGEST_SKEW = 1e-6


def macpherson(
    points: Mapping[str, Sequence[float]],
    up: Sequence[float] = (0.0, 0.0, 1.0),
    right: Sequence[float] = (0.0, 1.0, 0.0),
) -> Model:
    """A MacPherson strut with the inputs `arm_angle` (rad) and `rack` (mm).

    (lower_ball_joint - lower_arm_front) . up = d cos(arm_angle), d their drawn distance (eq. 12);
    tie_rod_inner = rack_centre - rack * right (eqs. 13-15). The strut rod slides in the knuckle and
    does not turn in it. A tie rod may spin about its own line without any effect; here its ball at
    the rack is a universal joint, so its angular velocity along that line is a convention.

    Args:
        points: the ten points named in POINTS, mm.
        up, right: where the car's up and right point in the frame of the points; any length.
    Raises:
        DescriptionError: a point is missing, unknown, not finite or beyond LARGEST_COORDINATE; up
            and right are no directions at a right angle; points that make an axis coincide.
    """
    missing, unknown = sorted(set(POINTS) - set(points)), sorted(set(points) - set(POINTS))
    if missing or unknown:
        raise DescriptionError(
            f"a MacPherson strut has the points {list(POINTS)}; missing: {missing}, unknown: {unknown}",
            (missing or unknown)[0],
        )
    drawn = {name: np.array(point_of(name, points[name])) for name in POINTS}
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
        "strut": Joint(
            "prismatic",
            "knuckle",
            "strut_rod",
            Axis("lower_ball_joint", "strut_lower"),
            Axis("strut_rod_end", "strut_top"),
        ),
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
    front_to_ball = ("lower_arm_front", "lower_ball_joint")
    kingpin = ("lower_ball_joint", "strut_top")
    # Where the knuckle's own line is not the kingpin yet, it is the knuckle's line that counts: tie
    # rod and steering arm stand in one plane with it where they are at their dead point as drawn.
    knuckle_line = ("lower_ball_joint", "strut_lower")
    sides = {
        "ball joint beside the arm axis": Side(
            (front_to_ball, ("lower_arm_front", "lower_arm_rear"), _plain(upward))
        ),
        "knuckle along the kingpin": Side((knuckle_line, kingpin)),
        "strut rod along the kingpin": Side((("strut_rod_end", "strut_top"), kingpin)),
        "tie rod beside the kingpin": Side(
            (knuckle_line, ("lower_ball_joint", "tie_rod_inner"), ("lower_ball_joint", "tie_rod_outer"))
        ),
    }
    drawn_points = {name: _plain(drawn[name]) for name in POINTS}
    return Model(drawn_points, "chassis", BODIES, joints, inputs, sides)


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
