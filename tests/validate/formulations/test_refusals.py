"""Models that refuse a scene for the same thing are seen to; what they solved before it holds."""

from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import Scene, SceneError
from validate.formulations.protocol import FormulationError, Solution
from validate.formulations.refusals import (
    DRAWING,
    HARDPOINTS,
    INPUT,
    MOTION,
    START,
    Refusal,
    refusal_of,
    same_reason,
    why_refused,
)
from validate.formulations.registry import formulation

MODELS = ("pointcoord", "absolute", "relative")


def scene(name: str, points: dict[str, Any] | None = None, arm: Any = None) -> Scene:
    """A built-in scene with other points, or with its arm driven otherwise."""
    laws = {} if arm is None else {"arm_angle": arm, "rack": {"constant": 0.0}}
    return scene_with(name, {"points": points or {}}, laws=laws)


def refused(model: str, wrong: Scene) -> tuple[str, Refusal]:
    with pytest.raises((FormulationError, SceneError)) as caught:
        formulation(model).solve(wrong)
    return why_refused(caught.value), refusal_of(model, caught.value, wrong)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (scene("steer", {"rack_centre": (570, 60, 2000)}), DRAWING),
        (scene("steer", {"lower_arm_rear": (270, -5, -10)}), HARDPOINTS),
        (
            scene("off-axis-strut", {"tie_rod_inner": (150, -330, 320), "rack_centre": (150, -330, 285)}),
            HARDPOINTS,
        ),
        (scene("double-wishbone", arm={"constant": 3.0}), START),
        (scene("off-axis-strut", arm={"polynomial": [1.63, 0.05, 0.35]}), MOTION),
        (scene("bounce", arm={"constant": 3.5}), INPUT),
    ],
    ids=["open-drawing", "no-axis", "another-car", "start", "motion", "input"],
)
def test_all_models_refuse_a_scene_for_the_same_reason(wrong: Scene, reason: str) -> None:
    for model in MODELS:
        found, refusal = refused(model, wrong)
        if (model, reason) == ("absolute", INPUT):
            continue  # it looks for a pose at any angle, and finds that the arm does not get there
        assert same_reason(found, reason), (model, refusal)
        assert refusal.formulation == model
        assert refusal.message


def locking(name: str) -> Scene:
    """A built-in scene whose arm leaves its range before the last instant."""
    (start,) = Scene.load(name).functions["arm_angle"].series(0.0, 0)
    return scene(name, arm={"polynomial": [float(start), 0.05, 0.35]})


def partial(solver: str, scene: Scene) -> Solution:
    with pytest.raises(FormulationError) as caught:
        formulation(solver).solve(scene)
    assert caught.value.partial is not None
    return caught.value.partial


@pytest.mark.parametrize(
    ("name", "solver", "other"),
    [("off-axis-strut", "pointcoord", "absolute"), ("double-wishbone", "pointcoord-newton", "relative")],
)
def test_what_both_models_solved_before_a_lock_agrees_within_their_claims(
    name: str, solver: str, other: str
) -> None:
    scene = locking(name)
    one, two = partial(solver, scene), partial(other, scene)
    np.testing.assert_array_equal(one.times, two.times)
    assert 10 < len(one.times) < len(scene.instants)
    # Models that are outside witnesses give no gradients.
    assert {"position", "wheel"} <= two.numbers.keys() <= one.numbers.keys()
    for quantity, arrays in two.numbers.items():
        for point, array in arrays.items():
            claims = (s.accuracy.claims[quantity][point] for s in (one, two))
            assert (np.abs(array - one.numbers[quantity][point]) <= sum(claims)).all(), (quantity, point)
