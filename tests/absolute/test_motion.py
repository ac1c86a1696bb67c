"""What the solved motion must satisfy, whatever solved it."""

import numpy as np
import pytest
from kinds import Kind
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
def motion(kind: Kind, model: absolute.Model) -> absolute.Solution:
    return absolute.solve(model, kind.inputs(TIMES), conditions=True)


def along(a: Array, b: Array) -> Array:
    return np.linalg.norm(a - b, axis=-1)


def test_condition_number_is_what_the_tolerances_assume(motion: absolute.Solution) -> None:
    assert motion.condition is not None
    assert motion.condition.max() < CONDITION


def test_bodies_keep_the_distances_of_the_drawing(model: absolute.Model, motion: absolute.Solution) -> None:
    for body in set(model.moving) - model.aids:
        for a in model.bodies[body]:
            for b in model.bodies[body]:
                drawn = np.linalg.norm(np.subtract(model.points[a], model.points[b]))
                # Two points of one pose: rounding of rotation and sum, no solver error.
                assert np.allclose(
                    along(motion.position[a], motion.position[b]), drawn, rtol=0, atol=16 * EPS * SIZE
                )


def test_shared_points_are_where_every_body_holds_them(
    kind: Kind, model: absolute.Model, motion: absolute.Solution
) -> None:
    # Distances across joints: each point is read from one body, its joints tie it to the others.
    for a, b in kind.held:
        drawn = np.linalg.norm(np.subtract(model.points[a], model.points[b]))
        assert np.allclose(along(motion.position[a], motion.position[b]), drawn, rtol=0, atol=ROUNDING)


def test_inputs_are_met(kind: Kind, model: absolute.Model, motion: absolute.Solution) -> None:
    p, inputs = motion.position, kind.inputs(TIMES)
    d51 = np.linalg.norm(np.subtract(model.points["lower_ball_joint"], model.points["lower_arm_front"]))
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
def test_rates_are_derivatives_over_time(kind: Kind, model: absolute.Model, middle: float) -> None:
    step = 4e-3
    motion = absolute.solve(model, kind.inputs(middle + step * np.arange(-4, 5)))
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
    model: absolute.Model, motion: absolute.Solution
) -> None:
    for body in set(model.moving) - model.aids:
        spin, spin1 = motion.angular_velocity[body], motion.angular_acceleration[body]
        first, *others = model.bodies[body]
        for other in others:
            arm = motion.position[other] - motion.position[first]
            turning = np.cross(spin, arm)
            velocity = motion.velocity[other] - motion.velocity[first]
            # The two ends may be read from two bodies joined there: the solver's rounding counts.
            assert np.allclose(velocity, turning, rtol=0, atol=ROUNDING)
            acceleration = motion.acceleration[other] - motion.acceleration[first]
            bent = np.cross(spin1, arm) + np.cross(spin, turning)
            assert np.allclose(acceleration, bent, rtol=0, atol=ROUNDING)


def test_chassis_motion_is_added_to_every_point(kind: Kind, model: absolute.Model) -> None:
    chassis = np.random.default_rng(1).normal(size=(len(TIMES), 3, 3)) * 50.0
    still = absolute.solve(model, kind.inputs(TIMES))
    heaving = absolute.solve(model, kind.inputs(TIMES), chassis=chassis)
    for name in model.points:
        # One addition to numbers of order 1000.
        for k, (a, b) in enumerate(
            (
                (still.position, heaving.position),
                (still.velocity, heaving.velocity),
                (still.acceleration, heaving.acceleration),
            )
        ):
            assert np.allclose(b[name], a[name] + chassis[:, k], rtol=0, atol=4 * EPS * 1000)
    for body in set(model.moving) - model.aids:
        assert (heaving.angular_velocity[body] == still.angular_velocity[body]).all()


def test_an_instant_does_not_depend_on_the_instants_before_it(kind: Kind, model: absolute.Model) -> None:
    sweep = absolute.solve(model, kind.inputs(TIMES))
    backwards = absolute.solve(model, kind.inputs(TIMES[::-1].copy()))
    for name in model.points:
        assert np.allclose(sweep.position[name], backwards.position[name][::-1], rtol=0, atol=2 * ROUNDING)


def test_positions_alone_leave_the_rates_out(kind: Kind, model: absolute.Model) -> None:
    full, bare = (
        absolute.solve(model, kind.inputs(TIMES)),
        absolute.solve(model, kind.inputs(TIMES), rates=False),
    )
    assert not bare.velocity
    assert not bare.acceleration
    assert not bare.angular_velocity
    assert not bare.angular_acceleration
    assert bare.condition is None
    for name in model.points:
        assert (bare.position[name] == full.position[name]).all()


def test_no_instants_give_an_empty_motion(model: absolute.Model) -> None:
    motion = absolute.solve(model, {"arm_angle": np.zeros((0, 3)), "rack": np.zeros((0, 3))})
    assert motion.position["wheel_centre"].shape == (0, 3)
