"""Random cars driven close to a pose where the mechanism locks, each reproducible by its number.

With the links given, an input can go only so far (see `input_limits`). Here it is driven to such an end of a
random car and steps back by a drawn share of its whole range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from validate.cars.car import Car
from validate.cars.input_limits import DRIVEN, Inputs, Linkage
from validate.cars.random_cars import Kind, random_car

NEAREST = 1e-12  # of an input's range: its own rounding is 1e-4 of that
# Most cars lock in whatever way comes first; two in ten by the arm, two in ten by the knuckle's upper end.
MADE: tuple[Kind, ...] = ("regular", "regular", "regular", "dead arm", "upper lock")


@dataclass(frozen=True)
class NearPose:
    """A car and inputs close to the end of one of them.

    Attributes:
        number: with the seed it gives the same pose again.
        home: the inputs at which the car is drawn; the way from there to `inputs` is open.
        inputs: arm angle (rad), rack and heave (mm).
        driven: the input that is near its last reachable value.
        lock: what locks there: `arm`, `tie_rod` or the suspension's `upper_lock`.
        reach: range of that input, rad or mm.
        distance: from the last reachable value, in parts of the range.
    """

    number: int
    car: Car
    home: Inputs
    inputs: Inputs
    driven: str
    lock: str
    reach: float
    distance: float


def near_pose(number: int, seed: int = 0, nearest: float = NEAREST, farthest: float = 0.1) -> NearPose:
    """The pose of a number: a car drawn until its inputs have an end that an open way leads to.

    Args:
        nearest, farthest: limits of the distance, drawn log-uniformly, in parts of the input's range.
    """
    rng = np.random.default_rng([seed, number])
    while True:
        found = _attempt(number, rng, nearest, farthest)
        if found is not None:
            return found


def _attempt(number: int, rng: np.random.Generator, nearest: float, farthest: float) -> NearPose | None:
    return approach(
        car_with_ends(rng),
        driven=DRIVEN[int(rng.integers(2))],
        forward=bool(rng.integers(2)),
        aside=rng.uniform(-1.0, 1.0),
        distance=float(np.exp(rng.uniform(math.log(nearest), math.log(farthest)))),
        heave=rng.uniform(-1.0, 1.0) if rng.random() < 0.3 else 0.0,
        number=number,
    )


def car_with_ends(rng: np.random.Generator) -> Car:
    """A random car, now and then one whose arm or upper end can come to lock."""
    return random_car(rng, MADE[int(rng.integers(len(MADE)))])[0]


def approach(
    car: Car,
    *,
    driven: str,
    forward: bool,
    aside: float,
    distance: float,
    heave: float = 0.0,
    number: int = -1,
) -> NearPose | None:
    """Drive one input of a car to its end and step back; None if it has no end that is open to reach.

    Args:
        driven: `arm_angle` or `rack`.
        forward: to the upper end of the input, else to the lower one.
        aside: where the other input is held, -1 to 1.
        distance: from the end, in parts of the range between both ends.
        heave: -1 to 1.
        number: for the record.
    """
    linkage = Linkage.of(car)
    if not linkage.sound:
        return None
    size = linkage.size
    home = linkage.home | {"heave": 0.0}
    held = dict(home)
    if driven == "arm_angle":
        held["rack"] += 0.06 * size * aside
    else:
        held["arm_angle"] += 0.3 * aside
    last = linkage.end(held, driven, forward)
    other = linkage.end(held, driven, not forward) if last else None
    if last is None or other is None:
        return None
    value, lock = last
    inputs = held | {driven: value + (other[0] - value) * distance, "heave": 0.1 * size * heave}
    if not (0.0 < inputs["arm_angle"] < math.pi and linkage.way_is_open(home, inputs)):
        return None
    return NearPose(number, car, home, inputs, driven, lock, abs(other[0] - value), distance)
