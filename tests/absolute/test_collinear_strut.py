"""The paper's strut: one line of ball joint, strut and top mount, and the steering about it."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
# Size of the mechanism, mm, and of its condition number (asserted in test_motion).
SIZE, CONDITION = 500.0, 60.0
ROUNDING = EPS * SIZE * CONDITION
TIMES = np.linspace(0.0, 2.6, 14)


@pytest.fixture(scope="module")
def motion(strut: absolute.Model, both: Callable[[Array], dict[str, Array]]) -> absolute.Solution:
    return absolute.solve(strut, both(TIMES))


def test_strut_points_lie_on_one_line_with_one_sense(motion: absolute.Solution) -> None:
    p = motion.position
    knuckle = p["strut_lower"] - p["lower_ball_joint"]
    line = knuckle / np.linalg.norm(knuckle, axis=-1)[:, None]
    # The knuckle's part is 60 mm long: its direction carries the rounding of its ends over that
    # length, out to the top mount more than 500 mm away.
    lever = 10.0
    for name in ("strut_rod_end", "strut_top"):
        out = p[name] - p["lower_ball_joint"]
        assert np.allclose(np.cross(line, out), 0.0, atol=lever * ROUNDING)
    assert (np.sum((p["strut_top"] - p["strut_rod_end"]) * line, axis=-1) > 0).all()


def test_steering_turns_the_knuckle_about_the_line_from_ball_joint_to_top_mount(
    strut: absolute.Model, steering: Callable[[Array], dict[str, Array]]
) -> None:
    motion = absolute.solve(strut, steering(np.linspace(0.0, 0.4, 9)))
    spin = motion.angular_velocity["knuckle"]
    rate = np.linalg.norm(spin, axis=-1)
    axis = motion.position["strut_top"] - motion.position["lower_ball_joint"]
    axis /= np.linalg.norm(axis, axis=-1)[:, None]
    # 1.46 rad/s is stated to two decimals.
    assert abs(rate[0] - 1.46) < 0.005
    assert (np.diff(rate) > 0).all()
    assert np.allclose(np.cross(axis, spin / rate[:, None]), 0.0, atol=EPS * CONDITION)
