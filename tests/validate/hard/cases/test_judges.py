"""Cases show what they are in the catalogue for, and what is wrong in their own way is found out."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from made_cases import stand_in

from pointcoord import NotFollowed, Scene, SingularConfiguration
from pointcoord.solve import taylor
from pointcoord.solve.proven_step import Proof
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation
from validate.hard.answer import Answer, Trial
from validate.hard.cases import links, motions
from validate.hard.catalogue import CASES

BY_NAME = {case.name: case for case in CASES}


def test_an_error_as_of_subtracted_far_coordinates_is_found_out(monkeypatch: pytest.MonkeyPatch) -> None:
    far, quantity, value = BY_NAME["far-from-the-origin"], "velocity", 1e-6
    lost = 4.0 * float(np.spacing(3.0 / value))  # of positions so far away, and of all made from them

    def losing(scene: Scene) -> Solution:
        solution = formulation("pointcoord-newton").solve(scene)
        arrays = dict(solution.numbers[quantity])
        arrays["tie_rod_outer"] = arrays["tie_rod_outer"] + lost
        # It knows that digits are lost, and says so, so that its own bounds hold.
        claims = solution.accuracy.claims[quantity]
        wider = {n: claim + 1e3 * lost for n, claim in claims.items()}
        accuracy = solution.accuracy.with_claims({quantity: wider})
        return replace(solution.with_numbers({quantity: arrays}), accuracy=accuracy)

    far.examine(value)  # the car at home is solved before the model is replaced
    stand_in(monkeypatch, losing, "pointcoord-newton")
    answers = {answer.formulation: answer for answer in far.examine(value).answers}
    assert answers["pointcoord-newton"].outcome == "wrong"
    assert "bounds of the car at home" in answers["pointcoord-newton"].reason
    assert answers["pointcoord"].outcome == "right"


def test_a_jump_refused_for_another_reason_is_wrong() -> None:
    def judged(reason: Exception) -> str:
        answer, came = Answer("pointcoord", "refused"), {"pointcoord": FormulationError("pointcoord", reason)}
        return motions.refused_as_rough("arm_angle", Trial(1e-9, (answer,), came=came), answer).outcome

    assert judged(NotFollowed(0.5, name="arm_angle")) == "refused"
    assert judged(NotFollowed(0.5, name="rack")) == "wrong"
    assert judged(SingularConfiguration("x of rack_centre", 1e17)) == "wrong"


def test_a_refusal_that_names_nothing_of_what_is_at_fault_is_wrong() -> None:
    told = Answer("pointcoord", "refused", "MechanismError: free: x of strut_rod_end")
    trial = Trial(1.0, (told,))
    assert links.must_name(frozenset(("strut_rod_end",)), trial, told) == told
    answer = links.must_name(frozenset(("tie_rod", "tie_rod_inner")), trial, told)
    assert answer.outcome == "wrong"
    assert "names none of tie_rod, tie_rod_inner" in answer.reason


def answers(name: str, *values: float) -> list[Answer]:
    """What pointcoord answers in a case at some values."""
    case = BY_NAME[name]
    ours = replace(case, expected={"pointcoord": case.expected["pointcoord"]})
    return [ours.examine(value).answers[0] for value in values]


def test_the_searched_bound_is_all_but_met_and_never_broken() -> None:
    values = BY_NAME["error-all-but-its-bound"].values[::2]
    shares = [answer.share or np.inf for answer in answers("error-all-but-its-bound", *values)]
    assert 0.99 < max(shares) <= 1.0


def test_steps_too_long_lead_to_another_branch_where_that_is_not_proven(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    right, near = taylor.lengths_by_sizes, (1e-11, 1e-13)

    def found() -> set[str]:
        return {answer.outcome for answer in answers("turn-at-a-coarse-tolerance", *near)}

    def blind(system: Any, series: Any, s: float, lacking: Any) -> Proof:
        return Proof(np.ones((), dtype=bool), np.array(np.inf), np.ones(system.unknowns))

    # Whatever pose Newton's method finds from the end of a series is taken.
    monkeypatch.setattr(taylor, "lengths_by_sizes", lambda *arguments: 4.0 * right(*arguments))
    monkeypatch.setattr(taylor, "confirmed", lambda system, reached, *_: reached.converged)
    assert found() <= {"right", "refused"}
    monkeypatch.setattr(taylor, "prove_segment", blind)
    assert "wrong" in found()
