"""Double wishbones: the printed front car of Lotus' report, and random ones like it."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Lotus Suspension Analysis (SHARK) v4.03, a printed report of a front axle, right wheel (in voila-sus 0.2.0,
# MIT, tests/fixtures/front_type1_report.txt); x rearward, y outboard, z up, mm.
LOTUS = {
    "lower_arm_front": (-110.0, 257.0, 69.0),
    "lower_arm_rear": (90.0, 257.0, 78.0),
    "upper_arm_front": (-91.0, 388.0, 255.0),
    "upper_arm_rear": (109.0, 388.0, 255.0),
    "rack_centre": (-10.0, 178.0, 154.0),
    "lower_ball_joint": (-10.0, 673.0, 95.0),
    "upper_ball_joint": (9.0, 646.0, 315.0),
    "tie_rod_outer": (-120.0, 650.0, 225.0),
    "tie_rod_inner": (-10.0, 178.0, 154.0),
    "wheel_axis_inner": (0.0, 658.0, 210.0),
    "wheel_centre": (0.0, 718.0, 210.0),
}

TYRE_RADIUS = 270.0
# Travel of the contact point, mm, and angles there, degrees, of the same report.
LOTUS_BUMP = (-37.5, -30.0, -22.5, -15.0, -7.5, 0.0, 7.5, 15.0, 22.5, 30.0, 37.5)
LOTUS_ANGLES = {
    "camber": (1.4532, 1.1943, 0.9196, 0.6291, 0.3226, 0.0, -0.3389, -0.6942, -1.0663, -1.4554, -1.8618),
    "kingpin": (5.566, 5.8165, 6.0847, 6.3706, 6.6745, 6.9968, 7.3376, 7.6975, 8.0767, 8.4758, 8.8952),
    "toe": (-0.3378, -0.2173, -0.1231, -0.0554, -0.0143, 0.0, -0.0127, -0.0526, -0.1203, -0.2161, -0.3405),
    "caster": (4.4964, 4.584, 4.6717, 4.7595, 4.8477, 4.936, 5.0247, 5.1137, 5.2031, 5.2929, 5.3832),
}


def random_wishbone(seed: int, closing: bool = True) -> dict[str, Array]:
    """A left car, each point up to 30 mm from the printed car's mirror image, its rack line drawn apart from
    the tie rod's end in half of them."""
    random = np.random.default_rng(seed)
    mirror = np.array([1.0, -1.0, 1.0])
    car = {name: np.array(point) * mirror + random.uniform(-30.0, 30.0, 3) for name, point in LOTUS.items()}
    apart = random.uniform(-60.0, 60.0) if random.uniform() < 0.5 else 0.0
    car["rack_centre"] = car["tie_rod_inner"] + np.array([0.0, apart, 0.0])
    if not closing:
        car["rack_centre"] = car["tie_rod_inner"] + random.uniform(-15.0, 15.0, 3)
    return car


def short_lower_arm(seed: int) -> dict[str, Array]:
    """A left car whose lower arm meets its dead points before the upper one does; it has eight assemblies."""
    random = np.random.default_rng(seed)
    mirror = np.array([1.0, -1.0, 1.0])
    car = {name: np.array(point) * mirror for name, point in LOTUS.items()}
    car["lower_arm_front"][1] = car["lower_arm_rear"][1] = -560.0
    car["upper_arm_front"][1] = car["upper_arm_rear"][1] = -250.0
    car["tie_rod_inner"] = np.array([-120.0, -250.0, 225.0])
    car = {name: point + random.uniform(-15.0, 15.0, 3) for name, point in car.items()}
    return {**car, "rack_centre": car["tie_rod_inner"]}
