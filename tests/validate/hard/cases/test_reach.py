"""The ends of the inputs: where they are, and that a refusal which says them wrongly is found out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest

from pointcoord import AssemblyError, Scene
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.registry import formulation
from validate.hard.cars import CARS, paper_car
from validate.hard.cases import blocked_ways
from validate.hard.cases.reach import ARM, CASES, TIE_ROD, Drive, refusal_held
from validate.hard.family import NAMED, PAPER
from validate.hard.last_values import last_value, reachable
from validate.hard.partial_motion import fault_of_kept

BY_NAME = {case.name: case for case in CASES}
PAPER_RACK = Drive(PAPER, "rack", True, TIE_ROD)


@pytest.mark.parametrize("car", ["paper", "turned"])
def test_the_arm_ends_where_its_ball_joint_is_highest_or_lowest_on_its_circle(car: str) -> None:
    # With u the axis and d the arm: height u_z (u . d) +- |d - u (u . d)| |z - u u_z|, worked out in
    # 50 digits from the coordinates as they are.
    hardpoints = CARS[car]
    with mpmath.workdps(50):
        front, rear, ball = (
            mpmath.matrix(hardpoints.points[n])
            for n in ("lower_arm_front", "lower_arm_rear", "lower_ball_joint")
        )
        z = mpmath.matrix(hardpoints.up)
        axis, arm = rear - front, ball - front
        u = axis / mpmath.norm(axis)
        along = (u.T * arm)[0]
        rise = (u.T * z)[0]
        middle = rise * along
        half = mpmath.norm(arm - along * u) * mpmath.norm(z - rise * u)
        length = mpmath.norm(arm)
        ends = {True: mpmath.acos((middle - half) / length), False: mpmath.acos((middle + half) / length)}
        for ahead, expected in ends.items():
            found = last_value(NAMED[car], "arm_angle", ahead)
            # halved down to 1e-16 of the range
            value = mpmath.mpf(found.value.numerator) / found.value.denominator
            assert abs(value - expected) <= 2e-16 * found.reach


@pytest.mark.parametrize("ahead", [True, False])
def test_the_rack_ends_where_a_pose_exists_on_one_side_only(ahead: bool) -> None:
    end = last_value(PAPER, "rack", ahead)
    outward = 1 if ahead else -1
    near = outward * Fraction(1, 10**15) * Fraction(end.reach)
    held = PAPER.home
    assert reachable(PAPER, {**held, "rack": end.value - near})
    assert not reachable(PAPER, {**held, "rack": end.value + near})
    # The range that the design notes give for the arm at 90 degrees.
    assert round(float(end.value), 3) == {True: 130.101, False: -89.066}[ahead]


def test_a_mirrored_and_turned_car_has_the_same_range() -> None:
    for driven in ("arm_angle", "rack"):
        plain, turned = (
            last_value(NAMED[car], driven, ahead)
            for car, ahead in (("beside", driven != "rack"), ("turned", True))
        )
        # Its coordinates, up to 4e6 mm, were rounded by 2^-31 mm when it was turned; the rack's end moves
        # by some ten times as much.
        assert plain.reach == pytest.approx(turned.reach, rel=0.0, abs=1e-7)


def refused(scene: Scene) -> FormulationError:
    """What Newton's method says of a scene that it refuses."""
    with pytest.raises(FormulationError) as caught:
        formulation("pointcoord-newton").solve(scene)
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
        (broken(reached=lambda r: r | {"arm_angle": 1.5}), "arm_angle is said to stop"),
        (broken(wanted=lambda w: w | {"rack": 100.0}), "lies before the end"),
        (broken(reduce=lambda _: "arm_angle"), "'arm_angle' is to be reduced"),
        (broken(limits=lambda limits: limits[3:]), "not what lies in line"),
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
    scene = Scene.from_mapping(PAPER_RACK.content(1e-3))
    refusal = refused(scene)
    assert refusal_held(refusal, scene, PAPER_RACK).outcome == "right"
    answer = refusal_held(change(refusal), scene, PAPER_RACK)
    assert answer.outcome == "wrong"
    assert says in answer.reason


@pytest.mark.parametrize("solver", ["pointcoord", "pointcoord-newton", "absolute"])
def test_a_kept_motion_that_is_short_or_wrong_is_found_out(solver: str) -> None:
    scene = Scene.from_mapping(PAPER_RACK.content(1e-3))
    end = float(PAPER_RACK.end.value)
    with pytest.raises(FormulationError) as caught:
        formulation(solver).solve(scene)
    kept = caught.value.partial
    assert kept is not None
    assert fault_of_kept(caught.value, scene, end, "rack") == ""

    def with_kept(solution: Solution) -> FormulationError:
        return FormulationError(solver, caught.value.reason, solution)

    places = {name: array.copy() for name, array in kept.position.items()}
    places["tie_rod_outer"][1, 2] += 1e-6
    moved = with_kept(kept.with_numbers({"position": places}))
    assert "tie_rod_outer of the kept instant 1" in fault_of_kept(moved, scene, end, "rack")
    cut = with_kept(replace(kept, times=kept.times[:-1]))
    assert "instants are kept" in fault_of_kept(cut, scene, end, "rack")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda r, end: blocked_ways.moved_on("absolute", r, end, 1e-7), "no pose just before"),
        (lambda r, end: blocked_ways.moved_on("absolute", r, end, -1e-7), "a pose just beyond"),
        (lambda r, end: r | {"rack": r["rack"] * (1.0 - 1e-6)}, "does not lie on the way"),
        (lambda r, end: {}, "does not say how far"),
    ],
)
def test_a_way_is_blocked_where_the_reference_loses_its_pose(
    change: Callable[[dict[str, float], dict[str, float]], dict[str, Any]], says: str
) -> None:
    end = blocked_ways.goal(0.1)
    scene = Scene.from_mapping(paper_car(end["arm_angle"], end["rack"]))
    with pytest.raises(FormulationError) as caught:
        formulation("absolute").solve(scene)
    refusal: Any = caught.value.reason
    reached: dict[str, float] = refusal.reached
    told: Any = Exception("no way on")
    for edit, outcome in ((lambda r, _: r, "right"), (change, "wrong")):
        values = {name: float(value) for name, value in edit(reached, end).items()}
        told.reached = values
        answer = blocked_ways.judged("absolute", told, end)
        assert answer.outcome == outcome
    assert says in answer.reason


def test_the_overshoot_of_the_arm_ends_where_angles_do() -> None:
    for ahead, upright in ((False, 0.0), (True, np.pi)):
        law = Drive(PAPER, "arm_angle", ahead, ARM).content(1.0)["inputs"]["arm_angle"]["polynomial"]
        assert sum(law) == upright
