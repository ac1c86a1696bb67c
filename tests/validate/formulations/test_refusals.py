"""Models that refuse a scene for the same thing are seen to, and say which input, value and limit it is."""

from typing import Any

import pytest

from pointcoord import Scene, SceneError
from validate.formulations.protocol import FormulationError
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
    content = Scene.load(name).model_dump(exclude_none=True)
    content["mechanism"]["points"].update(points or {})
    if arm is not None:
        content["inputs"] = {"arm_angle": arm, "rack": {"constant": 0.0}}
    return Scene.from_mapping(content)


def refused(model: str, wrong: Scene) -> tuple[str, Refusal]:
    with pytest.raises((FormulationError, SceneError)) as caught:
        formulation(model).solve(wrong)
    error = caught.value
    if isinstance(error, SceneError):
        return HARDPOINTS, refusal_of(model, error, wrong)
    return why_refused(error), refusal_of(model, error.reason, wrong)


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


@pytest.mark.parametrize("name", ["off-axis-strut", "double-wishbone"])
def test_a_lock_is_told_with_the_same_instant_and_limit(name: str) -> None:
    start = Scene.load(name).inputs["arm_angle"].sine.offset
    wrong = scene(name, arm={"polynomial": [start, 0.05, 0.35]})
    absolute, relative = (refused(model, wrong)[1] for model in ("absolute", "relative"))
    assert relative.input == absolute.input == "arm_angle"
    assert relative.instant == absolute.instant
    assert relative.value == pytest.approx(absolute.value, abs=1e-12)
    # Both follow the way to a lock until their steps are some 1e-13 of it.
    assert relative.limit == pytest.approx(absolute.limit, abs=1e-9)
    assert relative.condition > 1e4
