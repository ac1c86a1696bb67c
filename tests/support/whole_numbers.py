"""A right double wishbone with a pushrod and a rocker, drawn in whole numbers."""

# The right wheel's contact point of the spin axis (36, 48, 25) and the radius 260 is (1060, 780, 60).
WHEEL = {"wheel_axis_inner": (964, 652, 275), "wheel_centre": (1000, 700, 300)}
CONTACT = (1060, 780, 60)
WISHBONES = {
    "lower_arm_front": (900, 250, 160),
    "lower_arm_rear": (1120, 260, 150),
    "upper_arm_front": (930, 300, 410),
    "upper_arm_rear": (1080, 310, 420),
    "lower_ball_joint": (995, 660, 150),
    "upper_ball_joint": (1010, 620, 430),
    "tie_rod_outer": (1130, 650, 240),
    "tie_rod_inner": (1140, 270, 250),
    "pushrod_outer": (1000, 560, 180),
    "pushrod_inner": (1010, 330, 500),
    "rocker_front": (960, 280, 480),
    "rocker_rear": (1060, 290, 490),
    "damper_rocker": (1000, 250, 540),
    "damper_top": (990, 40, 520),
    **WHEEL,
}
