"""The catalogue is worth what its judge catches: wrong numbers, silence about them, and what crashes.

Hard cases go through the map of the inputs too, with bounded effort.
"""

import math
import re
import warnings
from dataclasses import replace
from itertools import groupby
from typing import Any

import numpy as np
import pytest
from made_cases import made_case, stand_in

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.reference_solution import reference_solution
from validate.formulations.registry import formulation
from validate.hard import answer as trying
from validate.hard.answer import MAP, OURS, Answer, judged_answer, try_scene
from validate.hard.case import REFUSED, RIGHT, Case, Expected, family
from validate.hard.catalogue import CASES
from validate.hard.report import as_expected, case_parts, examine, summary_parts
from validate.hard.subjects import PAPER, Subject, scene_content
from validate.output.table import text_of


def test_cases_are_called_and_described_as_the_catalogue_promises() -> None:
    names = [case.name for case in CASES]
    assert len(set(names)) == len(names)
    for case in CASES:
        assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", case.name)
        assert all((case.group, case.why, case.parameter, case.behaviour, case.expected))
        assert len(set(case.values)) == len(case.values) > 0
    groups = [group for group, _ in groupby(case.group for case in CASES)]
    assert len(groups) < 2 * len(set(groups))


SCENE = Scene.from_mapping(scene_content(PAPER.car, [1.5, 0.3], [0.0, 40.0], stop=0.2))


def test_a_wrong_number_of_any_quantity_or_none_is_wrong() -> None:
    solution, reference = formulation("pointcoord").solve(SCENE), reference_solution(SCENE)
    assert judged_answer(SCENE, solution, reference).outcome == "right"
    assert {"position", "acceleration", "angular_acceleration", "wheel"} < solution.numbers.keys()
    for quantity, numbers in ((q, of) for q, of in solution.numbers.items() if of):
        *_, name = numbers
        # A thousand times what is rounded there.
        size = 1e-12 * max(1.0, float(np.abs(numbers[name]).max()))
        for wrong in (size, math.nan):
            arrays = {n: np.array(a) for n, a in numbers.items()}
            arrays[name][1, ...] += wrong
            answer = judged_answer(SCENE, solution.with_numbers({quantity: arrays}), reference)
            assert answer.outcome == "wrong", quantity
            assert f"{QUANTITIES[quantity].words} of {name}" in answer.reason


@pytest.mark.parametrize(
    ("error", "outcome", "reason"),
    [
        (ZeroDivisionError("in a row"), "wrong", "fails: ZeroDivisionError: in a row"),
        (RuntimeWarning("overflow"), "wrong", "fails: RuntimeWarning: overflow"),
        (FormulationError("stand-in", ValueError("its\n reason")), "refused", "ValueError: its reason"),
    ],
)
def test_a_crash_or_a_warning_is_a_wrong_answer_and_a_refusal_is_none(
    error: Exception, outcome: str, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def solve(scene: Scene) -> Solution:
        if isinstance(error, Warning):
            warnings.warn(error, stacklevel=1)
        raise error

    stand_in(monkeypatch, solve)
    (answer,) = try_scene(1.0, scene_content(PAPER.car), ("stand-in",)).answers
    assert (answer.outcome, answer.reason) == (outcome, reason)


def test_a_wrong_number_is_never_expected() -> None:
    wrong = Answer("absolute", "wrong", "far off", share=math.inf)
    allowed = examine(made_case({1.0: wrong}, Expected(("wrong",))))
    assert not allowed.unexpected
    assert not as_expected([allowed])


def test_an_unexpected_refusal_and_a_failing_trial_are_reported() -> None:
    refused = examine(
        made_case({1.0: Answer("absolute", "right"), 0.1: Answer("absolute", "refused", "why")})
    )
    assert not as_expected([refused])
    assert "NOT AS EXPECTED: absolute is refused at 0.1: why" in text_of(case_parts(refused))
    assert "first refusal at 0.1: why" in text_of(case_parts(refused))
    assert "NOT as expected: 1 answer, 0 wrong without a warning, in made." in text_of(
        summary_parts([refused])
    )
    # A value without an answer breaks the trial, not the run.
    broken = examine(replace(made_case({1.0: Answer("absolute", "right")}), values=(1.0, 2.0)))
    assert [answer.outcome for _, answer in broken.answers("absolute")] == ["right", "unjudged"]
    assert "KeyError" in broken.answers("absolute")[1][1].reason
    assert not as_expected([broken])


CASES_MADE: list[Case] = []


@family(CASES_MADE, "0. Made", "rack travel, mm", (1.0, 1e-3, 1e-6), {OURS: RIGHT}, [PAPER])
def made(_: Subject, value: float) -> dict[str, Any]:
    """It is made."""
    return scene_content(PAPER.car, [1.5, 0.1], value, stop=0.2, samples=2)


(STEERED,) = CASES_MADE


def test_any_answer_is_wrong_where_the_links_cannot_meet_though_the_map_alone_answers(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    stand_in(monkeypatch, lambda scene: formulation("pointcoord").solve(SCENE), MAP)
    beyond = replace(STEERED, scene=lambda *_: scene_content(PAPER.car, rack=131.0), expected={OURS: REFUSED})
    result = examine(replace(beyond, values=(1.0,)))
    assert [one.outcome for _, one in result.answers(OURS)] == ["refused"]
    ((_, answer),) = result.wrong
    assert answer.formulation == MAP
    assert "turns back at a fold" in answer.reason


def test_its_effort_is_bounded_and_what_it_refuses_is_counted_by_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(trying, "MAP_EFFORT", 0)
    result = examine(STEERED)
    assert {a.outcome for _, a in result.answers(MAP)} == {"refused"}
    assert as_expected([result])
    words = "Refused by the map, whose effort is bounded here: 2 NotCovered."
    assert words in text_of(summary_parts([result]))
