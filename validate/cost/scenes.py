r"""The scenes of the study, and the instants at which every method solves and errors are measured.

The instants must not favour any method. They must not be the ends of a chain's segments, where Newton's
method has just been applied, nor an even grid, on which differences and sums of periodic motions cancel. So
the time of a scene is divided into N equal parts, and instant i lies in part i at an offset from the golden
ratio phi,

    t_i = start + (i + frac((i + 1) / phi)) (stop - start) / N,        i = 0 .. N - 1.

Multiples of the golden ratio stay as far as possible from fractions with small denominators (Hurwitz).
"""

from __future__ import annotations

import math
from importlib import resources

import numpy as np

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS, plan_effects
from pointcoord.toml_text import parsed
from validate.arrays import Array

NEAR_TOGGLE = "near-toggle"
STUDY_SCENES = ("bounce", "steer", "bounce-and-steer", "off-axis-strut", "double-wishbone", NEAR_TOGGLE)
"""The scenes that are measured if none is named."""
QUICK_SCENE = "bounce-and-steer"
"""The scene of a quick study: both inputs move."""
RATES = ("velocity", "acceleration", "knuckle_rates")
GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0
# Largest number of instants: the reference takes some 5 ms for each, and more show no larger errors.
MOST, MOST_QUICK = 200, 24


def with_rates(scene: Scene) -> Scene:
    """A scene with the effects that are measured.

    If the scene asks for any rate, the velocities and accelerations of all points and of the knuckle are
    measured in addition. If it asks only for positions or angles, nothing is added.
    """
    if plan_effects(scene.effects).derivative > 0:
        asked = {*scene.effects, *RATES}
        scene = scene.model_copy(update={"effects": tuple(effect for effect in EFFECTS if effect in asked)})
    return scene


def own_scene(name: str) -> Scene:
    """A scene of `STUDY_SCENES` by its name.

    Raises:
        SceneError: there is no such scene.
    """
    if name == NEAR_TOGGLE:
        text = resources.files("validate.cost").joinpath("scenes", f"{NEAR_TOGGLE}.toml").read_bytes()
        return Scene.from_mapping(parsed(text, name), name)
    return Scene.load(name)


def study_instants(scene: Scene, count: int | None = None, *, quick: bool = False) -> Array:
    """Instants inside a scene's time, increasing, shape (N,), s.

    Args:
        count: N; if None, the number of the scene's samples, but at most 200, or 24 for a quick study.
    """
    if scene.time.start == scene.time.stop:
        return np.array([scene.time.start])
    count = count or min(scene.time.samples, MOST_QUICK if quick else MOST)
    places = np.arange(count) + np.modf(np.arange(1, count + 1) / GOLDEN)[0]
    instants = scene.time.start + places * ((scene.time.stop - scene.time.start) / count)
    return np.asarray(np.clip(instants, scene.time.start, scene.time.stop))
