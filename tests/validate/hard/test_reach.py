"""Where the ends of inputs are, and that a refusal which states an end wrongly is found out.

That each end parts poses from none is tested by the hard cases next to it.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from typing import Any

import mpmath
import pytest

from pointcoord import Scene
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation
from validate.hard.answer import Answer, Trial
from validate.hard.cases.ends import TIE_ROD
from validate.hard.reach import End, fault_of_kept, last_value
from validate.hard.subjects import CARS, NAMED, PAPER

RACK = End(PAPER, "rack", True, links=TIE_ROD)
SCENE = Scene.from_mapping(RACK.beyond(PAPER, 1e-3).content)


def refused(solver: str) -> Any:
    """What a solver says of the scene, which it refuses."""
    with pytest.raises(FormulationError) as caught:
        formulation(solver).solve(SCENE)
    return caught.value


def judged(refusal: FormulationError) -> Answer:
    """What is made of a refusal of the scene."""
    answer = Answer(refusal.formulation, "refused")
    return RACK.judge(Trial(1e-3, (answer,), scene=SCENE, came={refusal.formulation: refusal}), answer)


def test_a_refusal_that_says_something_wrong_is_wrong() -> None:
    right = refused("pointcoord-newton")
    assert judged(right).outcome == "right"

    def saying(**other: Any) -> FormulationError:
        told = copy(right.reason)
        vars(told).update(other)
        return FormulationError(right.formulation, told, right.partial)

    short = right.reason.reached | {"rack": right.reason.reached["rack"] * (1.0 - 1e-8)}
    for wrong, says in (
        (saying(reached=short), "stops at rack"),
        (saying(reduce="arm_angle"), "advises to reduce 'arm_angle'"),
        (saying(limits=right.reason.limits[5:]), "not those that lie in line"),
        (FormulationError(right.formulation, right.reason), "0 instants are kept"),
        (FormulationError(right.formulation, ValueError("no way on")), "does not say how far"),
    ):
        answer = judged(wrong)
        assert answer.outcome == "wrong"
        assert says in answer.reason


def test_a_kept_motion_that_is_short_or_wrong_is_found_out() -> None:
    right, end = refused("pointcoord"), float(RACK.last.value)
    assert fault_of_kept(right, SCENE, end, "rack") == ""
    places = {name: array.copy() for name, array in right.partial.position.items()}
    places["tie_rod_outer"][1, 2] += 1e-6
    for kept, says in (
        (right.partial.with_numbers({"position": places}), "of the kept motion: position of tie_rod_outer"),
        (replace(right.partial, times=right.partial.times[:-1]), "instants are kept"),
    ):
        wrong = FormulationError("pointcoord", right.reason, kept)
        assert says in fault_of_kept(wrong, SCENE, end, "rack")


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
