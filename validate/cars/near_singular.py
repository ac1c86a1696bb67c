"""Random cars driven close to a pose where the mechanism locks, each reproducible by its number.

With its rods and bodies given, an input can go only so far (see `input_ends`). Here it is driven to such an
end of a random car and steps back by a drawn share of its whole range.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pointcoord import PointcoordError
from validate.cars.base_cars import Variant
from validate.cars.car import Car
from validate.cars.input_ends import Inputs, drawn_inputs, end, room
from validate.cars.random_cars import random_car

NEAREST = 1e-12  # of an input's range: its own rounding is 1e-4 of that
# How far other inputs are held from the drawing, and the chassis is moved: rad, and parts of the car's size.
ASIDE, LIFTED = (0.3, 0.06), (0.1, 0.1)


@dataclass(frozen=True)
class NearPose:
    """A car and inputs close to the end of one of them.

    Attributes:
        number: with the seed it gives the same pose again.
        home: the inputs at which the car is drawn; the way from there to `inputs` is open.
        inputs: of all that is driven, the chassis too, rad and mm.
        driven: the input that is near its last reachable value.
        reach: range of that input, rad or mm.
        distance: from the last reachable value, in parts of the range.
    """

    number: int
    variant: Variant
    car: Car
    home: Inputs
    inputs: Inputs
    driven: str
    reach: float
    distance: float


def near_pose(number: int, seed: int = 0, nearest: float = NEAREST, farthest: float = 0.1) -> NearPose:
    """The pose of a number: a car drawn until its inputs have an end that an open way leads to.

    Args:
        nearest, farthest: limits of the distance, drawn log-uniformly, in parts of the input's range.
    """
    rng = np.random.default_rng([seed, number])
    while True:
        drawn = random_car(rng)
        found = approach(
            drawn.car,
            drawn.variant,
            drawn.inputs,
            driven=drawn.inputs[int(rng.integers(len(drawn.inputs)))],
            forward=bool(rng.integers(2)),
            aside=rng.uniform(-1.0, 1.0),
            distance=float(np.exp(rng.uniform(math.log(nearest), math.log(farthest)))),
            lifted=rng.uniform(-1.0, 1.0) if rng.random() < 0.3 else 0.0,
            number=number,
        )
        if found is not None:
            return found


def approach(
    car: Car,
    variant: Variant,
    inputs: Sequence[str],
    *,
    driven: str,
    forward: bool,
    aside: float,
    distance: float,
    lifted: float = 0.0,
    number: int = -1,
) -> NearPose | None:
    """Drive one input of a car to its end and step back; None if it has no end that is open to reach.

    Args:
        inputs: all that are driven but the chassis' own motions.
        driven: one of them.
        forward: to the upper end of the input, else to the lower one.
        aside: where the other inputs are held, -1 to 1.
        distance: from the end, in parts of the range between both ends.
        lifted: how far the chassis is moved, -1 to 1.
        number: for the record.
    """
    chassis = {name: lifted * room(car, name, LIFTED) for name in variant.chassis_motions}
    try:
        home = drawn_inputs(car, inputs)
        held = {n: value + (aside * room(car, n, ASIDE) if n != driven else 0.0) for n, value in home.items()}
        last = end(car, held, driven, forward)
    except PointcoordError:
        return None
    if last is None:
        return None
    near = last.value + (-1.0 if forward else 1.0) * distance * last.reach
    return NearPose(
        number,
        variant,
        car,
        home | dict.fromkeys(chassis, 0.0),
        held | {driven: near} | chassis,
        driven,
        last.reach,
        distance,
    )
