"""Cars of hard cases by name: those that a family of cases, or a single one, is made from."""

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
SQUARE = 1.5707963267948966  # rad: the arm angle at which rise and angle are most nearly proportional


def as_given(scene: Scene) -> Car:
    """The car of a scene, without points that are put where others are drawn."""
    car, others = Car.of(scene), scene.mechanism.structure.stand_ins
    given = {n: p for n, p in car.points.items() if p != car.points.get(others.get(n, ""))}
    return replace(car, points=given)


def _cars() -> dict[str, Car]:
    """The paper's strut, a double wishbone, and what `cars.toml` makes of them."""
    cars = {
        "paper": Car(PAPER, closure="collinear"),
        "wishbone": as_given(Scene.load("double-wishbone")),
    }
    rows = tomllib.loads(files("validate.hard").joinpath("cars.toml").read_text(encoding="utf-8"))
    for name, row in rows.items():
        points = {**cars[row["of"]].points, **{point: tuple(place) for point, place in row["points"].items()}}
        cars[name] = replace(cars[row["of"]], points=points, closure=row.get("closure", "drawn"))
    # The strut beside its ball joint on the other side of the car, leaning every way; and far away.
    other = cars["beside"].mirrored()
    cars["other"] = other.turned(any_rotation(1))
    cars["turned"] = other.turned(any_rotation(9)).moved(np.array([3e6, -2e6, 2e6]))
    return cars


CARS: Mapping[str, Car] = _cars()
"""Cars by the name that a case calls them by."""
PAPER_CAR, BESIDE_CAR = CARS["paper"], CARS["beside"]


def scene_content(car: Car, arm_angle: Law = SQUARE, rack: Law = 0.0, **settings: Any) -> dict[str, Any]:
    """The content of a scene of a car that arm angle and rack drive, rad and mm over s.

    Whatever is wrong with the car: that is for those who read the scene.

    Args:
        settings: as for `content_of`.
    """
    return content_of(car, {"arm_angle": arm_angle, "rack": rack}, **{"effects": ASKED, **settings})


def drawn_angle(car: Car) -> float:
    """Arm angle of a car's drawing, rad."""
    p = car.array
    arm = p["lower_ball_joint"] - p["lower_arm_front"]
    return math.acos(float(arm @ np.array(car.up)) / float(np.linalg.norm(arm)))


def drawn_at(car: Car, inputs: Mapping[str, float]) -> Car:
    """The car drawn anew at the pose of these inputs, rad and mm: nothing is left to assemble."""
    scene = Scene.from_mapping(content_of(car, inputs))
    pose = reference_instant(scene, {name: (value, 0.0, 0.0) for name, value in inputs.items()})
    return replace(car, points={name: pose.position_as_float(name) for name in car.points})
