"""Links and numbers that make no mechanism: what is tried is at fault, and what passes it is found out."""

from __future__ import annotations

from typing import Any

import pytest

from pointcoord import Scene
from validate.cars.paper_car import PAPER as TABLE_1
from validate.formulations.input_rates import rates
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.answer import Answer
from validate.hard.cases import links, numbers
from validate.hard.trial import Trial, solved

LINK_CASES = {case.name: case for case in links.CASES}


def test_a_refusal_that_names_nothing_of_what_is_at_fault_is_wrong() -> None:
    told = Trial(1.0, (Answer("pointcoord", "refused", "MechanismError: free: x of strut_rod_end"),))
    assert links.named(told, frozenset(("strut_rod_end",))).answers == told.answers
    (answer,) = links.named(told, frozenset(("tie_rod", "tie_rod_inner"))).answers
    assert answer.outcome == "wrong"
    assert "names none of tie_rod, tie_rod_inner" in answer.reason


def test_a_further_link_holds_what_an_input_held_and_a_copy_does_not() -> None:
    case = LINK_CASES["arm-held-by-a-third-link"]
    far, near, copy = (case.examine(share).answers[0] for share in (1.0, 1e-5, 0.0))
    assert (far.outcome, near.outcome, copy.outcome) == ("right", "right", "refused")
    # Links that are nearly one link hold the point only as well as their difference does.
    assert far.condition is not None
    assert near.condition is not None
    assert near.condition > 1e3 * far.condition


def test_every_number_of_a_scene_has_its_place() -> None:
    told = {numbers.told(place) for place in numbers.places()}
    assert {f"mechanism.points.{name}.{axis}" for name in TABLE_1 for axis in range(3)} <= told
    assert {"tolerance", "time.start", "time.stop", "time.samples", "mechanism.up.2"} <= told
    assert {"inputs.arm_angle.polynomial.1", "inputs.rack.sine.phase", "inputs.heave.table.times.3"} <= told
    for place in numbers.places():
        part: Any = numbers.with_number(numbers.content(), place, "x")
        for key in place:
            part = part[key]
        assert part == "x"
    # The scene itself is sound: what is refused is refused for the number put into it.
    assert formulation("pointcoord").solve(Scene.from_mapping(numbers.content())).times.tolist() == [0.0, 0.2]


def test_a_wrong_place_far_away_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    law = numbers.law(("constant",), 1e308)
    unjudged = Trial(1.0, (Answer("absolute", "unjudged"),))
    scene = Scene.from_mapping(numbers.heaved(law))
    plain = solved("absolute", Scene.from_mapping(numbers.heaved(None)))
    assert isinstance(plain, Solution)
    law_there = rates(scene.inputs["heave"], scene.instants)
    for factor, outcome in ((1.0, "right"), (1.0 + 1e-14, "wrong")):
        answer = numbers.added(plain, factor * law_there, scene.mechanism.up)
        monkeypatch.setattr(numbers, "solved", lambda *_, answer=answer: answer)
        assert numbers.displaced(unjudged, law).answers[0].outcome == outcome
