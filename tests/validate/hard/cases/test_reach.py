"""A refusal which says the end of an input wrongly is found out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from pointcoord import AssemblyError, Scene
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation
from validate.hard.cases.ends import tie_rod_within
from validate.hard.cases.reach import End, fault_of_kept, refusal_held
from validate.hard.subjects import PAPER

PAPER_RACK = End(PAPER, "rack", True, lock=tie_rod_within(3))


def refused(scene: Scene, solver: str) -> FormulationError:
    """What a solver says of a scene that it refuses."""
    with pytest.raises(FormulationError) as caught:
        formulation(solver).solve(scene)
    return caught.value


def broken(**changes: Any) -> Callable[[FormulationError], FormulationError]:
    def change(refusal: FormulationError) -> FormulationError:
        error: Any = refusal.reason
        said = {n: getattr(error, n) for n in ("reached", "wanted", "limits", "reduce", "condition")}
        told = AssemblyError("no way on", **said)
        for attribute, edit in changes.items():
            setattr(told, attribute, edit(said[attribute]))
        return FormulationError(refusal.formulation, told, refusal.partial)

    return change


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (broken(reached=lambda r: r | {"rack": r["rack"] * (1.0 - 1e-8)}), "stops at rack"),
        (broken(reduce=lambda _: "arm_angle"), "advises to reduce 'arm_angle'"),
        (broken(limits=lambda limits: limits[3:]), "not those that lie in line"),
        (lambda refusal: FormulationError(refusal.formulation, refusal.reason), "is not kept"),
        (
            lambda refusal: FormulationError(refusal.formulation, ValueError("no way on")),
            "does not say how far",
        ),
    ],
)
def test_a_refusal_that_says_something_wrong_is_wrong(
    change: Callable[[FormulationError], FormulationError], says: str
) -> None:
    scene = Scene.from_mapping(PAPER_RACK.beyond(PAPER, 1e-3))
    refusal = refused(scene, "pointcoord-newton")
    assert refusal_held(refusal, scene, PAPER_RACK).outcome == "right"
    answer = refusal_held(change(refusal), scene, PAPER_RACK)
    assert answer.outcome == "wrong"
    assert says in answer.reason


def test_a_kept_motion_that_is_short_or_wrong_is_found_out() -> None:
    solver = "pointcoord"
    scene = Scene.from_mapping(PAPER_RACK.beyond(PAPER, 1e-3))
    end, refusal = float(PAPER_RACK.last.value), refused(scene, solver)
    kept = refusal.partial
    assert kept is not None
    assert fault_of_kept(refusal, scene, end, "rack") == ""

    def with_kept(solution: Solution) -> FormulationError:
        return FormulationError(solver, refusal.reason, solution)

    places = {name: array.copy() for name, array in kept.position.items()}
    places["tie_rod_outer"][1, 2] += 1e-6
    moved = with_kept(kept.with_numbers({"position": places}))
    assert "tie_rod_outer of the kept instant 1" in fault_of_kept(moved, scene, end, "rack")
    cut = with_kept(replace(kept, times=kept.times[:-1]))
    assert "instants are kept" in fault_of_kept(cut, scene, end, "rack")
