"""The ends of the inputs: where they are, how a pose behaves there, and that nothing is made up beyond."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from validate.hard.case import Case
from validate.hard.cases.dead_points import ARM_ANGLES, CARS, CASES, arm_ends, rack_ends
from validate.hard.run import as_expected, examine
from validate.reference import InfeasibleError, Instant, solve_reference

BY_NAME = {case.name: case for case in CASES}


def at(case: str, *values: float) -> Case:
    """A case at some values of its parameter only."""
    return replace(BY_NAME[case], values=values)


def pose(key: str, arm_angle: float, rack: float, rate: float = 0.0) -> Instant:
    car = CARS[key]
    inputs: dict[str, Any] = {"arm_angle": (arm_angle, 0, 0), "rack": (rack, rate, 0)}
    return solve_reference(car.points, inputs, up=car.up, right=car.right, side=car.side, closure=car.closure)


@pytest.mark.parametrize("key", CARS)
@pytest.mark.parametrize("place", [0, 1])
def test_an_end_separates_poses_from_none_to_a_trillionth_of_the_range(key: str, place: int) -> None:
    arm, rack = arm_ends(key), rack_ends(key, ARM_ANGLES[1])
    for ends, inputs, closure in (
        (arm, lambda angle: (angle, 0.0), "arm"),
        (rack, lambda travel: (ARM_ANGLES[1], travel), "tie_rod"),
    ):
        step = 1e-12 * (ends[1 - place] - ends[place])
        assert pose(key, *inputs(ends[place] + step)).condition > 1e5
        with pytest.raises(InfeasibleError) as refusal:
            pose(key, *inputs(ends[place] - step))
        assert refusal.value.closure == closure


def test_the_ends_are_those_of_the_papers_car() -> None:
    """Found by continuation: 32.2 to 152.0 degrees at rack 0, -89 to 130 mm at a right angle."""
    assert np.allclose(np.degrees(arm_ends("")), (32.2, 152.0), rtol=0, atol=0.1)
    assert np.allclose(rack_ends("", ARM_ANGLES[1]), (-89.0, 130.0), rtol=0, atol=0.2)


def test_rates_grow_as_the_inverse_root_of_the_distance() -> None:
    low, high = rack_ends("", ARM_ANGLES[1])
    distances = np.array([1e-6, 1e-8, 1e-10])
    speeds = [
        max(
            float(abs(x))
            for x in pose("", ARM_ANGLES[1], low + d * (high - low), 1.0).velocity["tie_rod_outer"]
        )
        for d in distances
    ]
    slope = np.polyfit(np.log(distances), np.log(speeds), 1)[0]
    assert abs(slope + 0.5) < 1e-3


@pytest.mark.parametrize("name", [name for name in BY_NAME if "held" in name])
def test_the_condition_number_shows_the_fold_and_poses_stay_within_their_bounds(name: str) -> None:
    result = examine(at(name, 1e-2, 1e-5, 1e-8, 1e-11))
    assert as_expected([result]), result.unexpected
    conditions = [answer.condition for _, answer in result.answers("pointcoord")]
    growth = np.diff(np.log10(np.array(conditions, dtype=float)))
    # A thousandth of the distance makes 1e1.5 of it; the first step still feels the rest of the car.
    assert np.allclose(growth[1:], 1.5, rtol=0, atol=0.1)


@pytest.mark.parametrize("name", [name for name in BY_NAME if "moving" in name])
def test_motions_towards_an_end_are_right_or_refused(name: str) -> None:
    # Half the digits of a distance of 1e-6 or 1e-7 are those of the pose: no bound is as near to its limit.
    result = examine(at(name, 1e-1, 1e-4, 1e-6, 1e-7, 1e-12))
    assert as_expected([result]), result.unexpected


@pytest.mark.parametrize("name", [name for name in BY_NAME if "beyond" in name])
def test_a_pose_beyond_an_end_is_never_made_up(name: str) -> None:
    result = examine(at(name, 1e-1, 1e-12))
    for formulation in ("pointcoord", "absolute"):
        assert [answer.outcome for _, answer in result.answers(formulation)] == ["refused", "refused"]
    assert all("InfeasibleError" in str(trial.facts["reference"]) for trial in result.trials)


@pytest.mark.parametrize("name", [name for name in BY_NAME if "-arm-" in name])
def test_toggles_at_other_arm_angles_are_right_or_refused(name: str) -> None:
    result = examine(at(name, 1e-1, 1e-6, 1e-12))
    assert as_expected([result]), result.unexpected
