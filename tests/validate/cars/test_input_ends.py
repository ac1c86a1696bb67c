"""Where inputs end: as the closed forms say, and as a search finds that goes through every place."""

import pytest
from cars_in_closed_form import DRIVEN, Linkage, cars_of
from hypothesis import given, settings

from pointcoord import PointcoordError
from validate.cars.car import Car
from validate.cars.input_ends import drawn_inputs, end

EXAMPLES = settings.default.max_examples if settings.default else 100
searched = settings(max_examples=EXAMPLES if EXAMPLES > 100 else 10)  # an end takes 0.1 s


@given(cars_of())
def test_a_drawing_stands_where_the_closed_form_says(car: Car) -> None:
    home = Linkage.of(car).home
    for name, value in drawn_inputs(car).items():
        assert value == pytest.approx(home[name], rel=1e-12, abs=1e-10)


@searched
@pytest.mark.parametrize("driven", DRIVEN)
@pytest.mark.parametrize("ahead", [False, True])
@given(car=cars_of())
def test_an_end_is_that_of_the_closed_form_to_a_trillionth_of_the_range(
    car: Car, driven: str, ahead: bool
) -> None:
    linkage, home = Linkage.of(car), drawn_inputs(car)
    exact = linkage.end(home, driven, ahead)
    try:
        found = end(car, home, driven, ahead)
    except PointcoordError:
        return
    # A short fold beside a longer way, such as a dead point just before a lock, is one for the path alone.
    if found is not None and exact is not None and linkage.sound:
        assert abs(found.value - exact[0]) <= 1e-13 * found.reach
