"""Models that refuse a scene for the same thing are seen to.

That what they solved before it holds is tried by the hard cases of ends.
"""

import sys
from typing import Any

import pytest
from changed_scenes import scene_with

from pointcoord import MissingLibrary, Scene, SceneError
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
from validate.formulations.registry import OUTSIDE, formulation

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


@pytest.mark.parametrize("who", OUTSIDE)
def test_a_program_that_is_not_installed_is_told_with_its_package_and_extra(
    who: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, who, None)
    monkeypatch.delitem(sys.modules, f"validate.peers.in_{who}", raising=False)
    with pytest.raises(MissingLibrary) as caught:
        formulation(who)
    assert f"needs the package {who!r}, which is not installed" in str(caught.value)
    assert "pip install 'pointcoord[peers]'" in str(caught.value)
