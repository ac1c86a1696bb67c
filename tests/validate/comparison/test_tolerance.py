"""Tolerances and verdicts, held to numbers worked out by hand; solutions of anybody, right or wrong."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from validate import Accuracy, FormulationError, Outcome, Solution, compare
from validate.comparison.compare import Comparison
from validate.formulations.protocol import AccuracyError
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")
COUNT = len(SCENE.instants)
SOLVED = formulation("pointcoord").solve(SCENE)
WHEEL = SOLVED.numbers["position"]["wheel_centre"]
ONES, BOUND = np.ones(COUNT), np.full((COUNT, 3), 1e-9)


class Other:
    """A formulation of somebody else: a class of a few lines."""

    name = "mine"

    def __init__(self, answer: Callable[[], Any]) -> None:
        self.answer = answer

    def solve(self, scene: Scene) -> Any:
        return self.answer()


def mine(numbers: Any, claims: Any, times: Any = SCENE.instants) -> Callable[[], Solution]:
    return lambda: Solution("mine", times, numbers, Accuracy(np.ones(len(times)), claims))


def of_wheel(bound: Any, **more: Any) -> Callable[[], Solution]:
    return mine({"position": {"wheel_centre": WHEEL}}, {"position": {"wheel_centre": bound}}, **more)


def row(outcome: Outcome, quantity: str, name: str) -> Comparison:
    (found,) = (r for r in outcome.rows if (r.quantity, r.name) == (quantity, name))
    return found


def changed(quantity: str, arrays: Mapping[str, np.ndarray], claims: Mapping[str, np.ndarray]) -> Solution:
    """Another's solution with some numbers of a quantity replaced, and what is claimed of them."""
    other = SOLVED.with_numbers({quantity: {**SOLVED.numbers[quantity], **arrays}})
    accuracy = SOLVED.accuracy.with_claims({quantity: {**SOLVED.accuracy.claims[quantity], **claims}})
    return replace(other, formulation="other", accuracy=accuracy)


@pytest.mark.parametrize(
    ("turned", "verdict"),
    [(2.0 * np.pi, "agrees"), (-2.0 * np.pi, "agrees"), (np.pi, "disagrees"), (1e-3, "disagrees")],
)
def test_an_angle_agrees_with_itself_whole_turns_on_and_not_half_a_turn_on(
    turned: float, verdict: str
) -> None:
    # A whole turn added is rounded, by more than what is claimed: claim as much.
    claims = {"camber": SOLVED.accuracy.claims["wheel"]["camber"] + 4e-15}
    other = changed("wheel", {"camber": SOLVED.numbers["wheel"]["camber"] + turned}, claims)
    assert row(compare(SCENE, SOLVED, other), "wheel", "camber").verdict == verdict


def test_a_wrong_number_does_not_widen_its_own_tolerance() -> None:
    # Points of the chassis stand still and claim nothing: a fault of 1e20 in one number of another point must
    # not excuse a fault of 1e-13 there.
    spoilt = dict(SOLVED.numbers["velocity"])
    spoilt["wheel_centre"] = spoilt["wheel_centre"].copy()
    spoilt["wheel_centre"][3] = 1e20
    spoilt["strut_top"] = spoilt["strut_top"] + 1e-13
    outcome = compare(SCENE, SOLVED, changed("velocity", spoilt, {}))
    assert row(outcome, "velocity", "strut_top").verdict == "disagrees"


@pytest.mark.parametrize(
    ("share", "verdict"), [(0.0, "agrees"), (0.99, "agrees"), (1.01, "disagrees"), (1.9, "disagrees")]
)
def test_numbers_agree_up_to_the_sum_of_what_both_claim_and_no_farther(share: float, verdict: str) -> None:
    claim = 2.0**-20  # a millionth of a millimetre: a thousand roundings of a car's coordinates
    claims = {name: np.full_like(c, claim) for name, c in SOLVED.accuracy.claims["position"].items()}
    moved = WHEEL.copy()
    moved[5, 1] += share * 2.0 * claim
    outcome = compare(
        SCENE, changed("position", {}, claims), changed("position", {"wheel_centre": moved}, claims)
    )
    found = row(outcome, "position", "wheel_centre")
    assert found.verdict == verdict
    assert found.share == pytest.approx(share, abs=1e-6)
    assert found.tolerance == pytest.approx(2.0 * claim, rel=1e-6)


def outcome_of(*verdicts: str, own: bool, faults: tuple[str, ...] = ()) -> Outcome:
    """Rows of some verdicts; "told" agrees with what the solver was given. own: one stated its accuracy."""
    any_row = Comparison("s", "a", "b", "position", "p", "mm", verdict="agrees")
    rows = (replace(any_row, telling=False) if v == "told" else replace(any_row, verdict=v) for v in verdicts)
    plain = Solution("a", np.zeros(1), {}, Accuracy(np.ones(1)))
    stated = replace(plain, accuracy=replace(plain.accuracy, blind=np.zeros(1, dtype=bool)))
    return Outcome("s", tuple(rows), (plain, stated if own else plain), (), (), 1, faults=faults)


