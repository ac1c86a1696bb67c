"""The ends of the inputs: where they are, that each is a fold, and that its lock is the one that it says."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.input_limits import ARM, TIE_ROD
from validate.cars.scene_content import SQUARE, scene_content
from validate.hard.cars import CARS
from validate.hard.cases.dead_points import CASES, Approach, ends, rack_ends
from validate.hard.run import as_expected, examine
from validate.reference import InfeasibleError, Instant

BY_NAME = {case.name: case for case in CASES}
WAYS = (False, True)
ENDS = [
    *((Approach(car, "arm_angle", up), ARM) for car in ("paper", "other", "short-arm") for up in WAYS),
    *((Approach(car, "rack", up, SQUARE), TIE_ROD) for car in ("paper", "other", "wishbone") for up in WAYS),
    (Approach("wide", "arm_angle", False), "strut"),
    (Approach("wishbone", "arm_angle", True), "upper_arm"),
    (Approach("wishbone", "arm_angle", False), TIE_ROD),
]


def pose(approach: Approach, value: float, law: str = "held") -> Instant:
    """The reference near an end, or beyond it."""
    scene = Scene.from_mapping(approach.content(value, law))
    return reference_instant(scene, inputs_at(scene, 0.0))


@pytest.mark.parametrize(("approach", "lock"), ENDS, ids=str)
def test_an_end_separates_poses_from_none_to_a_trillionth_of_the_range(approach: Approach, lock: str) -> None:
    assert pose(approach, 1e-12).condition > 1e5
    with pytest.raises(InfeasibleError) as refusal:
        pose(approach, 1e-12, "beyond")
    assert refusal.value.closure == lock


def test_the_ends_are_those_of_the_papers_car() -> None:
    """Found by continuation: 32.2 to 152.0 degrees at rack 0, -89 to 130 mm at a right angle."""
    assert np.allclose(np.degrees(ends("paper", "arm_angle")), (32.2, 152.0), rtol=0, atol=0.1)
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


@pytest.mark.parametrize("name", [name for name in BY_NAME if "-held" in name])
def test_the_condition_number_shows_the_fold(name: str) -> None:
    result = examine(replace(BY_NAME[name], values=(1e-2, 1e-5, 1e-8, 1e-11)))
    assert as_expected([result]), result.unexpected
    conditions = [answer.condition for _, answer in result.answers("pointcoord")]
    growth = np.diff(np.log10(np.array(conditions, dtype=float)))
    # A thousandth of the distance makes 1e1.5 of it; the first step still feels the rest of the car.
    assert np.allclose(growth[1:], 1.5, rtol=0, atol=0.1)
