"""Derivatives by the inputs against differences of proven instants."""

from __future__ import annotations

from fractions import Fraction

import pytest
from mpmath import mpf
from reference_cars import OFF_AXIS as POINTS

from validate.reference import InfeasibleError, Instant, sensitivities, solve_reference
from validate.reference.dual import Dual
from validate.reference.effects.registry import EFFECTS
from validate.reference.vectors import minus, times

INPUTS = {
    "arm_angle": (Fraction(3, 2), Fraction(2), Fraction(-3)),
    "rack": (Fraction(240), Fraction(150), Fraction(-400)),
    "heave": (Fraction(5), Fraction(-60), Fraction(700)),
}
ORDERS = ("value", "rate", "acceleration")
QUANTITIES = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")
STEP = Fraction(1, 10**22)


@pytest.mark.parametrize("closure", ["drawn", "collinear"])
@pytest.mark.parametrize("name", INPUTS)
@pytest.mark.parametrize("order", range(3))
def test_sensitivities_are_the_derivatives_of_every_quantity(closure: str, name: str, order: int) -> None:
    slope = sensitivities(POINTS, INPUTS, side="right", closure=closure)[name, ORDERS[order]]

    def at(sign: int) -> Instant:
        moved = list(INPUTS[name])
        moved[order] += sign * STEP
        return solve_reference(POINTS, {**INPUTS, name: moved}, side="right", digits=100, closure=closure)

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
    assert set(slope.effects) == set(EFFECTS)
    for one, got in slope.effects.items():
        assert (
            abs(got - (ahead.effects[one] - behind.effects[one]) * per) <= off + slope.error_bound["effects"]
        )


def test_an_input_that_cannot_be_reached_has_no_sensitivities() -> None:
    with pytest.raises(InfeasibleError):
        sensitivities(POINTS, {"arm_angle": (3, 0, 0), "rack": (230, 0, 0)}, closure="drawn")


def test_an_angle_that_is_undefined_has_no_sensitivity() -> None:
    inner = {**POINTS, "wheel_axis_inner": POINTS["wheel_centre"]}
    slope = sensitivities(inner, INPUTS, closure="drawn")["rack", "value"]
    assert "kingpin" in slope.effects
    assert "camber" not in slope.effects


def test_a_dual_differentiates_a_rational_function_exactly() -> None:
    x = Dual(Fraction(5), Fraction(1))
    # f = (x^2 + 3) / (2 - x) - 1 / x,  f' = (2 x (2 - x) + x^2 + 3) / (2 - x)^2 + 1 / x^2.
    assert (3 + x * x) / (2 - x) - 1 / x == Dual(
        Fraction(28, -3) - Fraction(1, 5), Fraction(-2, 9) + Fraction(1, 25)
    )
