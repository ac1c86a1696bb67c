"""Cars of hard cases by name: those that a family of cases, or a single one, is made from."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cars.car import Car, any_rotation, moved, other_side, turned
from validate.cars.paper_car import PAPER
from validate.cars.scene_content import Law, content_of
from validate.formulations.reference_solution import reference_instant

Array = NDArray[np.float64]
FAR = np.array([3e6, -2e6, 2e6])  # mm
ASKED = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster")
SQUARE = 1.5707963267948966  # rad: the arm angle at which rise and angle are most nearly proportional

# The paper's car with the axis of its strut 37 mm inboard of the ball joint, in whole millimetres and exactly
# in line, and the spin axis of its wheel drawn by itself.
BESIDE = PAPER | {
    "strut_lower": (452.0, -270.0, 60.0),
    "strut_rod_end": (456.0, -225.0, 265.0),
    "wheel_axis_inner": (452.0, -330.0, 22.0),
}


def as_given(scene: Scene) -> Car:
    """The car of a scene, without points that are put where others are drawn."""
    car, others = Car.of(scene), scene.mechanism.structure.stand_ins
    return replace(
        car, points={n: p for n, p in car.points.items() if p != car.points.get(others.get(n, ""))}
    )


PAPER_CAR = Car(PAPER, closure="collinear")
# On one vertical line, so that a quarter turn about x or y, which permutes axes, lays the strut exactly flat.
UPRIGHT_CAR = replace(
    PAPER_CAR,
    points=PAPER
    | {
        "strut_top": (450.0, -330.0, 470.0),
        "strut_rod_end": (450.0, -330.0, 246.0),
        "strut_lower": (450.0, -330.0, 20.0),
    },
)
BESIDE_CAR = Car(BESIDE)
# The same with the axis 400 mm beside the ball joint at the drawing: the slide runs out as the arm rises.
WIDE_CAR = Car(BESIDE | {"strut_lower": (456.0, -20.0, 220.0), "strut_rod_end": (459.0, -140.0, 407.5)})
# The strut beside its ball joint on the other side of the car, leaning every way.
OTHER_CAR = turned(other_side(BESIDE_CAR), any_rotation(1))
WISHBONE_CAR = as_given(Scene.load("double-wishbone"))
# The same with a lower arm so short that the upper one can follow it to its dead points.
SHORT_ARM_CAR = replace(
    WISHBONE_CAR,
    points=dict(WISHBONE_CAR.points)
    | {"lower_arm_front": (-110.0, 580.0, 69.0), "lower_arm_rear": (90.0, 580.0, 78.0)},
)


def _far(car: Car) -> Car:
    """The car on the other side, turned about three axes and 4e6 mm from the origin."""
    return moved(turned(other_side(car), any_rotation(9)), FAR)


CARS: Mapping[str, Car] = {
    "paper": PAPER_CAR,
    "beside": BESIDE_CAR,
    "wide": WIDE_CAR,
    "other": OTHER_CAR,
    "turned": _far(BESIDE_CAR),
    "wishbone": WISHBONE_CAR,
    "short-arm": SHORT_ARM_CAR,
    "wishbone-turned": _far(WISHBONE_CAR),
}
"""Cars by the name that a case calls them by."""


def scene_content(
    car: Car, arm_angle: Law = SQUARE, rack: Law = 0.0, heave: Law | None = None, **settings: Any
) -> dict[str, Any]:
    """The content of a scene of a car that arm angle and rack drive, rad and mm over s.

    Args:
        settings: as for `content_of`.
    """
    laws = {"arm_angle": arm_angle, "rack": rack} | ({} if heave is None else {"heave": heave})
    # Whatever is wrong with the car: that is for those who read the scene.
    return content_of(car, laws, **{"effects": ASKED, **settings})


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
