"""The MacPherson strut: as drawn, with its axis fixed in the knuckle, and as the paper straightens it."""

from __future__ import annotations

from dataclasses import replace

from validate.reference.drives import ArmAngle, RackTravel
from validate.reference.linkage import Linkage
from validate.reference.macpherson import branches, collinear, drawn
from validate.reference.macpherson.branches import Choices as Choices
from validate.reference.macpherson.points import (
    BALL,
    CHASSIS,
    FRONT,
    INNER,
    JOINTS,
    LOWER,
    POINTS,
    RACK,
    REAR,
    SPIN,
    TOP,
    WHEEL,
)

DRAWN = Linkage(
    points=POINTS,
    stand_ins={RACK: INNER},
    left_out=(SPIN,),
    chassis=CHASSIS,
    joints=JOINTS,
    inputs={"arm_angle": ArmAngle(BALL, FRONT, REAR), "rack": RackTravel(RACK, INNER)},
    links=drawn.LINKS,
    steering_axis=(BALL, TOP),
    wheel_axis=((SPIN, LOWER), WHEEL),
    arms={"lower_arm": (FRONT, REAR, BALL)},
    size=drawn.SIZE,
    coordinates=drawn.COORDINATES,
    shape=drawn.shape,
    residual=drawn.residual,
    jacobian=drawn.jacobian,
    points_of=drawn.points_of,
    unknown_of=drawn.unknown_of,
    implied=drawn.implied,
    knuckle_frame=drawn.knuckle_frame,
    handedness=drawn.handedness,
    choices=Choices,
    drawn_sides=branches.drawn_drawn_sides,
    posed_sides=branches.drawn_posed_sides,
    combinations=branches.drawn_combinations,
    candidate=branches.drawn_candidate,
)

COLLINEAR = replace(
    DRAWN,
    links=collinear.LINKS,
    steering_axis=(BALL, LOWER),  # eq. (16)
    size=collinear.SIZE,
    coordinates=collinear.COORDINATES,
    shape=collinear.shape,
    residual=collinear.residual,
    jacobian=collinear.jacobian,
    points_of=collinear.points_of,
    unknown_of=collinear.unknown_of,
    implied=collinear.implied,
    knuckle_frame=collinear.knuckle_frame,
    handedness=collinear.handedness,
    drawn_sides=branches.collinear_drawn_sides,
    posed_sides=branches.collinear_posed_sides,
    combinations=branches.collinear_combinations,
    candidate=branches.collinear_candidate,
)

CLOSURES = {"drawn": DRAWN, "collinear": COLLINEAR}
