"""Tables of other people: wheel travel against camber, toe and track of a five-link and a semi-trailing arm.

Source: github.com/Onlyti/VDSim, hardpoints at commit ce8b446e (configs/parts/susp_kinematics/kin), tables at
cf82abf9 (docs/tasks/T30_ld4_5link/run01/sweep_3d.csv) and fd68f4f4 (main/tasks/T29_ld4_ta/run01, the same).
Copyright 2026 Jiwon Seok, Apache License 2.0. Their axes: x forward, y left, z up; m and rad; left wheels.
Camber is + where the wheel leans out at the top, toe + in; the spin axis lies along y at zero travel.
"""

from __future__ import annotations

WHEEL_CENTRE = (-1.35, 0.78, 0.305)
FIVE_LINK = {
    "upper_front": ((-1.1, 0.42, 0.5), (-1.3, 0.72, 0.48)),
    "upper_rear": ((-1.6, 0.42, 0.5), (-1.4, 0.72, 0.48)),
    "lower_front": ((-1.1, 0.42, 0.15), (-1.3, 0.74, 0.16)),
    "lower_rear": ((-1.6, 0.42, 0.15), (-1.4, 0.74, 0.16)),
    "toe": ((-1.55, 0.42, 0.32), (-1.42, 0.74, 0.32)),
}
"""Of each rod the end on the chassis and the one on the knuckle."""

TRAILING_ARM = {"pivot_inner": (-0.8, 0.42, 0.22), "pivot_outer": (-0.75, 0.62, 0.2)}
