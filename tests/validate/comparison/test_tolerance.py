"""Tolerances and verdicts, held to numbers that can be worked out by hand."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.comparison.compare import Comparison, Outcome, compare_solutions
from validate.formulations.protocol import Accuracy, Solution
from validate.formulations.registry import formulation

SCENE = Scene.load("steer")


@pytest.fixture(scope="module")
def solved() -> Solution:
    return formulation("pointcoord").solve(SCENE)


def changed(solution: Solution, quantity: str, arrays: Mapping[str, np.ndarray]) -> Solution:
    """The solution with some numbers of a quantity replaced."""
    return solution.with_numbers({quantity: {**solution.numbers[quantity], **arrays}})


def row(one: Solution, other: Solution, quantity: str, name: str) -> Comparison:
    outcome = compare_solutions(SCENE, one, replace(other, formulation="other"), "steer")
    (found,) = (r for r in outcome.rows if (r.quantity, r.name) == (quantity, name))
    return found


@pytest.mark.parametrize(
    ("turned", "verdict"),
    [(2.0 * np.pi, "agrees"), (-2.0 * np.pi, "agrees"), (np.pi, "disagrees"), (1e-3, "disagrees")],
)
def test_an_angle_agrees_with_itself_whole_turns_on_and_not_half_a_turn_on(
    solved: Solution, turned: float, verdict: str
) -> None:
    other = changed(solved, "wheel", {"camber": solved.numbers["wheel"]["camber"] + turned})
    if verdict == "agrees":
        # A whole turn added is rounded, by more than what is claimed: claim as much.
        claims = {name: claim + 4e-15 for name, claim in solved.accuracy.claims["wheel"].items()}
        other = replace(other, accuracy=solved.accuracy.with_claims({"wheel": claims}))
    assert row(solved, other, "wheel", "camber").verdict == verdict


def test_a_wrong_number_does_not_widen_its_own_tolerance(solved: Solution) -> None:
    # Points of the chassis stand still and claim nothing: a fault of 1e20 in one number of another point must
    # not excuse a fault of 1e-13 there.
    spoilt = dict(solved.numbers["velocity"])
    spoilt["wheel_centre"] = spoilt["wheel_centre"].copy()
    spoilt["wheel_centre"][3] = 1e20
    spoilt["strut_top"] = spoilt["strut_top"] + 1e-13
    assert row(solved, changed(solved, "velocity", spoilt), "velocity", "strut_top").verdict == "disagrees"


@pytest.mark.parametrize(
    ("share", "verdict"), [(0.0, "agrees"), (0.99, "agrees"), (1.01, "disagrees"), (1.9, "disagrees")]
)
def test_numbers_agree_up_to_the_sum_of_what_both_claim_and_no_farther(
    solved: Solution, share: float, verdict: str
) -> None:
    claim = 2.0**-20  # a millionth of a millimetre: a thousand roundings of a car's coordinates
    claims = {name: np.full_like(c, claim) for name, c in solved.accuracy.claims["position"].items()}
    one = replace(solved, accuracy=solved.accuracy.with_claims({"position": claims}))
    moved = one.numbers["position"]["wheel_centre"].copy()
    moved[5, 1] += share * 2.0 * claim
    found = row(one, changed(one, "position", {"wheel_centre": moved}), "position", "wheel_centre")
    assert found.verdict == verdict
    assert found.share == pytest.approx(share, abs=1e-6)


def stated(solution: Solution) -> Solution:
    """The same, as of a solver that is held to an accuracy that it stated."""
    blind = np.zeros(len(solution.times), dtype=bool)
    return replace(solution, accuracy=replace(solution.accuracy, blind=blind), formulation="stated")


def outcome_of(*verdicts: str, own: bool, faults: tuple[str, ...] = ()) -> Outcome:
    """Rows of some verdicts; "told" agrees with what the solver was given. own: one stated its accuracy."""
    any_row = Comparison("s", "a", "b", "position", "p", "mm", 0.0, 1.0, 0.0, 0.0, "agrees", "a", 0.0)
    rows = tuple(
        replace(any_row, verdict="agrees", telling=False) if v == "told" else replace(any_row, verdict=v)
        for v in verdicts
    )
    plain = Solution("a", np.zeros(1), {}, Accuracy(np.ones(1)))
    return Outcome("s", rows, (plain, stated(plain) if own else plain), (), (), 1, faults=faults)


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
    # Held to the derived tolerance itself unless said otherwise.
    assert outcome.factor == 1.0
