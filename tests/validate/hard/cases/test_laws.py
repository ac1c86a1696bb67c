"""Laws of every speed, length and smoothness, and sums that all but cancel, are what they are said to be."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import Scene
from validate.formulations.input_rates import rates
from validate.hard.answer import Answer
from validate.hard.cases import laws
from validate.hard.subjects import PAPER
from validate.hard.trial import Trial

BY_NAME = {case.name: case for case in laws.CASES}


def test_a_million_swings_are_right_by_a_map_and_at_their_instants() -> None:
    trial = BY_NAME["long-sine"].examine(1e6)
    assert {answer.outcome for answer in trial.answers} == {"right"}


@pytest.mark.parametrize("driven", ["arm_angle", "rack", "heave"])
@pytest.mark.parametrize("amplitude", laws.AMPLITUDES)
def test_what_is_left_of_a_large_swing_is_an_ordinary_input(driven: str, amplitude: float) -> None:
    scene = Scene.from_mapping(laws.cancelling_sine(driven, PAPER, 1.0 / amplitude))
    value, rate, _ = rates(scene.inputs[driven], np.array([0.0]))[0]
    off, speed = laws.ORDINARY[PAPER.units.get(driven, "mm")]
    wanted = PAPER.home.get(driven, 0.0) + off
    # The offset is rounded by half a unit, as large as the amplitude, and its product by as much again.
    assert abs(value - wanted) <= 2.0 * np.spacing(amplitude + abs(wanted))
    assert rate == pytest.approx(speed, rel=1e-15)


@pytest.mark.parametrize("power", [4, 6])
def test_twice_the_precision_is_enough_for_the_expanded_polynomial_as_far_as_the_case_says(
    power: int,
) -> None:
    start = Fraction(2) ** 20
    coefficients = [Fraction(c) for c in laws.expanded(power, float(start))]
    for later in (Fraction(0), Fraction(1, 2), Fraction(1)):
        assert sum(c * (start + later) ** j for j, c in enumerate(coefficients)) == 16 * later**power
    count = power + 1
    for begin, enough in ((1.0 / laws.right_from(power), True), (4.0 / laws.right_from(power), False)):
        size = sum(abs(c) * begin**j for j, c in enumerate(laws.expanded(power, begin)))
        assert (4.0 * count**2 * 2.0**-106 * size < 16.0 * 2.0**-53) == enough


def test_a_jump_refused_for_another_reason_is_wrong() -> None:
    def told(reason: str) -> str:
        trial = Trial(1e-9, (Answer("pointcoord", "refused", reason),))
        return laws.told_as_rough(PAPER, 1e-9, trial).answers[0].outcome

    assert told("MotionTooRough: input 'arm_angle' changes too fast") == "refused"
    assert told("MotionTooRough: input 'rack' changes too fast") == "wrong"
    assert told("SingularConfiguration: singular configuration at t = 0.5 s") == "wrong"
