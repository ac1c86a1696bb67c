"""The points of the paper's table 1, and scenes of its strut or of another car, for all tests here."""

from collections.abc import Callable, Mapping
from typing import Any

import pytest
from changed_scenes import scene_with
from every_number import NUMBERS_OF_A_CAR, asking_for_all

from pointcoord import Scene

Points = Mapping[str, tuple[float, ...]]


@pytest.fixture(scope="session")
def table() -> Points:
    """Table 1 of the paper, mm."""
    return Scene.load("bounce").mechanism.points


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., Scene]:
    """A scene of some shipped car; an input is a law as in a scene file, or the numbers of a polynomial."""

    def make(
        arm_angle: Any = (0.8, 0.25, 0.0625),
        rack: Any = (0.0,),
        *,
        heave: Any = None,
        start: float = 0.0,
        stop: float = 2.0,
        samples: int = 9,
        effects: tuple[str, ...] | None = None,
        tolerance: float = 1e-9,
        car: str = "bounce",
        **mechanism: Any,
    ) -> Scene:
        given = {"arm_angle": arm_angle, "rack": rack} | ({} if heave is None else {"heave": heave})
        inputs = {
            name: law if isinstance(law, Mapping) else {"polynomial": [*map(float, law)]}
            for name, law in given.items()
        }
        own = {"wheel_radius": 300.0, "car": {"axle": "front", **NUMBERS_OF_A_CAR}, **mechanism}
        time = {"start": float(start), "stop": float(stop), "samples": samples}
        asked = {"effects": effects or (), "tolerance": tolerance}
        scene = scene_with(car, own, inputs=inputs, time=time, **asked)
        return scene if effects is not None else asking_for_all(scene)

    return make
