"""What programs are told of a mechanism, and what none of them holds or drives."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mechanism_files import mechanism_file, plain, plain_scene
from relative_cars import plain_car
from sample_cars import SAMPLES, SampleCar, by_car

from validate.peers.errors import PeerError
from validate.peers.linkage import Driven, linkage_of
from validate.spanning_tree.cut import CHASSIS, Drive, Place

EPS = float(np.finfo(float).eps)


@by_car
def test_the_drawing_is_driven_by_nothing(car: SampleCar) -> None:
    linkage = linkage_of(plain_car(car))
    laws = {name: np.array([[value, 0.0, 0.0]]) for name, value in car.drawn_inputs.items()}
    inputs = linkage.inputs(laws)
    # The angle is rounded, and so is its cosine.
    assert (np.abs(inputs.driven - linkage.drawn_inputs) <= 16.0 * EPS).all()
    assert np.abs(linkage.drawn_inputs).max() < 1e-15 or car.closure == "collinear"


@given(st.floats(0.1, 3.0), st.floats(-3.0, 3.0), st.floats(-9.0, 9.0), st.sampled_from(["angle", "travel"]))
def test_rates_of_a_driven_coordinate_are_its_derivatives(
    value: float, rate: float, bend: float, kind: Any
) -> None:
    still = Place(CHASSIS, np.zeros(3))
    drive = Drive("it", kind, still, still, np.array([0.0, 0.0, 1.0]), CHASSIS, 1.0, 0.0)
    driven, step = Driven("it", drive, 0.4, 0.1), 1e-3
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
    with pytest.raises(PeerError, match="lower_arm_front is where lower_arm_rear is"):
        linkage_of(plain_car(strut, lower_arm_rear=strut.points["lower_arm_front"]))
    with pytest.raises(PeerError, match="strut_lower is where strut_top is"):
        linkage_of(plain_car(strut, strut_lower=strut.points["strut_top"]))


def test_an_angle_outside_half_a_turn_is_refused_at_its_instant() -> None:
    theta = np.stack([np.linspace(1.6, 0.1, 5), np.zeros(5), np.zeros(5)], axis=-1)
    theta[2, 0] = 3.2
    with pytest.raises(PeerError, match="arm_angle is outside 0 to pi") as caught:
        linkage_of(plain_car(SAMPLES[1])).inputs({"arm_angle": theta, "rack": np.zeros((5, 3))})
    assert caught.value.instant == 2


def test_what_no_program_drives_or_holds_is_refused_with_the_reason() -> None:
    tables = mechanism_file("five_link")
    tables["inputs"]["lift"] = {"contact": ["wheel_axis_inner", "wheel_centre"]}
    points = plain_scene("five-link")["points"]
    with pytest.raises(PeerError, match="no program drives lift, the height of a wheel's contact point"):
        linkage_of(plain(tables, {"points": points, "wheel_radius": 300.0, "right": (0, -1, 0)}, ["lift"]))
    tables = mechanism_file("double_wishbone")
    tables["inputs"]["lean"] = {
        "angle": "knuckle",
        "of": "upper_ball_joint",
        "about": "lower_ball_joint",
        "from": "up",
    }
    points = plain_scene("double-wishbone")["points"]
    with pytest.raises(PeerError, match="lean, an angle about a point that moves"):
        linkage_of(plain(tables, {"points": points}, ["lean", "rack"]))
