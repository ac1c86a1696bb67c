"""The hardpoints of a strut by name, in the order of the paper's Table 1, which numbers them 1 to 10."""

from __future__ import annotations

FRONT = "lower_arm_front"  # 1
REAR = "lower_arm_rear"  # 2
RACK = "rack_centre"  # 3
TOP = "strut_top"  # 4
BALL = "lower_ball_joint"  # 5
OUTER = "tie_rod_outer"  # 6
LOWER = "strut_lower"  # 7
END = "strut_rod_end"  # 8
INNER = "tie_rod_inner"  # 9
WHEEL = "wheel_centre"  # 10
SPIN = "wheel_axis_inner"  # the paper has no such point

POINTS = (FRONT, REAR, RACK, TOP, BALL, OUTER, LOWER, END, INNER, WHEEL, SPIN)
CHASSIS = (FRONT, REAR, RACK, TOP)
JOINTS = (BALL, OUTER, LOWER, END, INNER)
CARRIED = (WHEEL, SPIN)
