"""A car that rolls, pitches and heaves while its wheel bounces and is steered: directions and order of that.

Every number of the car, near the origin and far from it, is held to the reference in test_formulations.
"""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from pointcoord import InputOutOfRange, Scene, simulate
from validate import compare

TURNED = Scene.load(Path(__file__).with_name("roll-pitch-heave.toml")).model_dump(exclude_none=True)
# Of this car, whose x leads rearward: forward and left.
AXES = {"roll": [-1.0, 0.0, 0.0], "pitch": [0.0, -1.0, 0.0]}


def turned(drives: dict[str, Any] | None = None, **laws: Any) -> Scene:
    """The car with other inputs that can be driven, or with other laws of them."""
    part, drives = TURNED["mechanism"], drives or TURNED["mechanism"]["inputs"]
    time = {"start": 0.0, "stop": 1.0, "samples": 5}
    inputs = {**TURNED["inputs"], **laws}
    return Scene.from_mapping(
        TURNED | {"mechanism": {**part, "inputs": drives}, "inputs": inputs, "time": time}
    )


def test_absolute_displaces_the_car_along_every_direction_at_once() -> None:
    ways = ("down", "left", "right", "forward", "rearward")
    drives = TURNED["mechanism"]["inputs"] | {way: {"moves": "chassis", "along": way} for way in ways}
    laws = {way: {"polynomial": [5.0, 2.0**speed]} for speed, way in enumerate(ways, 1)}
    assert compare(turned(drives, **laws), "pointcoord", "absolute").agreed


def test_turns_follow_each_other_in_the_order_of_the_file() -> None:
    still = simulate(turned(**{name: {"constant": 0.0} for name in (*AXES, "heave")}))
    middle, places = np.array(TURNED["mechanism"]["points"]["middle"]), []
    for order in (("heave", "roll", "pitch"), ("pitch", "heave", "roll")):
        drives = {n: d for n, d in TURNED["mechanism"]["inputs"].items() if n not in order}
        scene = turned(drives | {name: TURNED["mechanism"]["inputs"][name] for name in order})
        motion, values = simulate(scene), {n: f.series(0.5, 0)[0] for n, f in scene.functions.items()}
        for name, place in motion.position.items():
            meant = still.position[name][2]
            for turn in (name for name in order if name != "heave"):
                by = Rotation.from_rotvec(values[turn] * np.array(AXES[turn]))
                meant = middle + by.apply(meant - middle)
            lift = np.array([0.0, 0.0, values["heave"]])
            np.testing.assert_allclose(place[2], meant + lift, rtol=0.0, atol=1e-11)
        places.append(motion.position["wheel_centre"][2])
    assert np.abs(places[0] - places[1]).max() > 0.1


def test_a_car_that_turns_too_fast_is_refused_with_when_and_what() -> None:
    with pytest.raises(InputOutOfRange, match="below 1e\\+140 rad/s in size"):
        simulate(turned(roll={"polynomial": [0.0, 1e141]}))
