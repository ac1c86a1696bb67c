"""The scenes of the study: those that it takes by itself, and how a user's own are taken."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources

from pointcoord import Scene
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import EFFECTS
from pointcoord.toml_text import parsed
from validate.cost.store import scene_digest

NEAR_TOGGLE = "near-toggle"
STUDY_SCENES = ("bounce", "steer", "bounce-and-steer", "off-axis-strut", "double-wishbone", NEAR_TOGGLE)
"""Those that are measured if none is named."""
QUICK_SCENE = "bounce-and-steer"
"""That of a quick study, and that whose car is solved at unrelated inputs: both inputs move."""
RATES = ("velocity", "acceleration", "knuckle_rates")


@dataclass(frozen=True)
class StudyScene:
    """A scene as it is measured.

    Attributes:
        name: in rows. digest: of its content.
    """

    name: str
    scene: Scene
    digest: str

    def positions_only(self) -> Scene:
        """The scene without any effect."""
        return self.scene.model_copy(update={"effects": ()})


def study_scene(name: str, scene: Scene) -> StudyScene:
    """A scene with what is measured of it.

    One that asks for any rate is measured with the velocities and accelerations of all points and of the
    knuckle, beside what it asks for; one that asks for positions, or angles, is measured so.
    """
    if plan_effects(scene.effects).derivative > 0:
        asked = {*scene.effects, *RATES}
        scene = scene.model_copy(update={"effects": tuple(effect for effect in EFFECTS if effect in asked)})
    return StudyScene(name, scene, scene_digest(scene))


def own_scene(name: str) -> Scene:
    """One of `STUDY_SCENES` by its name.

    Raises:
        SceneError: there is none.
    """
    if name == NEAR_TOGGLE:
        text = resources.files("validate.cost").joinpath("scenes", f"{NEAR_TOGGLE}.toml").read_bytes()
        return Scene.from_mapping(parsed(text, name), name)
    return Scene.load(name)
