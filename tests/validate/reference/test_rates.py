"""Velocities, accelerations and turning against differences of certified positions."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from exact_time_functions import time_function_value
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import Instant
from validate.reference.vectors import minus

STEP = Fraction(1, 10**12)
ARM, RACK = "arm_angle", "rack"


def motions(car: ReferenceCar) -> dict[str, dict[str, dict[str, Any]]]:
    """Laws of the inputs about those of the car."""
    theta, travel = car.inputs[ARM][0], car.inputs[RACK][0]
    return {
        "bounce": {ARM: {"polynomial": [theta, 0.25, 0.0625]}, RACK: {"constant": travel}},
        "steer": {ARM: {"constant": theta}, RACK: {"polynomial": [travel, 80, 25]}},
        "all": {
            ARM: {"sine": {"offset": theta, "amplitude": 0.1, "angular_frequency": 7.0, "phase": 0.3}},
            RACK: {"polynomial": [travel, 40.0, -300.0, 200.0]},
            "heave": {"sine": {"amplitude": 30.0, "angular_frequency": 9.0}},
        },
    }


MOTIONS = ("bounce", "steer", "all")


def at(car: ReferenceCar, motion: str, t: Fraction) -> Instant:
    inputs = {name: time_function_value(f, t, 100) for name, f in motions(car)[motion].items()}
    return car.solve(inputs, digits=90)


@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("t", [Fraction(0), Fraction(3, 10)])
def test_rates_of_every_point_are_the_derivatives_of_its_certified_positions(
    car: ReferenceCar, motion: str, t: Fraction
) -> None:
    before, now, after = (at(car, motion, t + n * STEP) for n in (-1, 0, 1))
    h = mpf(STEP.numerator) / STEP.denominator
    for name in now.position:
        for i in range(3):
            a, b, c = (moment.position[name][i] for moment in (before, now, after))
            # The differences are off by h^2 / 6 of the third and h^2 / 12 of the fourth derivative.
            assert abs((c - a) / (2 * h) - now.velocity[name][i]) < mpf("1e-17")
            assert abs((a - 2 * b + c) / h**2 - now.acceleration[name][i]) < mpf("1e-15")


@pytest.mark.parametrize("motion", MOTIONS)
def test_the_angular_acceleration_is_the_derivative_of_the_angular_velocity(
    car: ReferenceCar, motion: str
) -> None:
    before, now, after = (at(car, motion, Fraction(1, 5) + n * STEP) for n in (-1, 0, 1))
    h = mpf(STEP.numerator) / STEP.denominator
    for body, alpha in now.angular_acceleration.items():
        rates = zip(before.angular_velocity[body], after.angular_velocity[body], alpha, strict=True)
        for a, c, rate in rates:
            assert abs((c - a) / (2 * h) - rate) < mpf("1e-18")


def test_heave_alone_carries_everything_and_turns_nothing(car: ReferenceCar) -> None:
    rest = car.solve({**car.still, "heave": (0, 0, 0)})
    lifted = car.solve({**car.still, "heave": (12.5, 3.0, -7.0)})
    for name in rest.position:
        moved = minus(lifted.position[name], rest.position[name])
        assert max(abs(x) for x in minus(moved, (0, 0, 12.5))) <= 2 * rest.radius
        assert max(abs(x) for x in minus(lifted.velocity[name], (0, 0, 3))) < mpf("1e-57")
        assert max(abs(x) for x in minus(lifted.acceleration[name], (0, 0, -7))) < mpf("1e-57")
    assert all(abs(x) < mpf("1e-57") for omega in lifted.angular_velocity.values() for x in omega)


def test_a_car_at_rest_has_rates_of_exactly_zero(car: ReferenceCar) -> None:
    rest = car.solve(car.still)
    assert {x for v in (*rest.velocity.values(), *rest.acceleration.values()) for x in v} == {0}
    assert {x for omega in rest.angular_velocity.values() for x in omega} == {0}
