"""What is counted is right: digits tried, starts, the condition; and everything ends by a count."""

from __future__ import annotations

import pytest
from plain_mechanisms import count_car
from reference_cars import OFF_AXIS

from validate.reference import (
    BadInputError,
    NotDecidedError,
    SingularPoseError,
)
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
