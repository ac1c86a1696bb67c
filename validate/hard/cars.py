"""Cars of hard cases: the paper's collinear one in several places, and struts beside the ball joint."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.cars.input_limits import Car
from validate.cars.paper_car import PAPER, Points, mirrored
from validate.cars.random_struts import as_tuple
from validate.hard.content import Law, paper_car
from validate.reference import solve_reference

Array = NDArray[np.float64]

UP, RIGHT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)
PAPER_CAR = Car(PAPER, "left", UP, RIGHT, "collinear")
# On one vertical line, so that a quarter turn about x or y, which permutes axes, lays the strut exactly flat.
UPRIGHT_CAR = Car(
    PAPER
    | {
        "strut_top": (450.0, -330.0, 470.0),
        "strut_rod_end": (450.0, -330.0, 246.0),
        "strut_lower": (450.0, -330.0, 20.0),
    },
    "left",
    UP,
    RIGHT,
    "collinear",
)
# The paper's car with the axis of its strut 37 mm inboard of the ball joint, in whole millimetres and exactly
# in line, and the spin axis of its wheel drawn by itself.
BESIDE: Points = PAPER | {
    "strut_lower": (452.0, -270.0, 60.0),
    "strut_rod_end": (456.0, -225.0, 265.0),
    "wheel_axis_inner": (452.0, -330.0, 22.0),
}
BESIDE_CAR = Car(BESIDE, "left", UP, RIGHT)
# The same with the axis 400 mm beside the ball joint at the drawing: the slide runs out as the arm rises.
WIDE_CAR = Car(
    BESIDE | {"strut_lower": (456.0, -20.0, 220.0), "strut_rod_end": (459.0, -140.0, 407.5)},
    "left",
    UP,
    RIGHT,
)


def turned(car: Car, turn: Array) -> Car:
    """The whole car turned by an orthogonal matrix of determinant 1, its axes with it."""
    points = {name: as_tuple(turn @ np.array(place)) for name, place in car.points.items()}
    return Car(
        points, car.side, as_tuple(turn @ np.array(car.up)), as_tuple(turn @ np.array(car.right)), car.closure
    )


def rotation(axis: int, cosine: float, sine: float) -> Array:
    """The turn about a coordinate axis (0 to 2) by the angle of this cosine and sine."""
    turn = np.eye(3)
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turn[[first, second], [first, second]] = cosine
    turn[first, second], turn[second, first] = -sine, sine
    return turn


def any_rotation(seed: int) -> Array:
    """A turn drawn at random, the same for the same seed."""
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return np.asarray(turn * np.sign(np.linalg.det(turn)))


def car_content(
    car: Car, arm_angle: Law, rack: Law = 0.0, heave: Law | None = None, **settings: Any
) -> dict[str, Any]:
    """The content of a scene of a car; settings as for `content.paper_car`."""
    return paper_car(
        arm_angle,
        rack,
        heave,
        points=car.points,
        closure=car.closure,
        side=car.side,
        up=car.up,
        right=car.right,
        **settings,
    )


def drawn_at(car: Car, arm_angle: float, rack: float) -> Car:
    """The car drawn anew at the pose of these inputs, rad and mm: nothing is left to assemble."""
    pose = solve_reference(
        car.points,
        {"arm_angle": (arm_angle, 0, 0), "rack": (rack, 0, 0)},
        up=car.up,
        right=car.right,
        closure=car.closure,
    )
    points = {name: pose.position_as_float(name) for name in car.points}
    return Car(points, car.side, car.up, car.right, car.closure)


# The strut beside its ball joint on the other side of the car, leaning every way.
OTHER_CAR = turned(Car(mirrored(BESIDE), "right", UP, RIGHT), any_rotation(1))
