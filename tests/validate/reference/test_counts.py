"""What is counted is right: digits tried, starts, the condition; and everything ends by a count."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from plain_mechanisms import count_car
from reference_cars import OFF_AXIS, ReferenceCar

from validate.reference import (
    BadInputError,
    NotDecidedError,
    SingularPoseError,
)
from validate.reference.route import CLEAR, reached
from validate.reference.solve import with_enough_digits


@pytest.mark.parametrize(
    ("digits", "ladder"),
    [(15, [15, 30, 60, 120, 240, 400]), (60, [60, 120, 240, 400]), (200, [200, 400])],
)
def test_digits_are_doubled_up_to_400_and_then_the_pose_is_called_singular(
    digits: int, ladder: list[int]
) -> None:
    tried: list[int] = []

    def never(working: int) -> int:
        tried.append(working)
        raise NotDecidedError("a claim", "0", "not 0")

    with pytest.raises(SingularPoseError, match="400 digits"):
        with_enough_digits(never, digits)
    assert tried == ladder


@pytest.mark.parametrize("starts", [0, -1])
def test_a_search_needs_a_start(starts: int) -> None:
    with pytest.raises(BadInputError, match=f"starts is {starts}; allowed is at least 1"):
        count_car(OFF_AXIS, {"arm_angle": (1.5, 0, 0)}, starts=starts, closure="drawn")


@pytest.mark.parametrize("turn", [Fraction(-1, 5), Fraction(0), Fraction(1, 5)])
def test_the_condition_is_numpy_s_in_the_maximum_norm_of_the_scaled_rows(
    car: ReferenceCar, turn: Fraction
) -> None:
    angle = car.inputs["arm_angle"][0] + turn
    reference = car.solve({**car.still, "arm_angle": (angle, 0, 0)})
    known = car.known(arm_angle=angle)
    y = reached(car.design, CLEAR, car.design.driven({**car.still, "arm_angle": (angle, 0, 0)})).pose.unknown
    matrix = np.array(known.matrix(y).tolist(), dtype=float)
    scaled = matrix / np.abs(matrix).sum(axis=1, keepdims=True)
    # numpy's inverse is off by about eps times the condition, which is below 1e4 here.
    assert reference.condition < 1e4
    assert reference.condition == pytest.approx(float(np.linalg.cond(scaled, np.inf)), rel=1e-10)
