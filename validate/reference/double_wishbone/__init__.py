"""The double wishbone: two arms, a knuckle between their ball joints, and a tie rod from the rack."""

from __future__ import annotations

from validate.reference.double_wishbone import branches, equations
from validate.reference.double_wishbone.branches import Choices as Choices
from validate.reference.double_wishbone.points import (
    CHASSIS,
    INNER,
    JOINTS,
    LOWER_BALL,
    LOWER_FRONT,
    LOWER_REAR,
    POINTS,
    RACK,
    SPIN,
    UPPER_BALL,
    UPPER_FRONT,
    UPPER_REAR,
    WHEEL,
)
from validate.reference.drives import ArmAngle, RackTravel
from validate.reference.linkage import Linkage

DRAWN = Linkage(
    points=POINTS,
    stand_ins={RACK: INNER},
    left_out=(),
    chassis=CHASSIS,
    joints=JOINTS,
    inputs={"arm_angle": ArmAngle(LOWER_BALL, LOWER_FRONT, LOWER_REAR), "rack": RackTravel(RACK, INNER)},
    links=equations.LINKS,
    steering_axis=(LOWER_BALL, UPPER_BALL),
    wheel_axis=((SPIN,), WHEEL),
    arms={
        "lower_arm": (LOWER_FRONT, LOWER_REAR, LOWER_BALL),
        "upper_arm": (UPPER_FRONT, UPPER_REAR, UPPER_BALL),
    },
    size=equations.SIZE,
    coordinates=equations.SIZE,
    shape=equations.shape,
    residual=equations.residual,
    jacobian=equations.jacobian,
    points_of=equations.points_of,
    unknown_of=equations.unknown_of,
    implied=equations.implied,
    knuckle_frame=equations.knuckle_frame,
    handedness=equations.handedness,
    choices=Choices,
    drawn_sides=branches.drawn_sides,
    posed_sides=branches.posed_sides,
    combinations=branches.combinations,
    candidate=branches.candidate,
)

CLOSURES = {"drawn": DRAWN}
