"""Anybody's solver: what it is given, what it may answer, and what is said of an answer that is none."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from plain_solvers import closed_form

from pointcoord import Scene, simulate
from validate import FormulationError, Outcome, check, compare
from validate.errors import UsageError
from validate.formulations.registry import formulation
from validate.hard.subjects import BESIDE, drawn_angle, scene_content
from validate.solvers.plain import PlainSolver, given_to_solver

CAR = BESIDE.car
SCENE = Scene.from_mapping(
    scene_content(CAR, (1.6, 0.12, -0.3), (4.0, -25.0), start=-0.5, stop=0.5, samples=5), "moving"
)
RIGHT = closed_form(given_to_solver(SCENE))


HELD = formulation("pointcoord").solve(SCENE)
TOE, CAMBER = RIGHT["wheel"]["toe"], RIGHT["wheel"]["camber"]


def compared(answer: object) -> Outcome:
    return compare(SCENE, PlainSolver("mine", lambda given: answer, 1e-6), HELD)


def verdicts(answer: object) -> dict[tuple[str, str], str]:
    return {(row.quantity, row.name): row.verdict for row in compared(answer).rows}


def plain(value: Any) -> bool:
    """Whether a value is of Python's own types or an array."""
    parts = [*value, *value.values()] if type(value) is dict else value if type(value) is list else ()
    return (
        all(map(plain, parts)) if parts else type(value) in (type(None), str, float, dict, list, np.ndarray)
    )


def test_what_a_solver_is_given_is_plain_and_whole() -> None:
    given = given_to_solver(SCENE)
    assert plain(given)
    assert given["points"]["strut_top"] == list(CAR.points["strut_top"])
    t = given["instants"]
    np.testing.assert_array_equal(t, [-0.5, -0.25, 0.0, 0.25, 0.5])
    np.testing.assert_allclose(given["inputs"]["arm_angle"]["position"], 1.6 + 0.12 * t - 0.3 * t * t)
    np.testing.assert_allclose(given["inputs"]["arm_angle"]["velocity"], 0.12 - 0.6 * t)
    np.testing.assert_allclose(given["inputs"]["arm_angle"]["acceleration"], -0.6 + 0.0 * t)
    # An input that the scene does not name rests.
    assert not np.any(given["inputs"]["heave"]["position"])
    assert given["asked"]["wheel"] == ["camber", "kingpin", "toe", "caster"]


def test_what_a_solver_is_given_is_enough_for_the_contact_point() -> None:
    scene = Scene.load("double-wishbone")

    def contact_travel(given: Any) -> Any:
        def height(places: Any) -> Any:
            inner, centre = (np.array(places[end]) for end in ("wheel_axis_inner", "wheel_centre"))
            leans = (centre - inner) @ given["up"] / np.linalg.norm(centre - inner, axis=-1)
            return centre @ given["up"] - given["wheel_radius"] * np.sqrt(1.0 - leans**2)

        risen = height(simulate(scene).position) - height(given["points"])
        return {"dimension": {"contact_travel": risen}}

    assert check(contact_travel, scene, accuracy=1e-9).passed


def test_a_solver_cannot_change_what_others_are_given() -> None:
    def spoils(given: Any) -> Any:
        given["points"]["strut_top"][0] = 1e9
        given["instants"][:] = 0.0
        del given["inputs"]
        return RIGHT

    assert check(spoils, SCENE).passed
    assert check(closed_form, SCENE).passed


def changed(quantity: str, name: str, by: float) -> dict[str, Any]:
    return RIGHT | {quantity: RIGHT[quantity] | {name: RIGHT[quantity][name] + by}}


def test_a_wrong_number_disagrees_and_nothing_else_does() -> None:
    nan = verdicts(changed("velocity", "wheel_centre", np.nan))
    assert nan["velocity", "wheel_centre"] == "disagrees"
    rows = {row.quantity: row for row in compared(RIGHT).rows}  # of each quantity the last
    for row in rows.values():
        # Twice what is tolerated at the instant where that is widest; 100 times covers the others.
        found = verdicts(changed(row.quantity, row.name, 100.0 * max(row.tolerance, 1e-12)))
        assert found.pop((row.quantity, row.name)) == "disagrees"
        assert set(found.values()) == {"agrees"}


def test_a_number_may_stand_by_itself_and_in_a_list_and_be_called_as_its_quantity() -> None:
    flat = {name: array.tolist() for name, array in RIGHT["wheel"].items()}
    assert [v for (q, _), v in verdicts(flat).items() if q == "wheel"] == ["agrees"] * 4
    same = ("spring_force", "wheel_rate")
    spring = {"spring_rate": 30.0, "spring_free_length": 300.0}
    scene = scene_with("pushrod", {"car": spring}, effects=["spring"])
    numbers = simulate(scene).numbers
    for answer in ({q: dict(numbers[q]) for q in same}, {q: numbers[q][q] for q in same}):
        outcome = check(lambda given, answer=answer: answer, scene, accuracy=1e-6)
        assert not outcome.faults
        assert [row.verdict for row in outcome.rows if row.name in same] == ["agrees"] * 2


