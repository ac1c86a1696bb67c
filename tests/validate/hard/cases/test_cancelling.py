"""Laws whose terms all but cancel leave an ordinary input, and are followed rightly all the same."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import Scene
from validate.formulations.input_rates import rates
from validate.hard.case import Answer, Trial
from validate.hard.cases.cancelling import (
    AMPLITUDES,
    CASES,
    ORDINARY,
    POWERS,
    expanded,
    right_from,
)
from validate.hard.cases.far_and_mixed import heaved_back
from validate.hard.cases.laws import told_as_rough
from validate.hard.family import PAPER

BY_NAME = {case.name: case for case in CASES}


@pytest.mark.parametrize("driven", ["arm_angle", "rack", "heave"])
@pytest.mark.parametrize("amplitude", AMPLITUDES)
def test_what_is_left_of_a_large_swing_is_an_ordinary_input(driven: str, amplitude: float) -> None:
    scene = Scene.from_mapping(
        BY_NAME[f"cancelling-sine-{driven.replace('_', '-')}"].content(1.0 / amplitude)
    )
    value, rate, _ = rates(scene.inputs[driven], np.array([0.0]))[0]
    off, speed = ORDINARY[PAPER.units.get(driven, "mm")]
    wanted = PAPER.home.get(driven, 0.0) + off
    # The offset is rounded by half a unit, as large as the amplitude, and its product by as much again.
    assert abs(value - wanted) <= 2.0 * np.spacing(amplitude + abs(wanted))
    assert rate == pytest.approx(speed, rel=1e-15)


@pytest.mark.parametrize("power", POWERS)
@pytest.mark.parametrize("k", [1, 20])
def test_the_polynomial_is_multiplied_out_exactly(power: int, k: int) -> None:
    start = Fraction(2) ** k
    coefficients = [Fraction(c) for c in expanded(power, float(start))]
    for later in (Fraction(0), Fraction(1, 2), Fraction(1)):
        assert sum(c * (start + later) ** j for j, c in enumerate(coefficients)) == 16 * later**power


@pytest.mark.parametrize("power", POWERS)
def test_twice_the_precision_is_enough_as_far_as_the_case_says(power: int) -> None:
    count = power + 1
    for start, enough in ((1.0 / right_from(power), True), (4.0 / right_from(power), False)):
        size = sum(abs(c) * start**j for j, c in enumerate(expanded(power, start)))
        assert (4.0 * count**2 * 2.0**-106 * size < 16.0 * 2.0**-53) == enough


def test_a_jump_refused_for_another_reason_is_wrong() -> None:
    def told(reason: str) -> str:
        answer = Answer("pointcoord", "refused", reason)
        return told_as_rough(Trial(1e-9, (answer,)), "arm_angle").answers[0].outcome

    assert told("MotionTooRough: input 'arm_angle' changes too fast") == "refused"
    assert told("MotionTooRough: input 'rack' changes too fast") == "wrong"
    assert told("SingularConfiguration: singular configuration at t = 0.5 s") == "wrong"


def test_a_car_heaved_back_stands_where_it_stands_at_home() -> None:
    for value in (1.0, 1e-9):
        content = heaved_back(PAPER, value)
        (back, _), up = content["inputs"]["heave"]["polynomial"], 2
        home = heaved_back(PAPER, float("inf"))["mechanism"]["points"]
        for name, place in content["mechanism"]["points"].items():
            assert Fraction(place[up]) + Fraction(back) == Fraction(home[name][up])
