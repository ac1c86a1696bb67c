"""Where the ends of inputs are, and that a refusal which states an end wrongly is found out.

That each end parts poses from none is tested by the hard cases next to it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import mpmath
import pytest

from pointcoord import AssemblyError, Scene
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation
from validate.hard.cases.ends import TIE_ROD
from validate.hard.reach import End, fault_of_kept, last_value, refusal_held
from validate.hard.subjects import CARS, NAMED, PAPER

PAPER_RACK = End(PAPER, "rack", True, links=TIE_ROD)


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
        (broken(limits=lambda limits: limits[5:]), "not those that lie in line"),
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


@pytest.mark.parametrize("car", ["paper", "turned"])
def test_the_arm_ends_where_its_ball_joint_is_highest_or_lowest_on_its_circle(car: str) -> None:
    # With u the axis and d the arm: height u_z (u . d) +- |d - u (u . d)| |z - u u_z|, worked out in
    # 50 digits from the coordinates as they are.
    names = ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
    with mpmath.workdps(50):
        front, rear, ball = (mpmath.matrix(CARS[car].points[n]) for n in names)
        z = mpmath.matrix(CARS[car].up)
        axis, arm = rear - front, ball - front
        u = axis / mpmath.norm(axis)
        along, rise = (u.T * arm)[0], (u.T * z)[0]
        half = mpmath.norm(arm - along * u) * mpmath.norm(z - rise * u)
        for ahead, sign in ((True, -1), (False, 1)):
            expected = mpmath.acos((rise * along + sign * half) / mpmath.norm(arm))
            found = last_value(NAMED[car], "arm_angle", ahead)
            value = mpmath.mpf(found.value.numerator) / found.value.denominator
            # halved down to 1e-16 of the range
            assert abs(value - expected) <= 2e-16 * found.reach
