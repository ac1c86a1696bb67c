"""Numbers of the car by time: faults of theirs are seen."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import absolute.results
from absolute.dual import Dual
from pointcoord import Scene
from pointcoord.bounds.enclosed_points import EnclosedPoses
from pointcoord.effects.car_number import CarNumbers
from pointcoord.effects.corner import Corner
from pointcoord.effects.effect import Poses
from pointcoord.effects.gradients import BY_TIME
from pointcoord.effects.registry import EFFECTS
from validate.comparison.compare import compare, compare_solutions
from validate.formulations.registry import formulation

Zero = Callable[[Any], Any]

# A car that rolls, one with a rocker, and one that heaves.
SCENES = ("axle-roll", "pushrod", "bounce-on-a-heaving-chassis")
each_scene = pytest.mark.parametrize("name", SCENES)


def by_time(name: str) -> Scene:
    """A shipped scene with every number of its car by time, and the numbers themselves."""
    scene = Scene.load(name)
    effects = [e for e in scene.mechanism.effects if e.endswith(BY_TIME)]
    return scene.model_copy(update={"effects": (*effects, *(EFFECTS[e].base for e in effects))})


NEAR = 1e-10  # relative: a million roundings


@each_scene
def test_a_rate_that_is_a_little_off_is_seen(name: str) -> None:
    scene = by_time(name)
    ours, theirs = (formulation(who).solve(scene) for who in ("pointcoord", "absolute"))
    for quantity in ("angle_rate", "dimension_rate"):
        wrong = {n: array * (1.0 + NEAR) for n, array in theirs.numbers[quantity].items()}
        outcome = compare_solutions(scene, ours, theirs.with_numbers({quantity: wrong}), name)
        assert {row.name for row in outcome.disagreements} == {n for n in wrong if wrong[n].any()}


def _before_the_turns(patch: pytest.MonkeyPatch) -> None:
    """Pointcoord's velocities are those in the chassis' frame."""
    moving = CarNumbers._moving

    def wrong(
        self: CarNumbers, corner: Corner[Any], poses: Poses | EnclosedPoses, states: object, zero: Zero
    ) -> Corner[Any]:
        return moving(self, corner, poses, poses.in_chassis, zero)

    patch.setattr(CarNumbers, "_moving", wrong)


def _turns_that_stand_still(patch: pytest.MonkeyPatch) -> None:
    """The absolute model's lines move as if the chassis did not turn on."""

    def wrong(self: absolute.results.Motion, vector: np.ndarray) -> Dual:
        seen = (self.turned(vector) * self.mechanism.drawing.size).T
        return Dual(seen[..., 0], seen[..., 1:])

    patch.setattr(absolute.results.Motion, "_seen", wrong)


@pytest.mark.parametrize("plant", [_before_the_turns, _turns_that_stand_still])
def test_a_chassis_whose_turning_is_forgotten_is_seen(
    plant: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    plant(monkeypatch)
    outcome = compare(by_time("axle-roll"), "pointcoord", "absolute")
    assert {row.quantity for row in outcome.disagreements} == {"angle_rate", "dimension_rate"}
