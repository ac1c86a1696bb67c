"""Anybody's solver: what it is given, what it may answer, and what is said of an answer that is none."""

from collections.abc import Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with
from plain_solvers import closed_form

from pointcoord import Scene, simulate
from validate import FormulationError, Outcome, Solution, check, compare
from validate.errors import UsageError
from validate.formulations.registry import formulation
from validate.hard.subjects import BESIDE, scene_content
from validate.solvers.plain import PlainSolver, given_to_solver

CAR = BESIDE.car
SCENE = Scene.from_mapping(
    scene_content(CAR, (1.6, 0.12, -0.3), (4.0, -25.0), start=-0.5, stop=0.5, samples=5), "moving"
)
RIGHT = closed_form(given_to_solver(SCENE))


@cache
def solved() -> Solution:
    return formulation("pointcoord").solve(SCENE)


# pointcoord, which solves the scene once.
HELD: Any = SimpleNamespace(name="pointcoord", solve=lambda scene: solved())


def compared(answer: object) -> Outcome:
    return compare(SCENE, PlainSolver("mine", lambda given: answer, 1e-6), HELD)


def verdicts(answer: object) -> dict[tuple[str, str], str]:
    return {(row.quantity, row.name): row.verdict for row in compared(answer).rows}


def plain(value: Any) -> bool:
    """Whether a value is of Python's own types or an array."""
    if isinstance(value, Mapping):
        return type(value) is dict and all(type(key) is str and plain(one) for key, one in value.items())
    if type(value) is list:
        return all(plain(one) for one in value)
    return value is None or type(value) in (str, float, np.ndarray)


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
        up, radius = np.array(given["up"]), given["wheel_radius"]

        def height(inner: Any, centre: Any) -> Any:
            leans = (centre - inner) @ up / np.linalg.norm(centre - inner, axis=-1)
            return centre @ up - radius * np.sqrt(1.0 - leans**2)

        ends = "wheel_axis_inner", "wheel_centre"
        drawn = height(*(np.array(given["points"][end]) for end in ends))
        places = simulate(scene).position
        return {"dimension": {"contact_travel": height(*(places[end] for end in ends)) - drawn}}

    assert check(contact_travel, scene, accuracy=1e-9).passed


def test_a_solver_cannot_change_what_others_are_given() -> None:
    def spoils(given: Any) -> Any:
        given["points"]["strut_top"][0] = 1e9
        del given["inputs"]
        return RIGHT

    assert check(spoils, SCENE).passed
    with pytest.raises(FormulationError, match="read-only"):
        check(lambda given: given["instants"].sort(), SCENE)
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


@pytest.mark.parametrize("answer", [{}, {"camber": [1.0]}])
def test_who_gives_nothing_that_can_be_compared_does_not_pass(answer: dict[str, Any]) -> None:
    outcome = compared(answer)
    assert {row.verdict for row in outcome.rows} == {"not given"}
    assert not outcome.passed
    assert outcome.missing


def test_a_number_may_stand_by_itself_and_in_a_list_and_be_called_as_its_quantity() -> None:
    flat = {name: array.tolist() for name, array in RIGHT["wheel"].items()}
    assert [v for (q, _), v in verdicts(flat).items() if q == "wheel"] == ["agrees"] * 4
    same = ("spring_force", "wheel_rate")
    spring = {"spring_rate": 30.0, "spring_free_length": 300.0}
    scene = scene_with("pushrod", {"car": spring}, effects=["spring"])
    numbers = simulate(scene).numbers
    by_quantity = {quantity: dict(numbers[quantity]) for quantity in same}
    alone = {quantity: numbers[quantity][quantity] for quantity in same}
    for answer in (by_quantity, alone):
        outcome = check(lambda given, answer=answer: answer, scene, accuracy=1e-6)
        assert not outcome.faults
        assert [row.verdict for row in outcome.rows if row.name in same] == ["agrees"] * 2


