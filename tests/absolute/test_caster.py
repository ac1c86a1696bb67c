"""Caster: a steering axis laid back by hand, and what it does to a wheel that is steered."""

import numpy as np
import pytest
from flat import built_in
from kinds import KINDS, inputs_at, mirrored
from strut_motion import drawn_inputs
from wishbones import LOTUS

import absolute

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("lean", [-0.25, 0.0, 0.1, 0.3])
@pytest.mark.parametrize("side", ["left", "right"])
def test_a_top_mount_moved_rearward_by_hand_is_caster(lean: float, side: str) -> None:
    kind = KINDS["strut"]
    car = kind.random_car(1, True)
    car = mirrored(car) if side == "right" else car
    # x is rearward, on both sides; the axis leans inboard as well.
    inboard = 1.0 if side == "left" else -1.0
    way = np.array([np.sin(lean), 0.1 * inboard, np.cos(lean)])
    car["strut_top"] = car["lower_ball_joint"] + 500.0 * way
    car["strut_rod_end"] = car["strut_top"] - 0.3 * (car["strut_top"] - car["strut_lower"])
    inputs = inputs_at(*((value, 0, 0) for value in drawn_inputs(car)))
    motion = absolute.solve(kind.build(car, side=side), inputs, effects=["caster"])
    # Drawn to rounding of 500 mm, over 500 mm, and solved at a condition number of 60.
    assert abs(motion.effects["caster"][0] - lean) < 10 * 60 * EPS


@pytest.mark.parametrize("back", [-60.0, 60.0])
@pytest.mark.parametrize("side", ["left", "right"])
def test_an_axis_laid_back_leans_a_wheel_in_that_is_turned_in(side: str, back: float) -> None:
    # As every car with caster does with its outer wheel in a bend; with an axis laid forward it leans out.
    car = {name: np.array(point) for name, point in LOTUS.items()}
    car["upper_ball_joint"] = car["lower_ball_joint"] + [back, 0.0, 220.0]
    car = mirrored(car) if side == "left" else car
    angle, _ = drawn_inputs(car)
    racks = np.array([0.0, 10.0 if side == "right" else -10.0])
    inputs = {
        "arm_angle": np.tile([angle, 0.0, 0.0], (2, 1)),
        "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
    }
    model = built_in("double_wishbone", car, side=side)
    effects = absolute.solve(model, inputs, effects=["toe", "camber", "caster", "kingpin"]).effects
    assert abs(effects["kingpin"][0]) < 1e-12
    turned_in, leant = np.diff(effects["toe"])[0], np.diff(effects["camber"])[0]
    assert turned_in > 0.05
    # A small turn d about a unit axis k at a caster c from upright: toe d cos c, camber -d sin c.
    assert np.isclose(leant / turned_in, -np.tan(effects["caster"][0]), atol=turned_in)
    assert -np.sign(leant) == np.sign(back) == np.sign(effects["caster"][0])
