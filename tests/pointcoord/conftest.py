"""The strut of the paper's table 1, and scenes of it or of another car, for all tests here."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from every_effect import asking_for_all
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

    def as_input(value: Any) -> Any:
        return value if isinstance(value, Mapping) else {"polynomial": [float(c) for c in value]}

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
        up: Any = (0.0, 0.0, 1.0),
        right: Any = (0.0, 1.0, 0.0),
        side: str | None = None,
        closure: str | None = None,
    ) -> Scene:
        inputs = {"arm_angle": as_input(arm_angle), "rack": as_input(rack)}
        if heave is not None:
            inputs["heave"] = as_input(heave)
        located = {name: tuple(np.asarray(p, float).tolist()) for name, p in (points or car.points).items()}
        scene = Scene.from_mapping(
            {
                "effects": effects or (),
                "tolerance": tolerance,
                "mechanism": {
                    "type": car.type,
                    "closure": closure or car.closure,
                    "side": side or car.side,
                    "points": located,
                    "wheel_radius": 300.0,
                    "car": {
                        "axle": "front",
                        "wheelbase": 2500.0,
                        "centre_of_gravity_height": 500.0,
                        "brake_share": 0.6,
                        "drive_share": 0.3,
                        "spring_rate": 30.0,
                        "spring_free_length": 600.0,
                    },
                    "up": tuple(np.asarray(up, float).tolist()),
                    "right": tuple(np.asarray(right, float).tolist()),
                },
                "inputs": inputs,
                "time": {"start": float(start), "stop": float(stop), "samples": samples},
            }
        )
        return scene if effects is not None else asking_for_all(scene)

    return make
