"""The strut of the paper's table 1, and scenes of it or of another car, for all tests here."""

from collections.abc import Callable, Mapping
from typing import Any

import pytest
from every_effect import NUMBERS_OF_A_CAR, asking_for_all
from sample_cars import PAPER_STRUT, SampleCar

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from validate.cars.car import Points
from validate.cars.paper_car import PAPER


@pytest.fixture(scope="session")
def table() -> Points:
    """Table 1 of the paper, mm."""
    return dict(PAPER)


@pytest.fixture(scope="session")
def strut() -> Mechanism:
    """The strut of table 1, axes x rearward, y right, z up."""
    return PAPER_STRUT.mechanism()


@pytest.fixture(scope="session")
def make_scene() -> Callable[..., Scene]:
    """A scene of some car; an input is a mapping as in a scene file, or the numbers of a polynomial."""

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
        car: SampleCar = PAPER_STRUT,
        points: Mapping[str, Any] | None = None,
        closure: str | None = None,
    ) -> Scene:
        given = {"arm_angle": arm_angle, "rack": rack} | ({} if heave is None else {"heave": heave})
        content = {
            "effects": effects or (),
            "tolerance": tolerance,
            "mechanism": {
                "type": car.type,
                "closure": closure or car.closure,
                "side": car.side,
                "points": {n: tuple(map(float, place)) for n, place in (points or car.points).items()},
                "wheel_radius": 300.0,
                "car": {"axle": "front", **NUMBERS_OF_A_CAR},
            },
            "inputs": {
                name: law if isinstance(law, Mapping) else {"polynomial": [*map(float, law)]}
                for name, law in given.items()
            },
            "time": {"start": float(start), "stop": float(stop), "samples": samples},
        }
        scene = Scene.from_mapping(content)
        return scene if effects is not None else asking_for_all(scene)

    return make
