"""A car that rolls, pitches and heaves while its arm and rack move, in point coordinates.

Every number is held to the reference, which turns the car in many digits, within its own proven bound: far
from the origin here, and near it with every other mechanism in test_formulations.
"""

import tomllib
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from pointcoord import InputOutOfRange, Scene, simulate
from pointcoord.effects.point_states import NAMED
from pointcoord.mechanism.file import MECHANISMS
from validate import compare

Array = NDArray[np.float64]
MOTIONS = {
    "heave": {"moves": "chassis", "along": "up"},
    "roll": {"turns": "chassis", "about": "lower_arm_front", "along": "forward"},
    "pitch": {"turns": "chassis", "about": "wheel_centre", "along": "left"},
}
HIGHER = (*NAMED[3:], "derivative_9")
LAWS = {
    "heave": {"sine": {"amplitude": 12.0, "angular_frequency": 3.0}},
    "roll": {"sine": {"amplitude": 0.2, "angular_frequency": 3.0, "phase": 0.3, "offset": 7.0}},
    "pitch": {"polynomial": [0.02, -0.3, 0.25]},
}


@cache
def turning(name: str, far: bool = False, order: tuple[str, ...] = ("heave", "roll", "pitch")) -> Scene:
    """A built-in scene whose car is moved as a whole too, and may be drawn far from the origin."""
    content = Scene.load(name).model_dump(exclude_none=True)
    part = content["mechanism"]
    tables = tomllib.loads((MECHANISMS / f"{part.pop('type')}.toml").read_text())
    tables["inputs"] |= {motion: MOTIONS[motion] for motion in order}
    shift = (1e5, 0.0, -3e5) if far else (0.0, 0.0, 0.0)
    part["points"] = {n: (np.array(p) + shift).tolist() for n, p in part["points"].items()}
    part.pop("driven", None)
    content["mechanism"] = part | tables
    content["effects"] = [*content["effects"], *HIGHER]
    content["inputs"] |= {motion: LAWS[motion] for motion in reversed(order)}
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": 9}
    return Scene.from_mapping(content)


def test_absolute_displaces_the_car_along_every_direction_at_once() -> None:
    content = turning("double-wishbone").model_dump(exclude_none=True)
    for speed, along in enumerate(("down", "left", "right", "forward", "rearward"), 1):
        content["mechanism"]["inputs"][along] = {"moves": "chassis", "along": along}
        content["inputs"][along] = {"polynomial": [5.0, 2.0**speed]}
    assert compare(Scene.from_mapping(content), "pointcoord", "absolute").agreed


def law_at(scene: Scene, name: str, instant: float) -> float:
    return float(scene.functions[name].series(np.array([instant]), 0)[0, 0])


def turned_by_hand(places: Array, scene: Scene, names: tuple[str, ...], instant: float) -> Array:
    """Roll is about -x and pitch about -y of these cars, each about the drawn place of its point."""
    axes = {"roll": [-1.0, 0.0, 0.0], "pitch": [0.0, -1.0, 0.0]}
    for name in names:
        about = np.array(scene.mechanism.points[MOTIONS[name]["about"]])
        angle = law_at(scene, name, instant)
        places = about + Rotation.from_rotvec(angle * np.array(axes[name])).apply(places - about)
    return places


def test_turns_follow_each_other_in_the_order_of_the_file() -> None:
    places = {}
    still = Scene.load("double-wishbone").model_dump(exclude_none=True)
    still["time"] = {"start": 0.0, "stop": 1.0, "samples": 9}
    car = simulate(Scene.from_mapping(still))
    for order in (("heave", "roll", "pitch"), ("pitch", "heave", "roll")):
        scene = turning("double-wishbone", order=order)
        motion = simulate(scene)
        turns = tuple(name for name in order if name != "heave")
        for name, place in motion.position.items():
            meant = turned_by_hand(car.position[name][4:5], scene, turns, 0.5)
            meant[0, 2] += law_at(scene, "heave", 0.5)
            np.testing.assert_allclose(place[4:5], meant, rtol=0.0, atol=1e-11)
        places[order] = motion.position["wheel_centre"]
    first, second = places.values()
    assert np.abs(first - second).max() > 1.0


def test_a_car_that_turns_too_fast_is_refused_with_when_and_what() -> None:
    content = turning("double-wishbone").model_dump(exclude_none=True)
    content["inputs"]["roll"] = {"polynomial": [0.0, 1e141]}
    with pytest.raises(InputOutOfRange, match="below 1e\\+140 rad/s in size"):
        simulate(Scene.from_mapping(content))
