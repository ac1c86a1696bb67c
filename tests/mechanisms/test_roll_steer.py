"""What numbers of a wheel change by as the chassis rolls."""

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate import compare

ROLLING = Scene.load("axle-roll")
STILL = {"start": 0.0, "stop": 0.0, "samples": 1}
EFFECTS = ("wheel_angles", "toe", "wheel_travel", "steering_axis")


def rolled(scene: Scene, angle: float) -> Scene:
    """A scene at one angle of roll, with its numbers and what they change by."""
    laws = {name: law.model_dump(exclude_none=True) for name, law in scene.inputs.items()}
    held = {"inputs": laws | {"roll": {"constant": angle}}, "time": STILL}
    return scene.model_copy(update={**held, "effects": (*EFFECTS, *(f"{one}_by_roll" for one in EFFECTS))})


@pytest.mark.parametrize("angle", [0.0, 0.03])
def test_numbers_by_roll_are_the_differences_of_two_scenes(angle: float) -> None:
    step = 2.0**-14
    here, behind, ahead = (simulate(rolled(ROLLING, angle + of * step)) for of in (0, -1, 1))
    for plain, by_roll in (("wheel", here.angle_by_roll), ("dimension", here.dimension_by_roll)):
        assert by_roll
        for name, slope in by_roll.items():
            one, other = (getattr(of, plain)[name.removesuffix("_by_roll")] for of in (behind, ahead))
            # Central: off by step^2 / 6 of the third derivative, here below 1e4 mm/rad^3, and by rounding of
            # 1e-12 over the step.
            np.testing.assert_allclose(slope, (other - one) / (2 * step), rtol=0, atol=1e-5)


def test_all_models_have_the_same_numbers_by_roll() -> None:
    effects = [name for name in ROLLING.mechanism.effects if name.endswith("_by_roll")]
    outcome = compare(ROLLING.model_copy(update={"effects": effects}), "pointcoord", "absolute")
    assert outcome.agreed
    assert sum(row.name.endswith("_by_roll") for row in outcome.rows) > 20


def test_roll_steer_is_what_toe_changes_by_per_second_as_the_car_rolls_by_a_radian_in_it() -> None:
    laws = {name: law.model_dump(exclude_none=True) for name, law in ROLLING.inputs.items()}
    moving = {
        "inputs": laws | {"roll": {"polynomial": [0.0, 1.0]}},
        "effects": ("toe_by_roll", "toe_by_time"),
    }
    time = {"start": -0.05, "stop": 0.05, "samples": 5}
    motion = simulate(ROLLING.model_copy(update={**moving, "time": time}))
    for side in ("left", "right"):
        by_roll, by_time = (
            motion.angle_by_roll[f"{side}.toe_by_roll"],
            motion.angle_rate[f"{side}.toe_by_time"],
        )
        np.testing.assert_allclose(by_roll, by_time, rtol=0, atol=1e-12)
