"""Derivatives by the inputs against differences of proven instants."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import InfeasibleError, Instant
from validate.reference.dual import Dual
from validate.reference.effects.registry import OF_POSITIONS
from validate.reference.vectors import minus, times

ORDERS = ("value", "rate", "acceleration")
QUANTITIES = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")
STEP = Fraction(1, 10**22)


@pytest.mark.parametrize("name", ["arm_angle", "rack", "heave"])
@pytest.mark.parametrize("order", range(3))
def test_sensitivities_are_the_derivatives_of_every_quantity(
    car: ReferenceCar, name: str, order: int
) -> None:
    slope = car.sensitivities()[name, ORDERS[order]]

    def at(sign: int) -> Instant:
        moved = list(car.inputs[name])
        moved[order] += sign * STEP
        return car.solve({**car.inputs, name: moved}, digits=100, effects=OF_POSITIONS)

    ahead, behind = at(1), at(-1)
    per = mpf(STEP.denominator) / 2
    # A central difference is off by STEP^2 / 6 of the third derivative, here below 1e6.
    off = mpf("1e-38")
    for quantity in QUANTITIES:
        for one, got in getattr(slope, quantity).items():
            pair = (getattr(moment, quantity)[one] for moment in (ahead, behind))
            want = times(minus(*pair), per)
            assert all(abs(x) <= off + slope.error_bound[quantity] for x in minus(got, want))
        assert slope.error_bound[quantity] < mpf("1e-60")
    assert set(slope.effects) | {"damper_length"} == set(OF_POSITIONS)  # some of these cars have none
    for one, got in slope.effects.items():
        assert (
            abs(got - (ahead.effects[one] - behind.effects[one]) * per) <= off + slope.error_bound["effects"]
        )


def test_an_input_that_cannot_be_reached_has_no_sensitivities(car: ReferenceCar) -> None:
    with pytest.raises(InfeasibleError):
        replace(car, inputs={"arm_angle": (3, 0, 0)}).sensitivities()


def test_an_effect_that_is_undefined_has_no_sensitivity(car: ReferenceCar) -> None:
    inner, centre = car.wheel_axis
    slope = replace(car, points={**car.points, centre: car.points[inner]}).sensitivities()["rack", "value"]
    assert "kingpin" in slope.effects
    assert "camber" not in slope.effects


def test_a_dual_differentiates_a_rational_function_exactly() -> None:
    x = Dual(Fraction(5), Fraction(1))
    # f = (x^2 + 3) / (2 - x) - 1 / x,  f' = (2 x (2 - x) + x^2 + 3) / (2 - x)^2 + 1 / x^2.
    assert (3 + x * x) / (2 - x) - 1 / x == Dual(
        Fraction(28, -3) - Fraction(1, 5), Fraction(-2, 9) + Fraction(1, 25)
    )
