"""Drawn inputs and ends of inputs: by the reference, poses exist up to the end and not beyond it."""

import pytest
from cars_in_closed_form import cars_of
from hypothesis import given, settings

from pointcoord import PointcoordError
from validate.cars.car import Car
from validate.cars.input_ends import at, drawn_inputs, end, redrawn
from validate.formulations.reference_solution import design_of
from validate.reference import NoReferenceError, pose_exists

EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 2)  # an end takes 0.1 s
# Share of the range: more than the rounding of the inputs of the redrawn car.
NEAR = 1e-11


@searched
@pytest.mark.parametrize(("driven", "ahead"), [("arm_angle", False), ("rack", True)])
@given(car=cars_of())
def test_an_end_separates_poses_from_none_to_a_hundred_billionth_of_the_range(
    car: Car, driven: str, ahead: bool
) -> None:
    home = drawn_inputs(car)
    try:
        found = end(car, home, driven, ahead)
    except PointcoordError:
        return
    if found is None:
        return
    design = design_of(at(redrawn(car, home), home))
    outwards = (1.0 if ahead else -1.0) * NEAR * found.reach
    inside, outside = (
        {n: (v, 0.0, 0.0) for n, v in (home | {driven: found.value + sign * outwards}).items()}
        for sign in (-1.0, 1.0)
    )
    try:
        assert pose_exists(design, inside)
        assert not pose_exists(design, outside)
    except NoReferenceError:  # a drawing close to another assembly
        return
