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

# Wheel travel, camber, toe, change of the wheel centre's y.
FIVE_LINK_TABLE = (
    (-0.05, -0.016884168348040653, 0.026417285004189765, -0.004932280698823344),
    (-0.03, -0.00976836446354347, 0.01450186553475441, -0.0019245761612431966),
    (-0.01, -0.003155041756954252, 0.0044378058154273025, -0.00030270080495409246),
    (0.0, 0.0, 0.0, 0.0),
    (0.02, 0.006068416983196993, -0.007830551416778318, -0.0004002183137008508),
    (0.05, 0.01472490695908706, -0.017251412101719214, -0.0035197404371665186),
)
# Its solver stopped early: good to 5e-8.
TRAILING_ARM_TABLE = (
    (-0.08, 0.031687138642539366, -0.010451366386077474, -0.005494267946454134),
    (-0.04, 0.015734267520770215, -0.00573324522013982, -0.0024307248960311334),
    (0.0, 0.0, 0.0, 0.0),
    (0.03, -0.011657050867502535, 0.0049844662889582045, 0.0013978466905735232),
    (0.08, -0.030808566342647423, 0.014654720709491757, 0.0028853758844842314),
)
