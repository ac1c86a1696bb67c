"""A scene in other units and axes is the same car."""

import json
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene
from pointcoord.scene.reading import UNITS

CAR: dict[str, Any] = {
    "axle": "front",
    "wheelbase": 2500.0,
    "centre_of_gravity_height": 500.0,
    "brake_share": 0.6,
    "drive_share": 0.0,
}
LOAD = {"force": [700.0, -400.0, 3000.0], "moment": [2e4, -1e5, 3e4]}
# A scene of one wheel, whose rack a steering wheel may move.
STEERED = "pushrod-by-damper"


def plain(name: str) -> dict[str, Any]:
    content = Scene.load(name).model_dump(exclude_none=True)
    content["mechanism"] |= {"wheel_radius": 300.0, "car": CAR}
    if name == STEERED:
        content["mechanism"] |= {"rack_per_turn": 44.0, "loads": {"": LOAD}}
    return content


def numbers(plain: Any) -> list[float]:
    """All that are in nested tables and lists."""
    return [float(text) for text in re.findall(r"-?\d+\.\d+(?:e[+-]\d+)?", json.dumps(plain))]


# Inputs that are angles, heights, distances and travels; parts; a law of each form.
@pytest.mark.parametrize(
    "name", ["bounce-on-a-heaving-chassis", "pushrod-by-damper", "axle-roll", "slider-crank"]
)
@pytest.mark.parametrize(("units", "as_given"), [("m", list), ("in", np.array)])
def test_every_length_of_a_scene_is_in_its_units_and_nothing_else_is(
    name: str, units: str, as_given: Callable[[list[float]], Any]
) -> None:
    content, factor = plain(name), UNITS[units]
    # Written in the other unit, by the same rule backwards: a length is divided, all else stays.
    inputs = Scene.load(name).mechanism.structure.inputs
    lengths = {input for input, one in inputs.items() if one.unit == "mm"}
    written: dict[str, Any] = {**content, "units": units, "tolerance": content["tolerance"] / factor}
    part = written["mechanism"] = dict(content["mechanism"])
    part["points"] = {n: as_given([c / factor for c in p]) for n, p in part["points"].items()}
    part["wheel_radius"] = 300.0 / factor
    if name == STEERED:
        moment = as_given([m / factor for m in LOAD["moment"]])
        part |= {"rack_per_turn": 44.0 / factor, "loads": {"": {**LOAD, "moment": moment}}}
    part["car"] = CAR | {n: CAR[n] / factor for n in ("wheelbase", "centre_of_gravity_height")}

    def divided(value: Any, of: str = "") -> Any:
        if isinstance(value, dict):
            still = ("angular_frequency", "phase", "times")
            return {n: v if n in still else divided(v, n) for n, v in value.items()}
        if isinstance(value, list | tuple):
            return as_given([divided(v) for v in value])
        return value / factor

    written["inputs"] = {n: divided(law) if n in lengths else law for n, law in content["inputs"].items()}
    found, wanted = Scene.from_mapping(written), Scene.from_mapping({**content, "units": "mm"})
    assert found.tolerance == pytest.approx(wanted.tolerance, rel=1e-15)
    one, other = (numbers(scene.mechanism.plain(lengths)) for scene in (wanted, found))
    assert len(one) > 3 * len(wanted.mechanism.points)
    # Divided and multiplied again, each rounded once.
    assert other == pytest.approx(one, rel=2.0**-51, abs=0.0)
    instants = wanted.instants
    for input, law in wanted.functions.items():
        values, here = law.series(instants, 0), found.functions[input].series(instants, 0)
        assert np.abs(here - values).max() <= 2.0**-48 * np.abs(values).max(initial=0.0), input


@pytest.mark.parametrize(
    ("axes", "turn"),
    [("iso", [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]), ("sae", [[-1, 0, 0], [0, 1, 0], [0, 0, -1]])],
)
def test_named_axes_are_those_of_a_car_that_is_turned(axes: str, turn: list[list[int]]) -> None:
    """Which has the numbers of the car that is not; see tests/mechanisms/test_symmetries.py."""
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    part = content["mechanism"]
    up, right = (np.array(turn) @ part.pop(name) for name in ("up", "right"))
    part |= {"axes": axes, "points": {n: list(np.array(turn) @ p) for n, p in part["points"].items()}}
    found = Scene.from_mapping(content).mechanism
    assert found.up == tuple(up)
    assert found.right == tuple(right)
