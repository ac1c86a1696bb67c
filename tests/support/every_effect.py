"""Scenes that ask for all that their cars have."""

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS

OF_A_WHEEL = tuple(
    name
    for name, effect in EFFECTS.items()
    if (effect.lines or effect.derivative) and not getattr(effect, "of_axle", False)
)
"""The effects that a mechanism without parts and loads may have."""


def every_effect(name: str) -> Scene:
    """A built-in scene with every effect of its car but derivatives by an input."""
    return asking_for_all(Scene.load(name))


def asking_for_all(scene: Scene) -> Scene:
    """The same of any scene."""
    had = [name for name in scene.mechanism.effects if not EFFECTS[name].way]
    return scene.model_copy(update={"effects": had})
