"""Which inputs are allowed, and the errors for the others."""

from __future__ import annotations

import math
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from mechanism_drawings import CARS
from mpmath import mpf

from validate.reference import NoReferenceError
from validate.reference.exact import as_fraction

STRUT, STILL = CARS["collinear strut"], {"arm_angle": (1.5, 0, 0)}


@pytest.mark.parametrize(
    "value",
    [0.1, np.float64(0.1), np.float32(0.1), mpf(0.1), Fraction(1, 3), Decimal("0.1"), 3, -1e-320],
)
def test_every_kind_of_number_is_taken_exactly(value: Any) -> None:
    assert as_fraction(value, "it") == Fraction(*(int(part) for part in value.as_integer_ratio()))
    assert as_fraction(np.int64(3), "it") == 3


@pytest.mark.parametrize("value", [math.nan, math.inf, mpmath.inf, mpmath.nan, "1", None, 1j, Decimal("nan")])
def test_what_is_not_a_finite_real_number_is_refused_by_name(value: object) -> None:
    with pytest.raises(NoReferenceError, match=r"rack is .*; allowed: a finite real number"):
        as_fraction(value, "rack")


def test_no_more_digits_are_promised_than_the_arithmetic_has() -> None:
    with pytest.raises(NoReferenceError, match="15 to 200"):
        STRUT.solve(STILL, digits=1000)


@pytest.mark.parametrize(
    ("name", "other", "message"),
    [
        ("strut_rod_end", "strut_top", "length of strut_rod"),
        ("strut_lower", "strut_top", "strut_top is in the place of strut_lower"),
        ("lower_arm_rear", "lower_arm_front", "hinge of lower_arm"),
        ("strut_top", "", "finite real number"),
    ],
)
def test_a_mechanism_without_extent_is_refused(name: str, other: str, message: str) -> None:
    car = CARS["strut as drawn"]
    with pytest.raises(NoReferenceError, match=message):
        replace(car, moved={name: car.points.get(other, (460, -180, math.inf))}).solve(STILL)


def test_an_angle_that_is_undefined_is_left_out_and_the_others_are_not() -> None:
    reference = replace(STRUT, moved={"wheel_centre": STRUT.points["strut_lower"]}).solve(STILL)
    assert abs(reference.effects["kingpin"]) < 1
    assert "camber" not in reference.effects


def test_an_effect_that_does_not_exist_is_refused_by_name() -> None:
    with pytest.raises(NoReferenceError, match="effect is 'scrub'"):
        STRUT.solve(STILL, effects=["scrub"])
