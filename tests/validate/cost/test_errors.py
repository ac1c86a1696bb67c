"""Errors against the reference, number by number; what is missing or no number is no answer."""

from typing import Any

import numpy as np
import pytest

from validate.cost.errors import errors_of, truth_of
from validate.cost.race import Found
from validate.cost.scenes import own_scene, study_instants
from validate.errors import NoAnswer
from validate.formulations.protocol import Numbers

SCENE = own_scene("off-axis-strut")
INSTANTS = study_instants(SCENE, 5)
TRUTH = truth_of(SCENE, INSTANTS)


def right() -> dict[str, dict[str, Any]]:
    """The reference rounded to doubles."""
    return {q: {name: array.copy() for name, array in names.items()} for q, names in TRUTH.numbers.items()}


def found(numbers: Numbers) -> Found:
    return errors_of(numbers, TRUTH)


def test_the_reference_itself_is_off_by_nothing_and_its_radius_is_its_rounding() -> None:
    error = found(right())["position"]
    assert error["error"] == 0.0
    assert 0.0 < error["radius"] <= 0.5 * np.spacing(1024.0)


@pytest.mark.parametrize("quantity", TRUTH.numbers)
def test_a_number_that_is_wrong_by_a_known_amount_has_that_error_in_its_quantity_alone(quantity: str) -> None:
    numbers = right()
    name = list(numbers[quantity])[-1]
    numbers[quantity][name].reshape(len(INSTANTS), -1)[3, -1] += 2.0**-6
    errors = found(numbers)
    assert errors[quantity]["error"] == pytest.approx(2.0**-6, rel=1e-9)
    assert all(error["error"] < 1e-10 for other, error in errors.items() if other != quantity)


@pytest.mark.parametrize(
    ("quantity", "change", "words"),
    [
        (
            "acceleration",
            lambda a: np.where(np.arange(15).reshape(5, 3) == 6, np.nan, a),
            "not finite at 1 of 5",
        ),
        (
            "acceleration",
            lambda a: np.where(np.arange(15).reshape(5, 3) == 6, np.inf, a),
            "first at number 2",
        ),
        ("position", lambda a: a[:-1], r"shape \(4, 3\); allowed: \(5, 3\)"),
        ("velocity", None, "velocity of wheel_centre is not given"),
    ],
)
def test_a_point_that_is_missing_has_other_instants_or_is_no_number_is_no_answer(
    quantity: str, change: Any, words: str
) -> None:
    numbers = right()
    place = numbers[quantity].pop("wheel_centre")
    if change is not None:
        numbers[quantity]["wheel_centre"] = change(place)
    with pytest.raises(NoAnswer, match=words):
        found(numbers)
