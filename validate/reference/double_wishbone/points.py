"""The hardpoints of a double wishbone by name."""

from __future__ import annotations

LOWER_FRONT = "lower_arm_front"
LOWER_REAR = "lower_arm_rear"
UPPER_FRONT = "upper_arm_front"
UPPER_REAR = "upper_arm_rear"
RACK = "rack_centre"
LOWER_BALL = "lower_ball_joint"
UPPER_BALL = "upper_ball_joint"
OUTER = "tie_rod_outer"
INNER = "tie_rod_inner"
WHEEL = "wheel_centre"
SPIN = "wheel_axis_inner"

CHASSIS = (LOWER_FRONT, LOWER_REAR, UPPER_FRONT, UPPER_REAR, RACK)
JOINTS = (LOWER_BALL, UPPER_BALL, OUTER)
CARRIED = (WHEEL, SPIN)
POINTS = (*CHASSIS, *JOINTS, INNER, *CARRIED)
