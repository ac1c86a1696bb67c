"""A scene in other units and axes is the same car."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, simulate
from pointcoord.scene.own_units import UNITS, in_mm

CAR: dict[str, Any] = {
    "axle": "front",
    "wheelbase": 2500.0,
    "centre_of_gravity_height": 500.0,
    "brake_share": 0.6,
    "drive_share": 0.0,
}


def plain(name: str) -> dict[str, Any]:
    content = Scene.load(name).model_dump(exclude_none=True)
    content["mechanism"] |= {"wheel_radius": 300.0, "car": CAR}
    return content


def of_length(name: str) -> set[str]:
    structure = Scene.load(name).mechanism.structure
    return {input for input, one in structure.inputs.items() if one.unit == "mm"}


# Inputs that are angles, heights, distances and travels; parts; a law of each form.
@pytest.mark.parametrize(
    "name", ["bounce-on-a-heaving-chassis", "pushrod-by-damper", "axle-roll", "slider-crank"]
)
@pytest.mark.parametrize(("units", "as_given"), [("m", list), ("in", np.array)])
def test_every_length_of_a_scene_is_in_its_units_and_nothing_else_is(
    name: str, units: str, as_given: Callable[[list[float]], Any]
) -> None:
    content, factor = plain(name), UNITS[units]
    there = in_mm({**content, "units": "mm"}, ())
    # Written in the other unit, by the same rule backwards: a length is divided, all else stays.
    lengths = of_length(name)
    written: dict[str, Any] = {**content, "units": units, "tolerance": content["tolerance"] / factor}
    part = written["mechanism"] = dict(content["mechanism"])
    part["points"] = {n: as_given([c / factor for c in p]) for n, p in part["points"].items()}
    part["wheel_radius"] = 300.0 / factor
    part["car"] = CAR | {n: CAR[n] / factor for n in ("wheelbase", "centre_of_gravity_height")}

    def divided(value: Any, of: str = "") -> Any:
        if isinstance(value, dict):
            still = ("angular_frequency", "phase", "times")
            return {n: v if n in still else divided(v, n) for n, v in value.items()}
        if isinstance(value, list | tuple):
            return as_given([divided(v) for v in value])
        return value / factor

    written["inputs"] = {n: divided(law) if n in lengths else law for n, law in content["inputs"].items()}
    found, wanted = Scene.from_mapping(written), Scene.from_mapping(there)
    assert found.tolerance == pytest.approx(wanted.tolerance, rel=1e-15)
    for point, place in wanted.mechanism.points.items():
        # Divided and multiplied again, each rounded once.
        assert (
            np.abs(np.subtract(found.mechanism.points[point], place)).max() <= 2.0**-51 * np.abs(place).max()
        )
    assert found.mechanism.axes.car.keys() == wanted.mechanism.axes.car.keys()
    for key, number in wanted.mechanism.axes.car.items():
        assert found.mechanism.axes.car[key] == pytest.approx(number, rel=1e-15)
    instants = wanted.instants
    for input, law in wanted.functions.items():
        values, here = law.series(instants, 0), found.functions[input].series(instants, 0)
        assert np.abs(here - values).max() <= 2.0**-48 * np.abs(values).max(initial=0.0), input


@pytest.mark.parametrize(
    ("axes", "turn"),
    [("iso", [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]), ("sae", [[-1, 0, 0], [0, 1, 0], [0, 0, -1]])],
)
def test_a_car_in_named_axes_has_the_same_angles_and_its_points_in_these(
    axes: str, turn: list[list[int]]
) -> None:
    here = Scene.load("double-wishbone").model_dump(exclude_none=True)
    there = {**here, "mechanism": {n: v for n, v in here["mechanism"].items() if n not in ("up", "right")}}
    points = {n: list(np.array(turn) @ p) for n, p in here["mechanism"]["points"].items()}
    there["mechanism"] |= {"axes": axes, "points": points}
    one, two = simulate(Scene.from_mapping(here)), simulate(Scene.from_mapping(there))
    for name, angle in one.wheel.items():
        # Turns of the axes are exact; what is summed in another order is rounded anew.
        assert np.abs(two.wheel[name] - angle).max() < 1e-12
    centre = one.position["wheel_centre"] @ np.array(turn).T
    assert np.abs(two.position["wheel_centre"] - centre).max() < 1e-9
