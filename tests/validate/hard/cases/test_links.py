"""Links and numbers that make no mechanism: what is tried is at fault, and what passes it is found out."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from pointcoord import MechanismError, Scene
from validate.cars.paper_car import PAPER
from validate.formulations.registry import formulation
from validate.hard.cars import paper_car
from validate.hard.case import REFUSED, unexpected
from validate.hard.cases import links, numbers
from validate.hard.trial import try_scene

LINK_CASES = {case.name: case for case in links.CASES}
NUMBER_CASES = {case.name: case for case in numbers.CASES}


@pytest.mark.parametrize("car", ["paper", "wishbone"])
def test_what_is_free_without_a_link_belongs_to_its_points(car: str) -> None:
    # Holding all else, what moves violates the link that is gone: a coordinate of one of its ends.
    for number in links.counted(len(links.links_of(car))):
        trial = links.missing(number, car)
        answer = next(a for a in trial.answers if a.formulation == "pointcoord")
        assert answer.outcome == "refused"
        ends = str(trial.facts["constraint"]).removeprefix("link ").split(" - ")
        moving = [end for end in ends if end in links.topology_of(car).moving]
        assert any(f"{axis} of {end}" in answer.reason for end in moving for axis in "xyz")


def test_free_coordinates_of_other_points_only_are_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def elsewhere(*_: Any) -> None:
        raise MechanismError("free: x of strut_rod_end", ["x of strut_rod_end"])

    monkeypatch.setattr("validate.hard.cases.links.build_mechanism", elsewhere)
    tie_rod = float(len(links.links_of("paper")))
    answer = links.missing(tie_rod).answers[0]
    assert answer.outcome == "wrong"
    assert "names none of x of tie_rod_inner" in answer.reason


def test_a_link_that_nobody_names_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def vague(*_: Any) -> None:
        raise MechanismError("something is not determined", ["link a - b"])

    monkeypatch.setattr("validate.hard.cases.links.build_mechanism", vague)
    answer = links.redundant(1.0).answers[0]
    assert answer.outcome == "wrong"
    assert "does not name link" in answer.reason


def test_what_is_taken_for_a_mechanism_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("validate.hard.cases.links.build_mechanism", lambda *_: None)
    monkeypatch.setattr("absolute.solve", lambda *_: None)
    trial = links.exchanged(1.0)
    assert [answer.reason for answer in trial.answers] == ["takes it for a mechanism"] * 2
    assert {answer.outcome for answer in trial.answers} == {"wrong"}


@pytest.mark.parametrize("car", links.SIMPLE.values())
def test_exchanged_joints_have_as_many_rows_as_each_other(car: str) -> None:
    from absolute.description import JOINT_ROWS

    model = links.model_of(car)
    pairs = links.exchangeable(model)
    assert len(pairs) >= 5
    for doubled, dropped in pairs:
        assert doubled != dropped
        assert JOINT_ROWS[model.joints[doubled].kind] == JOINT_ROWS[model.joints[dropped].kind]


def test_every_number_of_a_scene_has_its_place() -> None:
    told = {numbers.told(place) for place in numbers.places()}
    assert {f"mechanism.points.{name}.{axis}" for name in PAPER for axis in range(3)} <= told
    assert {"tolerance", "time.start", "time.stop", "time.samples", "mechanism.up.2"} <= told
    assert {"inputs.arm_angle.polynomial.1", "inputs.rack.sine.phase", "inputs.heave.table.times.3"} <= told
    for place in numbers.places():
        changed = numbers.with_number(place, "x")
        part: Any = changed
        for key in place:
            part = part[key]
        assert part == "x"
    # The scene itself is sound: what is refused is refused for the number put into it.
    assert formulation("pointcoord").solve(Scene.from_mapping(numbers.content())).times.tolist() == [0.0, 0.2]


@pytest.mark.parametrize("name", ["tiny", "denormal"])
def test_numbers_near_zero_are_right_or_refused_at_every_coordinate(name: str) -> None:
    case = NUMBER_CASES[name]
    places = [i for i, place in enumerate(numbers.places(), 1) if "lower_ball_joint" in place]
    assert len(places) == 3
    for place in places:
        trial = case.examine(float(place))
        assert not unexpected(case, trial)


def test_points_that_are_linked_are_those_that_cannot_be_in_one_place() -> None:
    linked, others = numbers.linked(True), numbers.linked(False)
    assert len(linked) + len(others) == 45
    drawn = {frozenset((link.start, link.end)) for link in links.links_of("paper")}
    assert drawn < {frozenset(pair) for pair in linked}
    for number in range(1, len(linked) + 1):
        trial = NUMBER_CASES["link-without-length"].examine(float(number))
        assert not unexpected(NUMBER_CASES["link-without-length"], trial), trial.facts["place"]


def test_points_without_a_link_may_share_a_place() -> None:
    # The paper's own drawing has the rack's centre and the tie rod's end in one place.
    pair = numbers.linked(False).index(("rack_centre", "tie_rod_inner")) + 1
    trial = NUMBER_CASES["points-in-one-place"].examine(float(pair))
    assert {answer.outcome for answer in trial.answers} == {"right"}


def test_a_model_that_answers_a_number_that_is_none_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    class Blind:
        name = "absolute"

        def solve(self, scene: Scene) -> object:
            solution = formulation("absolute").solve(Scene.from_mapping(paper_car()))
            bad = {name: np.full_like(place, math.nan) for name, place in solution.position.items()}
            return solution.with_numbers({"position": bad})

    monkeypatch.setattr("validate.hard.trial.formulation", lambda _: Blind())
    trial = try_scene(1.0, paper_car(), ("absolute",))
    assert trial.answers[0].outcome == "wrong"


def test_refused_allows_no_other_outcome() -> None:
    assert REFUSED.met(1.0, "refused")
    assert not any(REFUSED.met(1.0, outcome) for outcome in ("right", "noted", "wrong", "unjudged"))
