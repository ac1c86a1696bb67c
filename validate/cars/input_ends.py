"""The drawn values of a car's inputs, and the ends of their ranges.

pointcoord closes the drawing, reads its inputs, and follows an input to the last pose. Such an end is a fold:
near it all rates grow as the inverse root of the distance,

    |v| = k (end - value)^(-1/2)    =>    end - b = (b - a) / ((|v_b| / |v_a|)^2 - 1)

for two values a and b before the end. This gives the end to the rounding of the input, whereas a path has to
stop some 1e-12 of its length before it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from pointcoord import Scene, drawing_stands, simulate
from validate.cars.car import Car, Law, content_of

Inputs = dict[str, float]

# Distances from the end at which rates are taken, as shares of the range. The relative error of the formula
# is of the order of the root of the distance. So the error of the end is 1e-12 times a factor of the car
# after the first step, far below the next distance, then 3e-14 times this factor, and finally 1e-16.
NEAR = (1e-8, 1e-9, 2e-11)


class End(NamedTuple):
    """An end of an input, with the other inputs fixed.

    Attributes:
        value: the end, rad or mm; poses exist up to this value.
        reach: distance from this end to the opposite end, rad or mm.
    """

    value: float
    reach: float


def at(car: Car, laws: Mapping[str, Law], effects: tuple[str, ...] = ()) -> Scene:
    """A scene of one instant."""
    return Scene.from_mapping(content_of(car, laws, effects=effects))


def drawn_inputs(car: Car, inputs: Collection[str] = ("arm_angle", "rack")) -> Inputs:
    """The values of the inputs in the closed drawing, rad and mm.

    Raises:
        PointcoordError: the car is wrong, its drawing does not close, or the inputs do not drive all degrees
            of freedom.
    """
    return drawing_stands.drawn_inputs(at(car, dict.fromkeys(inputs, 1.0)))


def condition(car: Car, inputs: Mapping[str, float]) -> float:
    """The condition number of a pose.

    Raises:
        PointcoordError: there is no such pose.
    """
    return float(simulate(at(car, inputs)).proof().condition.max())


def redrawn(car: Car, inputs: Mapping[str, float]) -> Car:
    """The car redrawn at the pose of some inputs, rad and mm, each coordinate rounded.

    Raises:
        PointcoordError: there is no such pose.
    """
    position = simulate(at(car, inputs)).position
    return car.drawn_as({name: position[name][0] for name in car.points})


def end(car: Car, held: Mapping[str, float], driven: str, ahead: bool) -> End | None:
    """The end of an input, reached from a pose with the other inputs fixed; None if it is not a fold.

    Args:
        held: values of all inputs at the pose.
        ahead: whether to find the upper end.
    Raises:
        PointcoordError: there is no such pose, or no straight path from the drawing to the end.
    """

    def speed(value: float) -> float:
        velocity = simulate(at(car, {**held, driven: [value, 1.0]}, ("velocity",))).velocity
        return float(np.linalg.norm([velocity[name][0] for name in velocity]))

    ends = drawing_stands.reach_of(at(redrawn(car, held), held), driven)
    other, this = ends if ahead else ends[::-1]
    if not this.limits:
        return None
    reach, value = abs(this.value - other.value), this.value
    for near in NEAR:
        nearer = value - near * (reach if ahead else -reach)
        farther = value - 4.0 * near * (reach if ahead else -reach)
        slow, fast = speed(farther), speed(nearer)
        grown = (fast / slow) ** 2
        # At a quarter of the distance from a fold the squared rate is 4 times as large, up to the end's
        # error.
        if not 2.0 < grown < 8.0:
            return None
        value = nearer + (nearer - farther) / (grown - 1.0)
    return End(value, reach)