def test_fewer_instants_are_compared_where_they_are_named() -> None:
    some = {"instants": [0.0, 0.5], "camber": RIGHT["wheel"]["camber"][[2, 4]]}
    assert verdicts(some)["wheel", "camber"] == "agrees"
    others = {"instants": [0.0, 0.5], "camber": RIGHT["wheel"]["camber"][[2, 3]]}
    assert verdicts(others)["wheel", "camber"] == "disagrees"
    outcome = compared({"camber": RIGHT["wheel"]["camber"][:2]})
    assert any("has the shape (2,); needed: (5,)" in note for note in outcome.notes)
    with pytest.raises(FormulationError, match="include no instant of the scene"):
        compared({"instants": [7.0], "camber": [0.0]})


CHASSIS = {name: RIGHT["position"][name] for name in SCENE.mechanism.topology.chassis}


def at_rest(theta: float) -> Scene:
    """The car with its arm at an angle and its rack at the middle, for five instants."""
    return Scene.from_mapping(
        scene_content(CAR, (theta, 0.0, 0.0), (0.0, 0.0), start=-0.5, stop=0.5, samples=5), "resting"
    )


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
    drawn = CAR.points
    up, front, ball = (np.array(p) for p in (CAR.up, drawn["lower_arm_front"], drawn["lower_ball_joint"]))
    theta = float(np.arccos((ball - front) @ up / np.linalg.norm(ball - front)))
    for resting, tells in ((at_rest(theta), False), (at_rest(theta + 0.01), True)):
        right = closed_form(given_to_solver(resting))
        outcome = check(lambda given, right=right: {"position": right["position"]}, resting)
        assert not outcome.disagreements
        assert outcome.passed is tells
        still = check(lambda given, right=right: {"velocity": right["velocity"]}, resting)
        assert not still.passed
        assert check(lambda given, right=right: {"camber": right["wheel"]["camber"]}, resting).passed


TOE = RIGHT["wheel"]["toe"]
# Parts of an answer, and what is said of each, or of those that cannot be used.
UNUSABLE: list[tuple[dict[Any, Any], str]] = [
    (
        {"position": {"wheel_centre": RIGHT["position"]["wheel_centre"].T}},
        "has the shape (3, 5); needed: (5, 3)",
    ),
    ({"position": {"wheel_centre": "here"}}, "needed: real numbers"),
    ({"position": [1.0]}, "position is of type list; needed: arrays by name"),
    ({"toe": [str(x) for x in TOE]}, "needed: real numbers"),
    ({"toe": None}, "needed: real numbers"),
    ({"toe": np.ma.masked_array(TOE, mask=[1, 0, 0, 0, 0])}, "has 1 masked entries"),
    ({"velocty": {}}, "'velocty', which the scene does not ask for (did you mean 'velocity'?)"),
    ({"position": {"wheel_center": 1}}, "(did you mean 'wheel_centre'?)"),
]
HARMLESS: list[tuple[dict[Any, Any], str]] = [
    ({"velocity": {}}, ""),
    ({"iterations": 4}, "'iterations', which the scene does not ask for"),
    ({"position": {"a_point_of_mine": 1}}, "a_point_of_mine', which the scene does not ask for"),
    ({"toe": np.ma.masked_array(TOE, mask=False)}, ""),
    ({3: 4}, "gives 3, which the scene does not ask for; it is ignored; asked for: position"),
]


@pytest.mark.parametrize(
    ("part", "said", "fault"),
    [*((*one, True) for one in UNUSABLE), *((*one, False) for one in HARMLESS)],
)
def test_a_part_that_cannot_be_used_is_no_agreement_whatever_agrees_and_something_else_is_no_fault(
    part: dict[Any, Any], said: str, fault: bool
) -> None:
    outcome = compared({"camber": RIGHT["wheel"]["camber"], **part})
    assert ("camber", "agrees") in {(row.name, row.verdict) for row in outcome.rows}
    assert said in "\n".join(outcome.notes)
    assert len(outcome.faults) == fault
    assert outcome.passed is not fault
    wrong = compared({"camber": -RIGHT["wheel"]["camber"], **part})
    assert {row.name for row in wrong.disagreements} == {"camber"}


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
    for accuracy in (-1e-6, float("nan")):
        with pytest.raises(UsageError, match="give a length above 0"):
            check(closed_form, SCENE, accuracy)
