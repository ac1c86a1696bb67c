"""The ends of the inputs: where they are, that each is a fold, and that its lock is the one that it says."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.hard.cars import CARS, SQUARE, scene_content
from validate.hard.cases.dead_points import CASES, near_content
from validate.hard.family import NAMED, OTHERS, PAPER
from validate.hard.last_values import ends_of, last_value
from validate.hard.run import as_expected, examine
from validate.reference import InfeasibleError, Instant

BY_NAME = {case.name: case for case in CASES}
WAYS = (False, True)
End = tuple[str, str, bool, float | None]
ENDS: list[End] = [
    *((car, "arm_angle", up, None) for car in ("paper", "other", "short-arm") for up in WAYS),
    *((car, "rack", up, SQUARE) for car in ("paper", "other", "wishbone") for up in WAYS),
    ("wide", "arm_angle", False, None),
    ("wishbone", "arm_angle", True, None),
    ("wishbone", "arm_angle", False, None),
    *((subject.name, driven, up, None) for subject in OTHERS for driven, up in ends_of(subject)[:1]),
]


def pose(end: End, value: float, law: str = "held") -> Instant:
    """The reference near an end, or beyond it."""
    name, driven, ahead, arm_angle = end
    scene = Scene.from_mapping(near_content(NAMED[name], driven, ahead, arm_angle, law, value))
    return reference_instant(scene, inputs_at(scene, 0.0))


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_an_end_separates_poses_from_none_to_a_trillionth_of_the_range(end: End) -> None:
    assert pose(end, 1e-12).condition > 1e5
    with pytest.raises(InfeasibleError):
        pose(end, 1e-12, "beyond")


def rack_ends(car: str) -> tuple[float, float]:
    low, high = (float(last_value(NAMED[car], "rack", ahead).value) for ahead in WAYS)
    return low, high


def test_the_ends_are_those_of_the_papers_car() -> None:
    """Found by continuation: 32.2 to 152.0 degrees at rack 0, -89 to 130 mm at a right angle."""
    arm = [float(last_value(PAPER, "arm_angle", ahead).value) for ahead in WAYS]
    assert np.allclose(np.degrees(arm), (32.2, 152.0), rtol=0, atol=0.1)
    assert np.allclose(rack_ends("paper"), (-89.0, 130.0), rtol=0, atol=0.2)


@pytest.mark.parametrize("car", ["paper", "wishbone"])
def test_rates_grow_as_the_inverse_root_of_the_distance(car: str) -> None:
    low, high = rack_ends(car)
    distances = np.array([1e-6, 1e-8, 1e-10])
    speeds = []
    for distance in distances.tolist():
        rack = [low + distance * (high - low), 1.0]
        scene = Scene.from_mapping(scene_content(CARS[car], SQUARE, rack))
        velocity = reference_instant(scene, inputs_at(scene, 0.0)).velocity["tie_rod_outer"]
        speeds.append(max(float(abs(x)) for x in velocity))
    slope = np.polyfit(np.log(distances), np.log(speeds), 1)[0]
    assert abs(slope + 0.5) < 1e-3


@pytest.mark.parametrize(
    "name", [name for name, case in BY_NAME.items() if "-held" in name and len(case.values) > 1]
)
def test_the_condition_number_shows_the_fold(name: str) -> None:
    result = examine(replace(BY_NAME[name], values=(1e-2, 1e-5, 1e-8, 1e-11)))
    assert as_expected([result]), result.unexpected
    conditions = [answer.condition for _, answer in result.answers("pointcoord")]
    growth = np.diff(np.log10(np.array(conditions, dtype=float)))
    # A thousandth of the distance makes 1e1.5 of it; the first step still feels the rest of the car.
    assert np.allclose(growth[1:], 1.5, rtol=0, atol=0.1)