def test_fewer_instants_are_compared_where_they_are_named() -> None:
    for places, verdict in (([2, 4], "agrees"), ([2, 3], "disagrees")):
        some = {"instants": [0.0, 0.5], "camber": CAMBER[places]}
        assert verdicts(some)["wheel", "camber"] == verdict
    with pytest.raises(FormulationError, match="include no instant of the scene"):
        compared({"instants": [7.0], "camber": [0.0]})


CHASSIS = {name: RIGHT["position"][name] for name in SCENE.mechanism.topology.chassis}


def test_giving_back_what_was_given_tells_nothing() -> None:
    outcome = compared({"position": CHASSIS})
    assert [row.name for row in outcome.rows if row.verdict == "agrees"] == list(CHASSIS)
    assert not outcome.disagreements
    assert not outcome.passed
    assert "were given to the solver" in outcome.why_no_verdict
    assert outcome.counts["given back"] == outcome.counts["agrees"] == len(CHASSIS)
    moving = {**CHASSIS, "wheel_centre": RIGHT["position"]["wheel_centre"]}
    told = compared({"position": moving})
    assert told.passed
    assert [row.name for row in told.rows if row.verdict == "agrees" and row.telling] == ["wheel_centre"]


def test_points_of_a_car_that_rests_tell_only_where_they_are_not_as_drawn() -> None:
    rest = {"start": -0.5, "stop": 0.5, "samples": 5}
    for off, tells in ((0.0, False), (0.01, True)):
        content = scene_content(CAR, (drawn_angle(CAR) + off, 0.0, 0.0), (0.0, 0.0), **rest)
        scene = Scene.from_mapping(content, "resting")
        right = closed_form(given_to_solver(scene))
        parts = {quantity: {quantity: right[quantity]} for quantity in ("position", "velocity")}
        for part, passes in ((parts["position"], tells), (parts["velocity"], False), (right["wheel"], True)):
            outcome = check(lambda given, part=part: part, scene)
            assert not outcome.disagreements
            assert outcome.passed is passes


# Parts of an answer, what is said of each, and whether it is a fault that keeps the rest from passing.
PARTS: list[tuple[dict[Any, Any], str, bool]] = [
    (
        {"position": {"wheel_centre": RIGHT["position"]["wheel_centre"].T}},
        *("has the shape (3, 5); needed: (5, 3)", True),
    ),
    ({"toe": TOE[:2]}, "has the shape (2,); needed: (5,)", True),
    ({"position": {"wheel_centre": "here"}}, "needed: real numbers", True),
    ({"position": [1.0]}, "position is of type list; needed: arrays by name", True),
    ({"toe": [str(x) for x in TOE]}, "needed: real numbers", True),
    ({"toe": None}, "needed: real numbers", True),
    ({"toe": np.ma.masked_array(TOE, mask=[1, 0, 0, 0, 0])}, "has 1 masked entries", True),
    ({"velocty": {}}, "'velocty', which the scene does not ask for (did you mean 'velocity'?)", True),
    ({"position": {"wheel_center": 1}}, "(did you mean 'wheel_centre'?)", True),
    ({"velocity": {}}, "", False),
    ({"iterations": 4}, "'iterations', which the scene does not ask for", False),
    ({"position": {"a_point_of_mine": 1}}, "a_point_of_mine', which the scene does not ask for", False),
    ({"toe": np.ma.masked_array(TOE, mask=False)}, "", False),
    ({3: 4}, "gives 3, which the scene does not ask for; it is ignored; asked for: position", False),
]


@pytest.mark.parametrize(("part", "said", "fault"), PARTS)
def test_a_part_that_cannot_be_used_is_no_agreement_whatever_agrees_and_something_else_is_no_fault(
    part: dict[Any, Any], said: str, fault: bool
) -> None:
    for camber, verdict in ((CAMBER, "agrees"), (-CAMBER, "disagrees")):
        outcome = compared({"camber": camber, **part})
        assert [row.verdict for row in outcome.rows if row.name == "camber"] == [verdict]
        assert said in "\n".join(outcome.notes)
        assert len(outcome.faults) == fault
        assert outcome.passed is (verdict == "agrees" and not fault)
        assert {row.name for row in outcome.disagreements} <= {"camber"}
    alone = compared(part)
    assert not alone.passed or "toe" in part
    assert alone.missing


class Solver:
    def solve(self, given: Mapping[str, Any]) -> dict[str, Any]:
        return RIGHT


class Called:
    def __call__(self, given: Mapping[str, Any]) -> dict[str, Any]:
        return RIGHT


def test_a_solver_is_a_function_an_object_or_a_class_and_its_accuracy_a_length() -> None:
    for solver in (Solver, Solver(), Called()):
        outcome = check(solver, SCENE)
        assert outcome.passed
        assert outcome.solutions[0].formulation.lower().startswith(("solver", "called"))
    mistyped: list[Any] = ["1e-6", {"camber": 1e-6}, None]
    for accuracy in (-1e-6, float("nan"), *mistyped):
        with pytest.raises(UsageError, match="give a length above 0"):
            check(closed_form, SCENE, accuracy)
