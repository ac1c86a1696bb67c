"""Cars of hard cases: one of every suspension in several places, and what struts alone can be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.cars.car import Car, Closure, any_rotation, moved, other_side, turned
from validate.cars.double_wishbone import DOUBLE_WISHBONE
from validate.cars.macpherson import BESIDE
from validate.cars.paper_car import PAPER
from validate.cars.scene_content import SQUARE, Law, scene_content
from validate.reference import solve_reference

Array = NDArray[np.float64]

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


def paper_car(
    arm_angle: Law = SQUARE,
    rack: Law = 0.0,
    heave: Law | None = None,
    *,
    points: Mapping[str, Sequence[float]] = PAPER,
    closure: Closure = "collinear",
    **settings: Any,
) -> dict[str, Any]:
    """The content of a scene of the paper's strut; settings as for `scene_content`."""
    car = Car({}, closure=closure).drawn_as({name: np.array(place) for name, place in points.items()})
    return scene_content(car, arm_angle, rack, heave, **settings)


def drawn_at(car: Car, arm_angle: float, rack: float) -> Car:
    """The car drawn anew at the pose of these inputs, rad and mm: nothing is left to assemble."""
    pose = solve_reference(
        car.points,
        {"arm_angle": (arm_angle, 0, 0), "rack": (rack, 0, 0)},
        up=car.up,
        right=car.right,
        side=car.side,
        closure=car.closure,
        suspension=car.suspension,
    )
    return replace(car, points={name: pose.position_as_float(name) for name in car.points})


# The strut beside its ball joint on the other side of the car, leaning every way.
OTHER_CAR = turned(other_side(BESIDE_CAR), any_rotation(1))
WISHBONE_CAR = DOUBLE_WISHBONE.base["drawn"]
# The same with a lower arm so short that the upper one can follow it to its dead points.
SHORT_ARM_CAR = replace(
    WISHBONE_CAR,
    points=dict(WISHBONE_CAR.points)
    | {"lower_arm_front": (-110.0, 580.0, 69.0), "lower_arm_rear": (90.0, 580.0, 78.0)},
)
FAR = np.array([3e6, -2e6, 2e6])  # mm


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

# Families that make sense for every suspension take each of these, and add this to the names of their cases.
EVERY: Mapping[str, str] = {"": "paper", "-wishbone": "wishbone"}
