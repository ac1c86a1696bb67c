"""Inputs over the instants become one array, or it is said which of them is wrong, and where."""

from typing import Any

import numpy as np
import pytest

import absolute
from absolute.input_arrays import chassis_series, input_series

NAMES = ("arm_angle", "rack")


def numbers(count: int, first: float) -> np.ndarray:
    return first + np.arange(3.0 * count).reshape(count, 3)


def test_inputs_are_side_by_side_in_the_order_of_the_model() -> None:
    series = input_series(NAMES, {"rack": numbers(4, 100.0), "arm_angle": numbers(4, 0.0)})
    assert series.shape == (4, 3, 2)
    # Value, rate and acceleration of the third instant.
    assert series[2].tolist() == [[6.0, 106.0], [7.0, 107.0], [8.0, 108.0]]


def test_a_chassis_that_is_not_told_to_move_is_at_rest() -> None:
    assert chassis_series(None, 4).tolist() == np.zeros((4, 3, 3)).tolist()
    moving = np.arange(36.0).reshape(4, 3, 3)
    assert chassis_series(moving, 4).tolist() == moving.tolist()


@pytest.mark.parametrize(
    ("inputs", "name", "instant"),
    [
        # Of several that are wrong the first by name.
        ({"arm_angle": numbers(4, 0.0), "rack": numbers(4, 0.0), "y": 0, "x": 0}, "x", None),
        ({}, "arm_angle", None),
        ({"arm_angle": numbers(4, 0.0)}, "rack", None),
        ({"arm_angle": numbers(4, 0.0), "rack": numbers(3, 0.0)}, "rack", None),
        ({"arm_angle": numbers(4, 0.0), "rack": numbers(4, 0.0)[0]}, "rack", None),
        ({"arm_angle": numbers(4, 0.0), "rack": numbers(4, 0.0)[..., None]}, "rack", None),
        ({"arm_angle": numbers(4, 0.0), "rack": [[0, 0, 0], [0, np.nan, 0], [np.inf, 0, 0]]}, "rack", 1),
    ],
)
def test_the_input_at_fault_is_named_with_its_first_bad_instant(
    inputs: dict[str, Any], name: str, instant: int | None
) -> None:
    with pytest.raises(absolute.InputError) as caught:
        input_series(NAMES, inputs)
    assert (caught.value.name, caught.value.instant) == (name, instant)


@pytest.mark.parametrize("shape", [(4, 2, 3), (4, 3, 2), (3, 3, 3), (4, 3), (4, 3, 3, 1)])
def test_a_chassis_motion_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(absolute.InputError) as caught:
        chassis_series(np.zeros(shape), 4)
    assert caught.value.name == "chassis"