@pytest.mark.parametrize(
    ("outcome", "passed", "disagrees", "why"),
    [
        (outcome_of("agrees", own=False), True, 0, ""),
        (outcome_of("agrees", "disagrees", own=False), False, 1, ""),
        (outcome_of("agrees", "not tested", own=False), False, 0, ""),
        (outcome_of("agrees", own=False, faults=("x",)), False, 0, "some of the numbers given cannot be"),
        (outcome_of("agrees", "not given", own=True), True, 0, ""),
        (outcome_of("agrees", "disagrees", "disagrees", own=True), False, 2, ""),
        (outcome_of("told", "not given", own=True), False, 0, "all numbers that agree were given to the"),
        (outcome_of("not tested", own=True), False, 0, "none of the numbers given is tested"),
        (outcome_of("agrees", own=True, faults=("x",)), False, 0, "some of the numbers given cannot be used"),
        (outcome_of("disagrees", own=True, faults=("x",)), False, 1, ""),
    ],
)
def test_what_passes_what_disagrees_and_why_there_is_no_verdict(
    outcome: Outcome, passed: bool, disagrees: int, why: str
) -> None:
    assert outcome.passed == passed
    assert len(outcome.disagreements) == disagrees == outcome.counts["disagrees"]
    assert {row.verdict for row in outcome.disagreements} <= {"disagrees"}
    assert outcome.why_no_verdict == "" if why == "" else outcome.why_no_verdict.startswith(why)


def test_what_another_formulation_gives_is_compared_and_the_rest_is_told() -> None:
    claims = {"position": {"wheel_centre": np.full((COUNT, 3), 0.51e-6)}}
    outcome = compare(
        SCENE, "pointcoord", Other(mine({"position": {"wheel_centre": np.round(WHEEL, 6)}}, claims))
    )
    wheel = row(outcome, "position", "wheel_centre")
    # A millionth of a millimetre is a thousand times what pointcoord claims: it tests nothing of pointcoord.
    assert (wheel.verdict, wheel.rests_on) == ("not tested", "mine")
    assert wheel.share <= 1.0
    assert {one.verdict for one in outcome.rows if one != wheel} == {"not given"}
    assert "mine gives no velocity" in outcome.missing
    assert any(told.startswith("mine gives no position of lower_arm_front, ") for told in outcome.missing)


@pytest.mark.parametrize(("more", "same"), [(0.0, True), (1.9e-9, True), (2.1e-9, False), (1.0, False)])
def test_instants_may_come_in_any_order_and_twice_but_not_beyond_both_bounds(more: float, same: bool) -> None:
    # Backwards, and then all once more; every other instant is missing.
    kept = np.arange(COUNT)[::-2]
    places = np.concatenate([WHEEL[kept], WHEEL[kept] + more])
    claims = {"position": {"wheel_centre": np.full(places.shape, 1e-9)}}
    answer = mine({"position": {"wheel_centre": places}}, claims, times=np.tile(SCENE.instants[kept], 2))
    outcome = compare(SCENE, SOLVED, Other(answer))
    wheel = row(outcome, "position", "wheel_centre")
    said = f"mine gives {len(kept)} of {COUNT} instants; the others are not compared"
    assert [note for note in outcome.notes if "instants; the others" in note] == [said]
    assert outcome.compared == len(kept)
    if same:
        assert wheel.share <= 1.0
        assert wheel.instant in SCENE.instants[kept]
    else:
        last = f"{SCENE.instants[-1]:g} s"
        fault = f"mine: position of wheel_centre has different numbers at one instant, {last}; it is ignored"
        assert (wheel.verdict, outcome.faults, outcome.passed) == ("not given", (fault,), False)


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ({"speed": {"wheel_centre": WHEEL}}, "mine: 'speed' is not a quantity and is ignored; there are: "),
        ({"position": [WHEEL]}, "mine: position given as list; needed: arrays by name"),
        ([WHEEL], "mine: its numbers given as list; needed: arrays by name"),
        (
            {"wheel": {"camber": WHEEL}},
            f"wheel angle of camber has the shape ({COUNT}, 3); needed: ({COUNT},)",
        ),
    ],
)
def test_numbers_that_cannot_be_read_are_told_with_what_is_needed(numbers: Any, said: str) -> None:
    outcome = compare(SCENE, SOLVED, Other(mine(numbers, {})))
    assert any(said in told for told in (*outcome.notes, *outcome.missing))
    assert not outcome.agreed


@pytest.mark.parametrize(
    ("answer", "said"),
    [
        (
            lambda: replace(of_wheel(BOUND)(), accuracy=None),
            "accuracy is of type NoneType; needed: an Accuracy",
        ),
        (lambda: replace(of_wheel(BOUND)(), times=SCENE.instants[:, None]), "times"),
        (
            lambda: {"position": {"wheel_centre": WHEEL}},
            "it returns an object of type dict; needed: a Solution",
        ),
        (mine({}, {"speed": {}}), "'speed' is of no known quantity; allowed: position"),
        (mine({}, {"position": [1e-9]}), "position is of type list; allowed: arrays by"),
        (mine({}, [1e-9]), "claims is of type list; allowed: arrays by quantity and name"),
        (
            of_wheel(-BOUND),
            "position of wheel_centre is -1e-09 at instant number 0; allowed: finite numbers from 0 up",
        ),
        (of_wheel(np.nan * BOUND), "is nan"),
        (of_wheel(BOUND.astype(int)), "is of type int64"),
        (of_wheel(ONES), "has the shape"),
        (lambda: replace(of_wheel(BOUND)(), accuracy=Accuracy(-ONES)), "condition is -1 at instant number 0"),
    ],
)
def test_what_is_no_solution_and_a_claim_that_is_no_bound_are_refusals(
    answer: Callable[[], Any], said: str
) -> None:
    with pytest.raises(FormulationError, match=r"^mine: ") as caught:
        compare(SCENE, SOLVED, Other(answer))
    assert said in str(caught.value)


def test_a_claim_that_is_no_bound_is_an_error_of_its_own() -> None:
    with pytest.raises(AccuracyError):
        Accuracy(-ONES)
