"""Built-in scenes that ask for all that their cars have."""

from pointcoord import Scene


def every_effect(name: str) -> Scene:
    """A built-in scene with every effect of its car."""
    scene = Scene.load(name)
    return scene.model_copy(update={"effects": scene.mechanism.effects})
