"""Errors against the reference are exact to their own digits, however far below the rounding of a double."""

from fractions import Fraction

import numpy as np
import pytest
from toy_ways import reference_numbers

from validate.cost.errors import errors_of, truth_of
from validate.cost.race import Found
from validate.cost.scenes import own_scene, study_instants
from validate.cost.way import Answer, NoNumbers
from validate.formulations.protocol import Numbers
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.reference.exact import as_fraction

SCENE = own_scene("off-axis-strut")
INSTANTS = study_instants(SCENE, 5)
TRUTH = truth_of(SCENE, INSTANTS)
MOVING = [n for n in SCENE.mechanism.topology.points if n not in SCENE.mechanism.topology.chassis]


def found(numbers: Numbers) -> Found:
    return errors_of(Answer(numbers), TRUTH)


def exact_errors(numbers: dict[str, np.ndarray]) -> list[Fraction]:
    """Positions less the reference's digits, as fractions."""
    found = []
    for i, t in enumerate(INSTANTS.tolist()):
        instant = reference_instant(SCENE, inputs_at(SCENE, t))
        for name in MOVING:
            for mine, right in zip(numbers[name][i].tolist(), instant.position[name], strict=True):
                found.append(abs(Fraction(mine) - as_fraction(right, name)))
    return found


@pytest.mark.parametrize("ulps", [0, 1, 1000])
def test_the_error_of_a_double_is_its_distance_from_the_reference_in_many_digits(ulps: int) -> None:
    numbers = reference_numbers(SCENE, INSTANTS)
    places = numbers["position"]
    for array in places.values():
        array += ulps * np.spacing(array)
    error = found(numbers)["position"]
    exact = exact_errors(places)
    rms = float(sum(e * e for e in exact) / len(exact)) ** 0.5
    # Two doubles know the reference to 2^-106 of 1000 mm, 1e-29 mm; the difference rounds by 2^-53 of itself.
    assert error["error"] == pytest.approx(float(max(exact)), rel=3e-16, abs=1e-29)
    assert error["rms"] == pytest.approx(rms, rel=1e-14, abs=1e-29)
    assert error["numbers"] == len(exact)
    if ulps == 0:  # the reference itself, rounded, is off by at most half a unit in the last place
        assert 0.0 < error["error"] <= 0.5 * np.spacing(1000.0)


@pytest.mark.parametrize("quantity", TRUTH.exact)
def test_a_number_that_is_wrong_by_a_known_amount_has_that_error_in_its_quantity_alone(quantity: str) -> None:
    numbers = reference_numbers(SCENE, INSTANTS)
    name = list(numbers[quantity])[-1]
    numbers[quantity][name].reshape(len(INSTANTS), -1)[3, -1] += 2.0**-6
    errors = found(numbers)
    assert errors[quantity]["error"] == pytest.approx(2.0**-6, rel=1e-9)
    assert errors[quantity]["rms"] == pytest.approx(2.0**-6 / errors[quantity]["numbers"] ** 0.5, rel=1e-9)
    assert all(error["error"] < 1e-10 for other, error in errors.items() if other != quantity)


def test_a_point_that_is_missing_or_has_other_instants_is_no_answer() -> None:
    numbers = reference_numbers(SCENE, INSTANTS)
    del numbers["velocity"]["wheel_centre"]
    with pytest.raises(NoNumbers, match="gives no velocity of wheel_centre"):
        found(numbers)
    numbers = reference_numbers(SCENE, INSTANTS)
    numbers["position"]["wheel_centre"] = numbers["position"]["wheel_centre"][:-1]
    with pytest.raises(NoNumbers, match=r"shape \(4, 3\), not \(5, 3\)"):
        found(numbers)


@pytest.mark.parametrize(("quantity", "bad"), [("position", np.nan), ("acceleration", np.inf)])
def test_what_is_no_number_is_no_answer(quantity: str, bad: float) -> None:
    numbers = reference_numbers(SCENE, INSTANTS)
    name = next(iter(numbers[quantity]))
    numbers[quantity][name].reshape(len(INSTANTS), -1)[2, 0] = bad
    words = f"of {name} is no finite number at 1 of 5 instants, first at number 2"
    with pytest.raises(NoNumbers, match=words):
        found(numbers)
