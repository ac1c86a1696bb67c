"""The double wishbone: the knuckle on the lower arm's ball joint, closed by the upper arm and the tie rod.

chassis -- lower arm (revolute) -- knuckle (spherical at the lower ball joint)
chassis -- upper arm (revolute)
chassis -- rack (prismatic)
"""

from __future__ import annotations

import numpy as np

from validate.relative.linkage import (
    CHASSIS,
    NO_GAP,
    Coincide,
    Joint,
    Line,
    Linkage,
    Place,
    Points,
    Side,
    length,
    triple,
)
from validate.relative.suspensions.steered_arm import (
    ARM,
    BALL,
    FRONT,
    INNER,
    KNUCKLE,
    OUTER,
    RACK,
    REAR,
    Axes,
    arm_drive,
    arm_side,
    direction,
    hinged_arm,
    steering,
    tie_side,
)

UPPER_FRONT, UPPER_REAR, UPPER_BALL = "upper_arm_front", "upper_arm_rear", "upper_ball_joint"
WHEEL, AXIS_INNER = "wheel_centre", "wheel_axis_inner"
UPPER_ARM = "upper_arm"


def double_wishbone(points: Points, axes: Axes, closure: str) -> Linkage:
    """The double wishbone of these hardpoints; its drawing closes as drawn.

    Raises:
        HardpointsError: points that must be apart are at one place, or on one line.
    """
    p = points
    direction(p, BALL, UPPER_BALL)
    steered = steering(p, axes, p[OUTER])
    upper = (p[UPPER_FRONT], p[UPPER_REAR], p[UPPER_BALL], p[BALL])
    return Linkage(
        joints=(
            hinged_arm(ARM, p, FRONT, REAR, BALL),
            Joint(KNUCKLE, ARM, "spherical", p[BALL], NO_GAP),
            hinged_arm(UPPER_ARM, p, UPPER_FRONT, UPPER_REAR, UPPER_BALL),
            steered.joint,
        ),
        points={
            **{name: Place(CHASSIS, p[name]) for name in (FRONT, REAR, UPPER_FRONT, UPPER_REAR, RACK)},
            BALL: Place(ARM, p[BALL]),
            UPPER_BALL: Place(UPPER_ARM, p[UPPER_BALL]),
            **{name: Place(KNUCKLE, p[name]) for name in (OUTER, WHEEL, AXIS_INNER)},
            INNER: steered.inner,
        },
        closures=(
            Coincide(Place(UPPER_ARM, p[UPPER_BALL]), Place(KNUCKLE, p[UPPER_BALL]), NO_GAP),
            steered.tie_rod,
        ),
        drives=(arm_drive(p, axes), steered.drive),
        sides=(
            arm_side(p, axes),
            Side(
                "the upper arm and the knuckle lie in line",
                (
                    Place(CHASSIS, p[UPPER_FRONT]),
                    Place(CHASSIS, p[UPPER_REAR]),
                    Place(UPPER_ARM, p[UPPER_BALL]),
                    Place(ARM, p[BALL]),
                ),
                triple(*upper),
                float(np.prod([length(place - upper[0]) for place in upper[1:]])),
            ),
            tie_side(
                Place(ARM, p[BALL]),
                Place(UPPER_ARM, p[UPPER_BALL]),
                steered.inner,
                p[OUTER],
                p,
                p[UPPER_BALL] - p[BALL],
            ),
        ),
        steering_axis=_knuckle_line(p, BALL, UPPER_BALL),
        spin_axis=_knuckle_line(p, AXIS_INNER, WHEEL),
        bodies={"knuckle": KNUCKLE},
    )


def _knuckle_line(points: Points, start: str, end: str) -> Line:
    return Line(Place(KNUCKLE, points[start]), Place(KNUCKLE, points[end]), points[end] - points[start])
