"""What programs are told of a mechanism, and what none of them holds or drives."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from relative_cars import plain_car
from sample_cars import SAMPLES, SampleCar, by_car

from validate.peers.errors import HardpointsError, InputError
from validate.peers.linkage import linkage_of
from validate.spanning_tree.cut import Driven

EPS = float(np.finfo(float).eps)


@by_car
def test_the_drawing_is_driven_by_nothing(car: SampleCar) -> None:
    linkage = linkage_of(plain_car(car))
    laws = {name: np.array([[value, 0.0, 0.0]]) for name, value in car.drawn_inputs.items()}
    # The angle is rounded, and so is its cosine.
    driven = linkage.coordinates(linkage.inputs(laws).series)[0, :, 0]
    assert (np.abs(driven) <= 16.0 * EPS).all() or car.closure == "collinear"


@given(st.floats(0.1, 3.0), st.floats(-3.0, 3.0), st.floats(-9.0, 9.0), st.sampled_from(["angle", "length"]))
def test_rates_of_a_driven_coordinate_are_its_derivatives(
    value: float, rate: float, bend: float, kind: Any
) -> None:
    driven, step = Driven("it", kind, 0.0, "body", 0.4, 0.1), 1e-3
    t = step * np.arange(-2.0, 3.0)
    law = np.stack([value + rate * t + bend * t * t / 2.0, rate + bend * t, np.full(5, bend)], axis=-1)
    x = driven.coordinate(law)
    first = (x[0, 0] - 8.0 * x[1, 0] + 8.0 * x[3, 0] - x[4, 0]) / (12.0 * step)
    second = (-x[0, 0] + 16.0 * x[1, 0] - 30.0 * x[2, 0] + 16.0 * x[3, 0] - x[4, 0]) / (12.0 * step**2)
    # step^4 of fifth derivatives, below 1e4; rounding over step and step^2.
    assert x[2, 1] == pytest.approx(first, abs=1e-7)
    assert x[2, 2] == pytest.approx(second, abs=1e-6)


def test_what_makes_no_mechanism_is_told_by_name() -> None:
    strut = SAMPLES[1]
    with pytest.raises(HardpointsError, match="lower_arm_front is where lower_arm_rear is"):
        linkage_of(plain_car(strut, lower_arm_rear=strut.points["lower_arm_front"]))
    with pytest.raises(HardpointsError, match="strut_lower is where strut_top is"):
        linkage_of(plain_car(strut, strut_lower=strut.points["strut_top"]))


def test_an_angle_outside_half_a_turn_is_refused_at_its_instant() -> None:
    theta = np.stack([np.linspace(1.6, 0.1, 5), np.zeros(5), np.zeros(5)], axis=-1)
    theta[2, 0] = 3.2
    with pytest.raises(InputError, match="an angle from 0 to pi") as caught:
        linkage_of(plain_car(SAMPLES[1])).inputs({"arm_angle": theta, "rack": np.zeros((5, 3))})
    assert caught.value.instant == 2
