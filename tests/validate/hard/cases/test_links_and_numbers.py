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
from validate.hard.case import HARD
from validate.hard.cases import links, numbers
from validate.hard.subjects import SUBJECTS, Subject
from validate.hard.trial import Trial, solved

LINK_CASES = {case.name: case for case in links.CASES}


def pairwise(subject: Subject) -> bool:
    """Whether every joint is of two bodies, so that joints can be counted by pairs."""
    bodies = subject.plain["bodies"].values()
    return all(sum(point in points for points in bodies) <= 2 for point in subject.plain["points"])


WHOLE = [subject for subject in SUBJECTS if subject.name not in HARD and pairwise(subject)]


def freedoms(tables: dict[str, Any]) -> int:
    """By counting: six of each body and three of each free point, less what holds them."""
    bodies = tables["bodies"]
    moving = [points for name, points in bodies.items() if name != "chassis"]
    every = {name for points in bodies.values() for name in points}
    rods, slides = tables["rods"].values(), tables["slides"].values()
    sliding = [point for slide in slides for point in slide["points"]]
    free = {end for ends in rods for end in ends if end not in every} | {p for p in sliding if p not in every}
    count = 6 * len(moving) + 3 * len(free) - len(rods) - 2 * len(sliding)
    for place, points in enumerate(bodies.values()):
        for others in list(bodies.values())[:place]:
            count -= {0: 0, 1: 3, 2: 5}[len(set(points) & set(others))]
    return count


@pytest.mark.parametrize("subject", WHOLE, ids=lambda one: one.name)
def test_a_mechanism_has_a_freedom_for_each_input_and_one_more_for_each_row_of_a_missing_piece(
    subject: Subject,
) -> None:
    assert freedoms(links.tables_of(subject)) == len(subject.kinds)
    for piece in links.pieces(subject.plain):
        # A point of three bodies would be counted twice, and the line of a slide is no joint of its body.
        lines = [(s["body"], p) for s in subject.plain["slides"].values() for p in (s["through"], s["along"])]
        if piece.table == "bodies" and ((piece.key, piece.point) in lines or shared_by(subject, piece) != 1):
            continue
        tables = links.tables_of(subject)
        piece.dropped(tables)
        assert freedoms(tables) == len(subject.kinds) + piece.rows, piece.words


def shared_by(subject: Subject, piece: links.Piece) -> int:
    """How many other bodies have the point."""
    bodies = subject.plain["bodies"].items()
    return sum(piece.point in points for name, points in bodies if name != piece.key)


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
