"""Scenes that ask for all that their cars have."""

from pointcoord import Scene
from pointcoord.effects.car_number import BY_ROLL
from pointcoord.effects.registry import EFFECTS

NUMBERS_OF_A_CAR = {
    "wheelbase": 2618.3,
    "centre_of_gravity_height": 511.7,
    "brake_share": 0.37,
    "drive_share": 0.91,
    "spring_rate": 31.7,
    "spring_free_length": 823.9,
}
"""All that a scene may say of the whole car but which of its axles this is."""

OF_A_WHEEL = tuple(
    name
    for name, effect in EFFECTS.items()
    if (effect.lines or effect.derivative)
    and not (effect.reports_states and effect.base)
    and not getattr(effect, "of_axle", False)
    and effect.way != BY_ROLL
)
"""The effects that a mechanism without parts, loads and a chassis that rolls may have, without derivatives of
points that have only a number."""


def every_effect(name: str) -> Scene:
    """A built-in scene with every effect of its car but derivatives by an input."""
    return asking_for_all(Scene.load(name))


def asking_for_all(scene: Scene) -> Scene:
    """The same of any scene."""
    had = [name for name in scene.mechanism.effects if not EFFECTS[name].way]
    return scene.model_copy(update={"effects": had})
