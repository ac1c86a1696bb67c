"""Caster of a steering axis that is leaned by hand."""

import numpy as np
import pytest

from pointcoord import Scene, simulate
from pointcoord.effects.caster import CASTER
from pointcoord.linkage.car_axes import CarAxes

EPS = np.finfo(float).eps
UP, RIGHTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # x rearward
(ANGLE,) = CASTER.numbers


@pytest.mark.parametrize("side", [-1.0, 1.0], ids=["left wheel", "right wheel"])
@pytest.mark.parametrize("degrees", [-12.0, -3.0, 0.0, 6.5, 45.0])
@pytest.mark.parametrize("kingpin", [0.0, 60.0])
def test_caster_is_the_lean_of_the_steering_axis_rearward_at_the_top(
    side: float, degrees: float, kingpin: float
) -> None:
    lean = np.deg2rad(degrees)
    lower = np.array([10.0, 600.0 * side, 100.0])
    # Kingpin inclination, across the car, is not seen from the side.
    upper = lower + 300.0 * np.array([np.sin(lean), 0.0, np.cos(lean)]) + [0.0, -side * kingpin, 0.0]
    axes = CarAxes(UP, RIGHTWARD, side * RIGHTWARD)
    # A few roundings of coordinates up to 600 over the length of 300.
    assert ANGLE.value(lower, upper, axes) == pytest.approx(lean, abs=16 * EPS * 600 / 300)


def test_caster_of_a_drawn_strut_is_that_of_the_line_from_ball_joint_to_strut_top() -> None:
    scene = Scene.load("off-axis-strut")
    content = scene.model_dump(mode="json", exclude_none=True) | {"effects": ["caster"]}
    motion = simulate(Scene.from_mapping(content))
    top, ball = motion.position["strut_top"], motion.position["lower_ball_joint"]
    rearward, upward = (top - ball)[:, 0], (top - ball)[:, 2]
    # The strut's top lies behind its ball joint, or before it: by as much as the tangent says.
    assert np.tan(motion.wheel["caster"]) == pytest.approx(rearward / upward, rel=1e-12)
