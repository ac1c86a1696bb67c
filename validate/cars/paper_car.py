"""The hardpoints of the paper's MacPherson strut, Table 1, mm."""

from __future__ import annotations

from validate.cars.car import Points

PAPER: Points = {
    "lower_arm_front": (270.0, -5.0, -10.0),
    "lower_arm_rear": (540.0, -10.0, -20.0),
    "rack_centre": (570.0, 60.0, 90.0),
    "strut_top": (460.0, -180.0, 470.0),
    "lower_ball_joint": (450.0, -330.0, -40.0),
    "tie_rod_outer": (560.0, -300.0, 60.0),
    "strut_lower": (452.0, -320.0, 20.0),
    "strut_rod_end": (456.0, -250.0, 246.0),
    "tie_rod_inner": (570.0, 60.0, 90.0),
    "wheel_centre": (452.0, -410.0, 20.0),
}
