"""The MacPherson strut: the rod on a ball joint of the chassis, and the knuckle slides along it.

    chassis -- lower arm (revolute)
    chassis -- strut rod (spherical) -- knuckle (prismatic along the strut's axis)
    chassis -- rack (prismatic)

Closed by the lower ball joint, of arm and knuckle, and by the tie rod's length. `drawn`: the axis runs
through strut_lower and strut_top as drawn. `collinear`: it runs through the lower ball joint and
strut_lower, and the knuckle is put where it passes through the top; what that leaves open is the gap of its
closures.
"""

from __future__ import annotations

import numpy as np

from validate.relative.errors import HardpointsError
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

TOP, LOWER, ROD_END = "strut_top", "strut_lower", "strut_rod_end"
WHEEL, AXIS_INNER = "wheel_centre", "wheel_axis_inner"
ROD = "strut_rod"


def macpherson(points: Points, axes: Axes, closure: str) -> Linkage:
    """The strut of these hardpoints.

    Raises:
        HardpointsError: points that must be apart are at one place, or on one line.
    """
    top, ball, beyond = points[TOP], points[BALL], points[ROD_END] - points[TOP]
    arm = hinged_arm(ARM, points, FRONT, REAR, BALL)
    if closure == "drawn":
        axis = direction(points, LOWER, TOP)
        kingpin, shift, slid = top - ball, NO_GAP, axis
    else:
        line = direction(points, BALL, LOWER)
        strut = top - ball
        axis = line if float(line @ strut) >= 0.0 else -line
        kingpin, slid = axis, strut
        shift = strut - float(strut @ axis) * axis  # puts the top on the knuckle's own line
    if length(kingpin) == 0.0:
        raise HardpointsError(
            TOP, f"is where {BALL} is, so that the kingpin has no direction", "points apart"
        )
    direction(points, TOP, ROD_END)
    rod_end = float(np.copysign(length(beyond), beyond @ slid)) * axis

    def on_knuckle(name: str) -> Place:
        return Place(KNUCKLE, points[name] + shift)

    steered = steering(points, axes, points[OUTER] + shift)
    carried = [name for name in (LOWER, OUTER, WHEEL, AXIS_INNER) if name in points]
    ahead = Place(ROD, top + axis)
    inner = AXIS_INNER if AXIS_INNER in points else LOWER
    return Linkage(
        joints=(
            arm,
            Joint(ROD, CHASSIS, "spherical", top, NO_GAP),
            Joint(KNUCKLE, ROD, "prismatic", top, axis),
            steered.joint,
        ),
        points={
            **{name: Place(CHASSIS, points[name]) for name in (FRONT, REAR, RACK, TOP)},
            BALL: Place(ARM, ball),
            **{name: on_knuckle(name) for name in carried},
            ROD_END: Place(ROD, top + rod_end),
            INNER: steered.inner,
        },
        closures=(Coincide(Place(ARM, ball), on_knuckle(BALL), -shift), steered.tie_rod),
        drives=(arm_drive(points, axes), steered.drive),
        sides=(
            arm_side(points, axes),
            Side(
                "the strut's slide runs out",
                (Place(CHASSIS, top), ahead, Place(ARM, ball), None),
                float(axis @ (ball + shift - top)),
                length(ball - top),
            ),
            tie_side(
                Place(ARM, ball),
                Place(CHASSIS, top) if closure == "drawn" else Place(KNUCKLE, points[BALL] + shift + axis),
                steered.inner,
                points[OUTER] + shift,
                points,
                kingpin,
            ),
        ),
        steering_axis=(
            Line(Place(ARM, ball), Place(CHASSIS, top), kingpin)
            if closure == "drawn"
            else Line(on_knuckle(BALL), on_knuckle(LOWER), points[LOWER] - ball)
        ),
        spin_axis=Line(on_knuckle(inner), on_knuckle(WHEEL), points[WHEEL] - points[inner]),
        bodies={"knuckle": KNUCKLE},
    )
