"""A front double wishbone and what Lotus Suspension Analysis prints of it.

Source: printed report of Lotus Suspension Analysis (SHARK) v4.03, in the source distribution of the Python
    package
voila-sus 0.2.0 (MIT licence), tests/fixtures/front_type1_report.txt. It is the right wheel: x rearward, y
outboard, z up; mm, deg. The rules of the tables were found by reproducing them: angles are projected; bump is
the vertical travel of the contact point, the lowest point of a thin disc about the wheel centre; in the
steering table the rack moves the tie rod's inner end along y, and the height of the contact point is held.
"""

from __future__ import annotations

POINTS = {
    "lower_arm_front": (-110, 257, 69),
    "lower_arm_rear": (90, 257, 78),
    "upper_arm_front": (-91, 388, 255),
    "upper_arm_rear": (109, 388, 255),
    "lower_ball_joint": (-10, 673, 95),
    "upper_ball_joint": (9, 646, 315),
    "tie_rod_outer": (-120, 650, 225),
    "tie_rod_inner": (-10, 178, 154),
    "wheel_centre": (0, 718, 210),
    "wheel_axis_inner": (0, 658, 210),
}
ROLLING_RADIUS = 270

# Bump, mm; camber, toe, caster and kingpin, deg, printed to 1e-4.
BUMP = (
    (-37.5, 1.4532, -0.3378, 4.4964, 5.566),
    (-30.0, 1.1943, -0.2173, 4.584, 5.8165),
    (-22.5, 0.9196, -0.1231, 4.6717, 6.0847),
    (-15.0, 0.6291, -0.0554, 4.7595, 6.3706),
    (-7.5, 0.3226, -0.0143, 4.8477, 6.6745),
    (0.0, 0.0, 0.0, 4.936, 6.9968),
    (7.5, -0.3389, -0.0127, 5.0247, 7.3376),
    (15.0, -0.6942, -0.0526, 5.1137, 7.6975),
    (22.5, -1.0663, -0.1203, 5.2031, 8.0767),
    (30.0, -1.4554, -0.2161, 5.2929, 8.4758),
    (37.5, -1.8618, -0.3405, 5.3832, 8.8952),
)

# Rack travel, mm; toe and camber of the right wheel, deg, printed to 1e-2.
STEERING = (
    (-45.0, 20.52, -1.31),
    (-40.5, 18.44, -1.21),
    (-36.0, 16.36, -1.1),
    (-31.5, 14.31, -0.99),
    (-27.0, 12.26, -0.87),
    (-22.5, 10.22, -0.74),
    (-18.0, 8.18, -0.61),
    (-13.5, 6.14, -0.47),
    (-9.0, 4.1, -0.32),
    (-4.5, 2.05, -0.16),
    (0.0, 0.0, 0.0),
    (4.5, -2.07, 0.17),
    (9.0, -4.15, 0.36),
    (13.5, -6.24, 0.56),
    (18.0, -8.36, 0.77),
    (22.5, -10.51, 1.0),
    (27.0, -12.68, 1.24),
    (31.5, -14.89, 1.5),
    (36.0, -17.13, 1.78),
    (40.5, -19.42, 2.09),
    (45.0, -21.75, 2.43),
)
