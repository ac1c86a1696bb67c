"""Velocities, accelerations and turning against differences of certified positions."""

from __future__ import annotations

import itertools
from fractions import Fraction
from typing import Any

import pytest
from mpmath import mpf

from validate.reference import Instant, solve_reference, time_function_value
from validate.reference.vectors import cross, dot, minus, plus

Table = dict[str, tuple[int, int, int]]
STEP = Fraction(1, 10**12)

MOTIONS: dict[str, dict[str, dict[str, Any]]] = {
    "bounce": {"arm_angle": {"polynomial": [0.8, 0.25, 0.0625]}},
    "steer": {"arm_angle": {"constant": 1.5707963267948966}, "rack": {"polynomial": [0, 150, 25]}},
    "all": {
        "arm_angle": {"sine": {"offset": 1.5, "amplitude": 0.4, "angular_frequency": 7.0, "phase": 0.3}},
        "rack": {"polynomial": [5.0, 40.0, -300.0, 200.0]},
        "heave": {"sine": {"amplitude": 30.0, "angular_frequency": 9.0}},
    },
}


def at(table: Table, motion: dict[str, dict[str, Any]], t: Fraction) -> Instant:
    return solve_reference(
        table,
        {name: time_function_value(f, t, 100) for name, f in motion.items()},
        digits=90,
        closure="collinear",
    )


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("t", [Fraction(0), Fraction(3, 10)])
def test_rates_of_every_point_are_the_derivatives_of_its_certified_positions(
    table: Table, motion: str, t: Fraction
) -> None:
    before, now, after = (at(table, MOTIONS[motion], t + n * STEP) for n in (-1, 0, 1))
    h = mpf(STEP.numerator) / STEP.denominator
    for name in table:
        for i in range(3):
            a, b, c = (moment.position[name][i] for moment in (before, now, after))
            # The differences are off by h^2 / 6 of the third and h^2 / 12 of the fourth derivative.
            assert abs((c - a) / (2 * h) - now.velocity[name][i]) < mpf("1e-17")
            assert abs((a - 2 * b + c) / h**2 - now.acceleration[name][i]) < mpf("1e-15")


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_angular_acceleration_is_the_derivative_of_the_angular_velocity(
    table: Table, motion: str
) -> None:
    before, now, after = (at(table, MOTIONS[motion], Fraction(1, 5) + n * STEP) for n in (-1, 0, 1))
    h = mpf(STEP.numerator) / STEP.denominator
    for body in ("knuckle", "lower_arm"):
        rates = zip(before.angular_velocity[body], after.angular_velocity[body], strict=True)
        for (a, c), alpha in zip(rates, now.angular_acceleration[body], strict=True):
            assert abs((c - a) / (2 * h) - alpha) < mpf("1e-18")


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize(
    ("body", "points"),
    [
        ("knuckle", ("lower_ball_joint", "tie_rod_outer", "strut_lower", "wheel_centre")),
        ("lower_arm", ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")),
    ],
)
def test_one_turn_explains_all_points_of_a_body(
    table: Table, motion: str, body: str, points: tuple[str, ...]
) -> None:
    now = at(table, MOTIONS[motion], Fraction(1, 4))
    omega, alpha = now.angular_velocity[body], now.angular_acceleration[body]
    for name in points[1:]:
        r, v, a = (minus(q[name], q[points[0]]) for q in (now.position, now.velocity, now.acceleration))
        turned = cross(omega, r)
        assert all(abs(x) < mpf("1e-80") for x in minus(v, turned))
        bent = plus(cross(alpha, r), cross(omega, turned))
        assert all(abs(x) < mpf("1e-80") for x in minus(a, bent))


def test_heave_alone_carries_everything_and_turns_nothing(table: Table) -> None:
    rest = solve_reference(table, {"arm_angle": (1.5, 0, 0)}, closure="collinear")
    lifted = solve_reference(
        table, {"arm_angle": (1.5, 0, 0), "heave": (12.5, 3.0, -7.0)}, closure="collinear"
    )
    for name in table:
        moved = minus(lifted.position[name], rest.position[name])
        assert max(abs(x) for x in minus(moved, (0, 0, 12.5))) <= 2 * rest.radius
        assert max(abs(x) for x in minus(lifted.velocity[name], (0, 0, 3))) < mpf("1e-57")
        assert max(abs(x) for x in minus(lifted.acceleration[name], (0, 0, -7))) < mpf("1e-57")
    assert all(abs(x) < mpf("1e-57") for x in lifted.angular_velocity["knuckle"])


def test_a_car_at_rest_has_rates_of_exactly_zero(table: Table) -> None:
    rest = solve_reference(table, {"arm_angle": (1.5, 0, 0)}, closure="collinear")
    assert {x for v in (*rest.velocity.values(), *rest.acceleration.values()) for x in v} == {0}
    assert set(rest.angular_velocity["knuckle"]) == {0}


def test_steering_turns_the_knuckle_about_the_axis_5_4_at_1_46_rad_per_s(table: Table) -> None:
    start = at(table, MOTIONS["steer"], Fraction(0))
    omega = start.angular_velocity["knuckle"]
    axis = minus(start.position["strut_top"], start.position["lower_ball_joint"])
    size = dot(omega, omega) ** mpf("0.5")
    assert size == pytest.approx(1.463, abs=5e-4)
    sine = dot(cross(omega, axis), cross(omega, axis)) ** mpf("0.5") / size / dot(axis, axis) ** mpf("0.5")
    assert sine < mpf("1e-80")


def test_the_printed_quotient_for_omega_is_0_over_0_in_the_steering_scene(table: Table) -> None:
    now = at(table, MOTIONS["steer"], Fraction(1, 5))
    v5 = now.velocity["lower_ball_joint"]
    v65, v75 = minus(now.velocity["tie_rod_outer"], v5), minus(now.velocity["strut_lower"], v5)
    r75 = minus(now.position["strut_lower"], now.position["lower_ball_joint"])
    assert abs(dot(v65, r75)) < mpf("1e-75")
    assert max(abs(x) for x in cross(v65, v75)) < mpf("1e-75")
    assert dot(now.angular_velocity["knuckle"], now.angular_velocity["knuckle"]) > 2


def test_the_steering_rate_grows_slowly_where_the_printed_column_jumps(table: Table) -> None:
    sizes = []
    for step in range(9):
        omega = at(table, MOTIONS["steer"], Fraction(step, 20)).angular_velocity["knuckle"]
        sizes.append(float(dot(omega, omega) ** mpf("0.5")))
    ratios = [b / a for a, b in itertools.pairwise(sizes)]
    assert all(1 < ratio < 1.1 for ratio in ratios)
