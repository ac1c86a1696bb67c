"""What a formulation claims of its accuracy is checked, and so is everything else that it gives."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from validate.comparison.compare import Outcome, compare
from validate.formulations.protocol import Accuracy, AccuracyError, FormulationError, Numbers, Solution
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")
COUNT = len(SCENE.instants)
ONES = np.ones(COUNT)


@pytest.mark.parametrize(
    ("claim", "said"),
    [
        (np.full((COUNT, 3), -1e-9), "velocity of wheel_centre is -1e-09 at instant number 0"),
        (np.full((COUNT, 3), np.inf), "is inf"),
        (np.full((COUNT, 3), np.nan), "is nan"),
        (np.ones((COUNT, 3), dtype=int), "is of type int64"),
        (np.ones((COUNT, 3), dtype=complex), "is of type complex128"),
        (np.ones(COUNT), "has the shape"),
        (np.ones((COUNT + 1, 3)), "has the shape"),
    ],
)
def test_a_claim_that_is_no_bound_is_refused_with_what_is_allowed(claim: Any, said: str) -> None:
    with pytest.raises(AccuracyError, match="allowed: ") as caught:
        Accuracy(ONES, {"velocity": {"wheel_centre": claim}})
    assert said in str(caught.value)


def test_condition_numbers_are_checked_likewise() -> None:
    for wrong in (-ONES, np.full(COUNT, np.inf), np.ones((COUNT, 3))):
        with pytest.raises(AccuracyError, match="condition"):
            Accuracy(wrong)


class Changed:
    """The absolute model with its solution changed, under a name of its own."""

    name = "changed"

    def __init__(self, change: Callable[[Solution], object]) -> None:
        self.change = change

    def solve(self, scene: Scene) -> Any:
        return self.change(replace(formulation("absolute").solve(scene), formulation="changed"))


def with_claims(solution: Solution, **claims: Any) -> Solution:
    """The solution with other claims of some quantities."""
    return replace(solution, accuracy=solution.accuracy.with_claims(claims))


def compared(change: Callable[[Solution], object]) -> Outcome:
    return compare(SCENE, "pointcoord", Changed(change))


def with_velocity(wrong: Callable[[np.ndarray], Any]) -> Callable[[Solution], Solution]:
    def change(solution: Solution) -> Solution:
        arrays: Mapping[str, Any] = solution.numbers["velocity"]
        return solution.with_numbers({"velocity": {**arrays, "wheel_centre": wrong(arrays["wheel_centre"])}})

    return change


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda v: v.astype(complex), "is of type complex128; needed: real numbers"),
        (lambda v: v[:-1], f"has the shape ({COUNT - 1}, 3); needed: ({COUNT}, 3)"),
        (lambda v: v.T, "has the shape"),
        (lambda v: "fast", "is of type"),
        (lambda v: [[1.0], [1.0, 2.0]], "is no array"),
        (lambda v: None, "is of type object"),
    ],
)
def test_what_cannot_be_compared_is_told_and_the_rest_is_compared(
    wrong: Callable[[np.ndarray], Any], said: str
) -> None:
    outcome = compared(with_velocity(wrong))
    assert any(f"changed: velocity of wheel_centre {said}" in note for note in outcome.notes), outcome.notes
    assert outcome.missing == ("changed gives no velocity of wheel_centre",)
    assert [(r.quantity, r.name, r.verdict) for r in outcome.undecided] == [
        ("velocity", "wheel_centre", "not given")
    ]
    assert not outcome.agreed
    assert sum(row.verdict == "agrees" for row in outcome.rows) == len(outcome.rows) - 1


def test_a_number_that_is_none_is_a_disagreement_and_is_told() -> None:
    def hole(velocity: np.ndarray) -> np.ndarray:
        wrong = velocity.copy()
        wrong[3, 1] = np.inf
        return wrong

    outcome = compared(with_velocity(hole))
    assert [row.name for row in outcome.disagreements] == ["wheel_centre"]
    assert f"changed: velocity of wheel_centre is not a number at 1 of {COUNT} instants" in outcome.notes


def test_whole_numbers_are_numbers() -> None:
    outcome = compared(with_velocity(lambda v: np.zeros(v.shape, dtype=int)))
    assert [row.name for row in outcome.disagreements] == ["wheel_centre"]
    assert not outcome.undecided


def test_a_solver_of_some_quantities_is_compared_in_these() -> None:
    outcome = compared(
        lambda s: s.with_numbers({"velocity": {}, "acceleration": {}, "angular_velocity": {}, "wheel": {}})
    )
    assert {row.quantity for row in outcome.rows if row.verdict == "agrees"} == {
        "position",
        "angular_acceleration",
    }
    assert {row.verdict for row in outcome.undecided} == {"not given"}
    assert "changed gives no wheel angle" in outcome.missing
    assert "not given" in repr(outcome)


def test_instants_that_both_give_are_compared() -> None:
    def every_other(solution: Solution) -> Solution:
        def half(numbers: Numbers) -> Numbers:
            return {q: {n: a[::2] for n, a in arrays.items()} for q, arrays in numbers.items()}

        accuracy = Accuracy(solution.accuracy.condition[::2], half(solution.accuracy.claims))
        return replace(solution, times=solution.times[::2], numbers=half(solution.numbers), accuracy=accuracy)

    outcome = compared(every_other)
    assert outcome.agreed
    assert any(f"gives {len(SCENE.instants[::2])} of {COUNT} instants" in note for note in outcome.notes)
    none = compared(lambda s: replace(s, times=s.times + 1e-3))
    assert {row.verdict for row in none.rows} == {"not given"}


@pytest.mark.parametrize(
    "change",
    [
        lambda s: replace(s, times=None),
        lambda s: replace(s, times=s.times[:, None]),
        lambda s: {"position": s.numbers["position"]},
        lambda s: replace(s, accuracy=Accuracy(-s.accuracy.condition)),
    ],
)
def test_what_is_no_solution_is_a_refusal(change: Callable[[Solution], object]) -> None:
    with pytest.raises(FormulationError, match=r"^changed: "):
        compared(change)


@pytest.mark.parametrize("quantity", ["position", "velocity", "angular_acceleration", "wheel"])
def test_a_tolerance_that_rests_on_one_sides_claim_alone_tests_nothing(quantity: str) -> None:
    def wide(solution: Solution) -> Solution:
        claims = {name: claim + 1e-3 for name, claim in solution.accuracy.claims[quantity].items()}
        return with_claims(solution, **{quantity: claims})

    outcome = compared(wide)
    loose = [row for row in outcome.rows if row.quantity == quantity and row.difference > 0.0]
    assert loose
    for row in loose:
        assert row.verdict == "not tested"
        assert row.rests_on == "changed"
        assert row.part > 0.999
    assert not outcome.agreed
    assert all(row.verdict == "agrees" for row in outcome.rows if row.quantity != quantity)


def test_a_claim_of_nothing_is_no_test_and_a_fault_is_found_however_little_is_claimed() -> None:
    none = compared(lambda s: with_claims(s, velocity={}))
    assert {row.verdict for row in none.rows if row.quantity == "velocity"} == {"not tested"}
    exact = compared(
        lambda s: with_claims(s, velocity={n: 0.0 * c for n, c in s.accuracy.claims["velocity"].items()})
    )
    assert {row.quantity for row in exact.disagreements} == {"velocity"}


def test_an_outcome_prints_as_a_line() -> None:
    outcome = compared(lambda s: s)
    assert repr(outcome) == f"<Outcome of {SCENE.title!r}, pointcoord and changed: {len(outcome.rows)} agree>"
