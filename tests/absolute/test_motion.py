"""What the solved motion must satisfy, whatever solved it."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
# Size of the mechanism, mm, and of its condition number in the tests here (asserted below).
SIZE, CONDITION = 500.0, 60.0
# A position solved to rounding: eps relative to the size, magnified by the condition number.
ROUNDING = EPS * SIZE * CONDITION
TIMES = np.linspace(0.0, 2.6, 14)


@pytest.fixture(scope="module")
def motion(strut: absolute.Model, both: Callable[[Array], dict[str, Array]]) -> absolute.Solution:
    return absolute.solve(strut, both(TIMES), conditions=True)


def along(a: Array, b: Array) -> Array:
    return np.linalg.norm(a - b, axis=-1)


def test_condition_number_is_what_the_tolerances_assume(motion: absolute.Solution) -> None:
    assert motion.condition is not None
    assert motion.condition.max() < CONDITION


def test_bodies_keep_the_distances_of_the_drawing(strut: absolute.Model, motion: absolute.Solution) -> None:
    for body in strut.moving:
        for a in strut.bodies[body]:
            for b in strut.bodies[body]:
                drawn = np.linalg.norm(np.subtract(strut.points[a], strut.points[b]))
                # Two points of one pose: rounding of rotation and sum, no solver error.
                assert np.allclose(
                    along(motion.position[a], motion.position[b]), drawn, rtol=0, atol=16 * EPS * SIZE
                )


def test_shared_points_are_where_every_body_holds_them(
    strut: absolute.Model, motion: absolute.Solution
) -> None:
    # Distances across joints: each point is read from one body, its joints tie it to the others.
    pairs = [
        ("lower_ball_joint", "lower_arm_front"),
        ("lower_ball_joint", "lower_arm_rear"),
        ("tie_rod_outer", "tie_rod_inner"),
        ("strut_rod_end", "strut_top"),
        ("lower_ball_joint", "tie_rod_outer"),
        ("strut_lower", "tie_rod_outer"),
    ]
    for a, b in pairs:
        drawn = np.linalg.norm(np.subtract(strut.points[a], strut.points[b]))
        assert np.allclose(along(motion.position[a], motion.position[b]), drawn, rtol=0, atol=ROUNDING)


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


def test_inputs_are_met(
    strut: absolute.Model, motion: absolute.Solution, both: Callable[[Array], dict[str, Array]]
) -> None:
    p, inputs = motion.position, both(TIMES)
    d51 = np.linalg.norm(np.subtract(strut.points["lower_ball_joint"], strut.points["lower_arm_front"]))
    rise = (p["lower_ball_joint"] - p["lower_arm_front"])[:, 2]
    assert np.allclose(rise, d51 * np.cos(inputs["arm_angle"][:, 0]), rtol=0, atol=ROUNDING)
    slide = p["rack_centre"] - np.outer(inputs["rack"][:, 0], [0.0, 1.0, 0.0])
    assert np.allclose(p["tie_rod_inner"], slide, rtol=0, atol=ROUNDING)


def test_residual_is_rounding(motion: absolute.Solution) -> None:
    # A row is a sum of three products of numbers of order 1.
    assert motion.residual.max() < 16 * EPS * SIZE


def differences(values: Array, step: float) -> tuple[Array, float]:
    """Derivative at the middle of nine samples by the fourth-order rule, and its own error.

    The rule with step h errs by c h^4, with 2 h by 16 c h^4: a fifteenth of their difference is
    the error of the finer one. It is doubled, for the terms of higher order.
    """

    def rule(stride: int) -> Array:
        v = values[4 - 2 * stride], values[4 - stride], values[4 + stride], values[4 + 2 * stride]
        return (v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * stride * step)

    fine, coarse = rule(1), rule(2)
    return fine, 2 * float(np.abs(fine - coarse).max()) / 15


@pytest.mark.parametrize("middle", [0.3, 1.1, 2.2])
def test_rates_are_derivatives_over_time(
    strut: absolute.Model, both: Callable[[Array], dict[str, Array]], middle: float
) -> None:
    step = 4e-3
    motion = absolute.solve(strut, both(middle + step * np.arange(-4, 5)))
    # The rule sums 18 / 12 of the samples' rounding over the step.
    for values, rates, rounding in (
        (motion.position, motion.velocity, ROUNDING),
        (motion.velocity, motion.acceleration, ROUNDING),
        (motion.angular_velocity, motion.angular_acceleration, EPS * CONDITION),
    ):
        for name in values:
            slope, truncation = differences(values[name], step)
            tolerance = truncation + 1.5 * rounding / step
            assert np.abs(slope - rates[name][4]).max() < tolerance, name
            assert tolerance < 1e-6, "a loose tolerance would prove nothing"


def test_points_of_a_body_turn_with_its_angular_velocity(
    strut: absolute.Model, motion: absolute.Solution
) -> None:
    for body in strut.moving:
        spin, spin1 = motion.angular_velocity[body], motion.angular_acceleration[body]
        first, *others = strut.bodies[body]
        for other in others:
            arm = motion.position[other] - motion.position[first]
            turning = np.cross(spin, arm)
            velocity = motion.velocity[other] - motion.velocity[first]
            # The two ends may be read from two bodies joined there: the solver's rounding counts.
            assert np.allclose(velocity, turning, rtol=0, atol=ROUNDING)
            acceleration = motion.acceleration[other] - motion.acceleration[first]
            bent = np.cross(spin1, arm) + np.cross(spin, turning)
            assert np.allclose(acceleration, bent, rtol=0, atol=ROUNDING)


def test_rod_turns_with_the_knuckle_and_rack_does_not_turn(motion: absolute.Solution) -> None:
    spin = motion.angular_velocity
    assert np.allclose(spin["strut_rod"], spin["knuckle"], rtol=0, atol=EPS * CONDITION)
    assert np.allclose(spin["rack"], 0.0, rtol=0, atol=EPS * CONDITION)


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


def test_chassis_motion_is_added_to_every_point(
    strut: absolute.Model, both: Callable[[Array], dict[str, Array]]
) -> None:
    chassis = np.random.default_rng(1).normal(size=(len(TIMES), 3, 3)) * 50.0
    still = absolute.solve(strut, both(TIMES))
    heaving = absolute.solve(strut, both(TIMES), chassis=chassis)
    for name in strut.points:
        # One addition to numbers of order 1000.
        for k, (a, b) in enumerate(
            (
                (still.position, heaving.position),
                (still.velocity, heaving.velocity),
                (still.acceleration, heaving.acceleration),
            )
        ):
            assert np.allclose(b[name], a[name] + chassis[:, k], rtol=0, atol=4 * EPS * 1000)
    for body in strut.moving:
        assert (heaving.angular_velocity[body] == still.angular_velocity[body]).all()


def test_an_instant_does_not_depend_on_the_instants_before_it(
    strut: absolute.Model, both: Callable[[Array], dict[str, Array]]
) -> None:
    sweep = absolute.solve(strut, both(TIMES))
    backwards = absolute.solve(strut, both(TIMES[::-1].copy()))
    for name in strut.points:
        assert np.allclose(sweep.position[name], backwards.position[name][::-1], rtol=0, atol=2 * ROUNDING)


def test_positions_alone_leave_the_rates_out(
    strut: absolute.Model, both: Callable[[Array], dict[str, Array]]
) -> None:
    full, bare = absolute.solve(strut, both(TIMES)), absolute.solve(strut, both(TIMES), rates=False)
    assert not bare.velocity
    assert not bare.acceleration
    assert not bare.angular_velocity
    assert not bare.angular_acceleration
    assert bare.condition is None
    for name in strut.points:
        assert (bare.position[name] == full.position[name]).all()


def test_no_instants_give_an_empty_motion(strut: absolute.Model) -> None:
    motion = absolute.solve(strut, {"arm_angle": np.zeros((0, 3)), "rack": np.zeros((0, 3))})
    assert motion.position["wheel_centre"].shape == (0, 3)
