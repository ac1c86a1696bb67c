"""Random struts whose ball joint lies beside the strut axis, as it does in cars."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
RIGHT = np.array([0.0, 1.0, 0.0])

# Table 1 of the paper, mm.
TABLE = {
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


def off_axis_strut(seed: int, closing: bool = True) -> dict[str, Array]:
    """A left strut; its ball joint 20 to 90 mm beside the axis through strut_lower and strut_top.

    A drawing that closes has its rod end on the axis and its rack on its line to one rounding.
    """
    random = np.random.default_rng(seed)

    def near(x: float, y: float, z: float, spread: float) -> Array:
        return np.array([x, y, z]) + random.uniform(-spread, spread, 3)

    p = {
        "lower_arm_front": near(270, -10, -10, 40),
        "lower_arm_rear": near(540, -10, -20, 40),
        "strut_top": near(460, -180, 470, 40),
        "strut_lower": near(452, -300, 80, 30),
        "tie_rod_outer": near(570, -300, 60, 30),
        "tie_rod_inner": near(570, 60, 90, 30),
        "wheel_centre": near(452, -410, 20, 30),
    }
    axis = p["strut_top"] - p["strut_lower"]
    axis /= np.linalg.norm(axis)
    beside = np.cross(axis, random.normal(size=3))
    foot = p["strut_lower"] - random.uniform(40.0, 140.0) * axis
    p["lower_ball_joint"] = foot + random.uniform(20.0, 90.0) * beside / np.linalg.norm(beside)
    p["strut_rod_end"] = p["strut_top"] - random.choice([-0.2, 0.3, 0.6]) * (
        p["strut_top"] - p["strut_lower"]
    )
    if random.uniform() < 0.5:
        p["rack_centre"] = p["tie_rod_inner"] + random.uniform(-60.0, 60.0) * RIGHT
    if random.uniform() < 0.5:
        p["wheel_axis_inner"] = p["wheel_centre"] + near(0, 60, 0, 5)
    if not closing:
        p["strut_rod_end"] = p["strut_rod_end"] + random.uniform(-8.0, 8.0, 3)
        p["rack_centre"] = p["tie_rod_inner"] + random.uniform(-15.0, 15.0, 3)
    return p


def collinear_strut(seed: int, closing: bool = True) -> dict[str, Array]:
    """The same with its ball joint on the axis."""
    p = off_axis_strut(seed, closing)
    if closing:
        p["strut_rod_end"] = p["strut_top"] - 0.4 * (p["strut_top"] - p["strut_lower"])
    p["lower_ball_joint"] = p["strut_lower"] - 0.2 * (p["strut_top"] - p["strut_lower"])
    return p
