"""Solvers with a planted fault, for `--solver faulty:with_NAME`: ours, and then one thing wrong.

What is right is taken from the program itself, by its public names alone; the scene is the one that the
variable ORACLE_SCENE names.
"""

from __future__ import annotations

import os
import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from pointcoord.numerics.arrays import Array

Numbers = dict[str, dict[str, Array]]
Fault = Callable[[Numbers, Array], Numbers]

SCENES = Path(__file__).parent / "given" / "scenes"
STATES = ("position", "velocity", "acceleration")
TURNS = ("angular_velocity", "angular_acceleration")


def content() -> dict[str, Any]:
    """The scene as it is written."""
    return tomllib.loads((SCENES / f"{os.environ['ORACLE_SCENE']}.toml").read_text(encoding="utf-8"))


def solved(scene: Mapping[str, Any]) -> tuple[Numbers, Array]:
    """Every number of a scene, and its instants."""
    # Here, for the faults' names are asked for by a program that need not find the library.
    from pointcoord import Scene, simulate

    motion = simulate(Scene.from_mapping(scene, "faulty"))
    return {quantity: dict(part) for quantity, part in motion.numbers.items()}, motion.times


def each(quantities: tuple[str, ...], change: Callable[[Array], Array]) -> Fault:
    """The same change of all numbers of some quantities."""
    return lambda numbers, _: (
        numbers
        | {
            quantity: {name: change(array) for name, array in numbers[quantity].items()}
            for quantity in quantities
        }
    )


def angle(name: str, change: Callable[[Array], Array]) -> Fault:
    """A change of one angle of the wheel."""
    return lambda numbers, _: numbers | {"wheel": {**numbers["wheel"], name: change(numbers["wheel"][name])}}


def by_differences(numbers: Numbers, times: Array) -> Numbers:
    """Velocities by central differences of positions."""
    places = numbers["position"].items()
    return numbers | {"velocity": {name: np.gradient(place, times, axis=0) for name, place in places}}


def swapped_rates(numbers: Numbers, _: Array) -> Numbers:
    """Velocities given as accelerations and the other way round."""
    return numbers | {"velocity": numbers["acceleration"], "acceleration": numbers["velocity"]}


def noise(numbers: Numbers, _: Array) -> Numbers:
    """Random numbers on top: nothing explains them."""
    rng = np.random.default_rng(11)
    shaken = {name: v + 1e-3 * rng.standard_normal(v.shape) for name, v in numbers["velocity"].items()}
    return numbers | {"velocity": shaken}


def mirrored(numbers: Numbers, times: Array) -> Numbers:
    """The wheel of the other side."""
    side = np.array([1.0, -1.0, 1.0])
    return each(TURNS, lambda v: -v * side)(each(STATES, lambda v: v * side)(numbers, times), times)


FAULTS: dict[str, Fault] = {
    "none": lambda numbers, _: numbers,
    "sign_of_z": each(STATES, lambda v: v * [1.0, 1.0, -1.0]),
    "forward_and_left": each((*STATES, *TURNS), lambda v: v * [-1.0, -1.0, 1.0]),
    "axes_exchanged": each((*STATES, *TURNS), lambda v: v[:, [1, 2, 0]]),
    "mirrored": mirrored,
    "metres": each(STATES, lambda v: v / 1000.0),
    "origin": each(("position",), lambda v: v + np.array([0.0, 0.0, 25.0])),
    "toe_out": angle("toe", lambda v: -v),
    "camber_in_degrees": angle("camber", np.degrees),
    "camber_in_degrees_and_out": angle("camber", lambda v: -np.degrees(v)),
    "camber_offset": angle("camber", lambda v: v + 0.013),
    "caster_factor": angle("caster", lambda v: 0.97 * v),
    "single_precision": each(STATES, lambda v: v.astype(np.float32).astype(float)),
    "three_decimals": each((*STATES, "wheel"), lambda v: np.round(v, 3)),
    "differences": by_differences,
    "swapped_rates": swapped_rates,
    "noise": noise,
}
"""What is done to the right numbers, by name."""


def hardpoint(scene: dict[str, Any]) -> None:
    """A hardpoint drawn 2 mm too high."""
    scene["mechanism"]["points"]["tie_rod_outer"][2] += 2.0


def later(scene: dict[str, Any]) -> None:
    """Everything happens earlier than it should."""
    for end in ("start", "stop"):
        scene["time"][end] += 0.0137


def rack_sign(scene: dict[str, Any]) -> None:
    """The rack moves the other way."""
    scene["inputs"]["rack"]["sine"]["amplitude"] *= -1.0


def arm_zero(scene: dict[str, Any]) -> None:
    """The arm's angle is counted from another zero."""
    scene["inputs"]["arm_angle"]["sine"]["offset"] += 0.02


def other_closure(scene: dict[str, Any]) -> None:
    """A strut closed as the paper closes it."""
    scene["mechanism"]["closure"] = "collinear"


SCENE_FAULTS: dict[str, Callable[[dict[str, Any]], None]] = {
    one.__name__: one for one in (hardpoint, later, rack_sign, arm_zero, other_closure)
}
"""What is done to the scene before it is solved, by name."""


def __getattr__(name: str) -> Callable[[Mapping[str, Any]], Mapping[str, Any]]:
    """The solver with a fault of either kind."""
    fault = name.removeprefix("with_")
    if fault not in FAULTS | SCENE_FAULTS:
        raise AttributeError(name)

    def solve(_: Mapping[str, Any]) -> Mapping[str, Any]:
        scene = content()
        if fault in SCENE_FAULTS:
            SCENE_FAULTS[fault](scene)
        numbers, times = solved(scene)
        return FAULTS.get(fault, FAULTS["none"])(numbers, times)

    return solve
