"""The cars of hard cases, by name."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cars.car import Car, Law, any_rotation, content_of
from validate.cars.paper_car import PAPER
from validate.formulations.reference_solution import reference_instant

Array = NDArray[np.float64]
ASKED = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")
SQUARE = 1.5707963267948966  # rad: the arm is horizontal, and its rise nearly proportional to the angle


def as_given(scene: Scene) -> Car:
    """The car of a scene, without points that only take the position of another (see `stand_ins`)."""
    car, others = Car.of(scene), scene.mechanism.structure.stand_ins
    given = {n: p for n, p in car.points.items() if p != car.points.get(others.get(n, ""))}
    return replace(car, points=given)


def _cars() -> dict[str, Car]:
    """The paper's strut, a double wishbone, and their variants in `cars.toml`."""
    cars = {
        "paper": Car(PAPER, closure="collinear"),
        "wishbone": as_given(Scene.load("double-wishbone")),
    }
    rows = tomllib.loads(files("validate.hard").joinpath("cars.toml").read_text(encoding="utf-8"))
    for name, row in rows.items():
        points = {**cars[row["of"]].points, **{point: tuple(place) for point, place in row["points"].items()}}
        cars[name] = replace(cars[row["of"]], points=points, closure=row.get("closure", "drawn"))
    # The strut with its axis beside the ball joint, mirrored and turned about an oblique axis; and far away.
    other = cars["beside"].mirrored()
    cars["other"] = other.turned(any_rotation(1))
    cars["turned"] = other.turned(any_rotation(9)).moved(np.array([3e6, -2e6, 2e6]))
    return cars


CARS: Mapping[str, Car] = _cars()
"""Cars by name."""
PAPER_CAR, BESIDE_CAR = CARS["paper"], CARS["beside"]


def scene_content(car: Car, arm_angle: Law = SQUARE, rack: Law = 0.0, **settings: Any) -> dict[str, Any]:
    """The content of a scene of a car driven by arm angle and rack, rad and mm over s.

    The car is not checked here: it may be wrong on purpose, and is checked when the scene is read.

    Args:
        settings: as for `content_of`.
    """
    return content_of(car, {"arm_angle": arm_angle, "rack": rack}, **{"effects": ASKED, **settings})


def drawn_angle(car: Car) -> float:
    """The arm angle of a car as drawn, rad."""
    p = car.array
    arm = p["lower_ball_joint"] - p["lower_arm_front"]
    return math.acos(float(arm @ np.array(car.up)) / float(np.linalg.norm(arm)))


def drawn_at(car: Car, inputs: Mapping[str, float]) -> Car:
    """The car redrawn at the pose of some inputs, rad and mm, so that the new drawing is closed."""
    scene = Scene.from_mapping(content_of(car, inputs))
    pose = reference_instant(scene, {name: (value, 0.0, 0.0) for name, value in inputs.items()})
    return replace(car, points={name: pose.position_as_float(name) for name in car.points})
