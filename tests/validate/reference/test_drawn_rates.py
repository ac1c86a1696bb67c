"""Rates of the drawn strut against differences of a closed form that the package does not know."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from off_axis_cars import (
    BASE,
    PHASES,
    OffAxisCar,
    Points,
    closing,
    drawn_pose,
    numbers,
    off_axis_cars,
    size,
)

from validate.reference import solve_reference
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

CAR = OffAxisCar(closing(BASE, Fraction(1, 2), Fraction(230), (0, 1, 0)), (0, 0, 1), (0, 1, 0))
STEP = mpf("1e-10")
# Central differences of seven points: of the first and of the second derivative.
FIRST = {1: Fraction(3, 4), 2: Fraction(-3, 20), 3: Fraction(1, 60)}
SECOND = {1: Fraction(3, 2), 2: Fraction(-3, 20), 3: Fraction(1, 90)}
# They are off by STEP^6 of the seventh and eighth derivative, which are below 1e20 here; the closed form's
# rounding, 1e-145, is divided by STEP^2.
OFF = mpf("1e-38")
BODY = ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner")

rates = st.fractions(-3, 3, max_denominator=16)


def derivatives(ahead: list[Vector], now: Vector, behind: list[Vector]) -> tuple[Vector, Vector]:
    """x' and x'' from values at 1, 2, 3 steps ahead and behind."""
    zero = (mpf(0), mpf(0), mpf(0))
    rate, bend = zero, zero
    for n, (a, b) in enumerate(zip(ahead, behind, strict=True), start=1):
        first, second = numbers((FIRST[n], SECOND[n], 0))[:2]
        rate = plus(rate, times(minus(a, b), first / STEP))
        bend = plus(bend, times(minus(plus(a, b), times(now, 2)), second / STEP**2))
    return rate, bend


def close(a: Vector, b: Vector, limit: mpf) -> bool:
    return all(abs(x) < limit for x in minus(a, b))


@given(car=off_axis_cars(), law=st.tuples(*[rates] * 6), heave=st.tuples(*[rates] * 3))
@settings(max_examples=15, deadline=None, phases=PHASES)
def test_velocities_and_accelerations_are_the_derivatives_of_the_closed_form(
    car: OffAxisCar, law: tuple[Fraction, ...], heave: tuple[Fraction, ...]
) -> None:
    theta, rack = car.drawn
    w, a, v, b, *_ = numbers(law[:3]) + numbers(law[3:])
    values = {
        "arm_angle": (theta + w / 64, w, a),
        "rack": (rack + 8 * v, 40 * v, 30 * b),
        "heave": tuple(10 * x for x in numbers(heave)),
    }

    def at(t: mpf) -> Points | None:
        inputs = [x + y * t + z * t * t / 2 for x, y, z in values.values()]
        pose = drawn_pose(car, *inputs)
        return None if pose is None else pose.points

    moments = {n: at(n * STEP) for n in range(-3, 4)}
    assume(None not in moments.values())
    reference = solve_reference(car.points, values, **car.frame, closure="drawn", digits=100)
    assume(reference.condition < 1e4)  # next to a dead point the eighth derivative is no longer small
    for name in car.points:
        ahead, behind = ([moments[s * n][name] for n in (1, 2, 3)] for s in (1, -1))
        rate, bend = derivatives(ahead, moments[0][name], behind)
        assert close(reference.velocity[name], rate, OFF)
        assert close(reference.acceleration[name], bend, OFF)


@given(car=off_axis_cars(), law=st.tuples(*[rates] * 6))
@settings(max_examples=15, deadline=None, phases=PHASES)
def test_one_turn_explains_all_points_of_the_knuckle_and_the_slide_the_strut_top(
    car: OffAxisCar, law: tuple[Fraction, ...]
) -> None:
    theta, rack = car.drawn
    inputs = {"arm_angle": (theta, *law[:2]), "rack": (rack, *law[2:4]), "heave": (0, *law[4:])}
    now = solve_reference(car.points, inputs, **car.frame, closure="drawn")
    for body, points in {
        "knuckle": BODY,
        "lower_arm": ("lower_arm_front", "lower_arm_rear", "lower_ball_joint"),
    }.items():
        omega, alpha = now.angular_velocity[body], now.angular_acceleration[body]
        for name in points[1:]:
            r, v, a = (minus(q[name], q[points[0]]) for q in (now.position, now.velocity, now.acceleration))
            assert close(v, cross(omega, r), mpf("1e-45"))
            assert close(a, plus(cross(alpha, r), cross(omega, cross(omega, r))), mpf("1e-45"))
    # What moves in the knuckle's frame is the strut top, and it moves along the axis.
    top, lower = "strut_top", "strut_lower"
    r, v = (minus(q[top], q[lower]) for q in (now.position, now.velocity))
    seen = minus(v, cross(now.angular_velocity["knuckle"], r))
    assert size(cross(seen, r)) < mpf("1e-42")


@pytest.mark.parametrize("t", ["0", "0.3"])
def test_the_angular_acceleration_is_the_derivative_of_the_angular_velocity(t: str) -> None:
    def at(moment: mpf) -> tuple[Vector, Vector]:
        sine, cosine = mpmath.sin(7 * moment), mpmath.cos(7 * moment)
        arm = (mpf("1.5") + sine / 10, 7 * cosine / 10, -49 * sine / 10)
        rack = (230 + 40 * moment, 40 - 300 * moment, -300)
        rack = (230 + 40 * moment - 150 * moment**2, rack[1], rack[2])
        now = solve_reference(CAR.points, {"arm_angle": arm, "rack": rack}, closure="drawn", digits=100)
        return now.angular_velocity["knuckle"], now.angular_acceleration["knuckle"]

    turns = {n: at(mpf(t) + n * STEP) for n in range(-3, 4)}
    ahead, behind = ([turns[s * n][0] for n in (1, 2, 3)] for s in (1, -1))
    assert close(derivatives(ahead, turns[0][0], behind)[0], turns[0][1], OFF)


def test_steering_turns_the_knuckle_about_the_line_of_ball_joint_and_strut_top() -> None:
    inputs = {"arm_angle": (1.5, 0, 0), "rack": (230, 100, 0)}
    now = solve_reference(CAR.points, inputs, closure="drawn")
    omega = now.angular_velocity["knuckle"]
    axis = minus(now.position["strut_top"], now.position["lower_ball_joint"])
    assert size(omega) > mpf("0.5")
    assert size(cross(omega, axis)) < mpf("1e-55")
    strut = minus(now.position["strut_top"], now.position["strut_lower"])
    assert abs(dot(omega, strut)) < size(omega) * size(strut)
    assert size(cross(omega, strut)) / (size(omega) * size(strut)) > mpf("0.01")  # and not about the strut's
