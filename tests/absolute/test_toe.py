"""Toe: a wheel turned by hand, seen from above."""

import numpy as np
import pytest
from flat import built_in
from kinds import Kind, inputs_at, mirrored
from strut_motion import drawn_inputs
from wishbones import LOTUS

import absolute

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("turn", [-2.8, -0.3, 0.0, 0.02, 1.2, 3.0])
@pytest.mark.parametrize(("side", "out"), [("left", -1.0), ("right", 1.0)])
def test_a_wheel_turned_in_by_hand_has_that_toe(kind: Kind, turn: float, side: str, out: float) -> None:
    car = kind.random_car(1, True)
    if side == "right" and car["wheel_centre"][1] < 0:
        car = mirrored(car)
    # x is rearward: the way from the wheel's centre to its front edge is -x, and leads to the car's middle,
    # against y outboard, as far as the wheel is turned in. A wheel with camber as well has the same toe.
    front = np.array([-np.cos(turn), -out * np.sin(turn), 0.0])
    outboard_end = np.array([front[1], -front[0], 0.0]) * out
    assert abs(outboard_end @ front) < EPS
    assert turn != 0.0 or outboard_end[1] == out
    for lean in (0.0, 0.3):
        car["wheel_axis_inner"] = car["wheel_centre"] - 60.0 * (outboard_end + np.array([0.0, 0.0, lean]))
        inputs = inputs_at(*((value, 0, 0) for value in drawn_inputs(car)))
        motion = absolute.solve(kind.build(car, side=side), inputs, effects=["toe"])
        # The drawn axis is rounded as 500 mm over 60 mm, and comes back to the rounding of a pose.
        assert abs(motion.effects["toe"][0] - turn) < 10 * 60 * EPS
        front_edge = car["wheel_centre"] + 300.0 * front
        nearer = abs(front_edge[1]) < abs(car["wheel_centre"][1])
        assert abs(turn) >= 1.5 or turn == 0.0 or nearer == (motion.effects["toe"][0] > 0.0)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_rack_that_moves_the_steering_arm_to_the_middle_turns_the_wheel(side: str) -> None:
    # The tie rod of the printed car lies in front of the wheel's centre: drawn in, it turns the wheel in.
    printed = {name: np.array(point) for name, point in LOTUS.items()}
    car = mirrored(printed) if side == "left" else printed
    angle, _ = drawn_inputs(car)
    inward = 10.0 if side == "right" else -10.0
    racks = np.array([0.0, inward])
    inputs = {
        "arm_angle": np.tile([angle, 0.0, 0.0], (2, 1)),
        "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
    }
    motion = absolute.solve(built_in("double_wishbone", car, side=side), inputs, effects=["toe"])
    assert abs(motion.position["tie_rod_inner"][1, 1]) < abs(car["tie_rod_inner"][1])
    assert motion.effects["toe"][1] - motion.effects["toe"][0] > 0.05
