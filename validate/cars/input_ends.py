r"""Where the inputs of a car stand in its drawing, and how far each goes from there.

pointcoord closes the drawing, reads its inputs, and follows each of them to the pose beyond which there is
none. Such an end is a fold: near it all rates grow as the inverse root of the distance,

    |v| = k (end - value)^(-1/2)    =>    end - b = (b - a) / ((|v_b| / |v_a|)^2 - 1)

for two values a and b before it. That gives an end to the rounding of the input itself, where a path has to
stop some 1e-12 of its length before.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from pointcoord import Scene, drawing_stands, simulate
from validate.cars.car import Car, Law, content_of

Inputs = dict[str, float]

# Of the range: where rates are taken before an end. What the formula leaves out is of the order of the root
# of this, in parts of it: 1e-12 times a factor of the car first, which must stay far below the next one, then
# 3e-14 times it, and at last 1e-16.
NEAR = (1e-8, 1e-9, 2e-11)


class End(NamedTuple):
    """An end of an input, the others held.

    Attributes:
        value: rad or mm; poses exist up to here.
        reach: distance from this end to the opposite one, rad or mm.
    """

    value: float
    reach: float


def at(car: Car, laws: Mapping[str, Law], effects: tuple[str, ...] = ()) -> Scene:
    """The scene of one instant."""
    return Scene.from_mapping(content_of(car, laws, effects=effects))


def drawn_inputs(car: Car, inputs: Collection[str] = ("arm_angle", "rack")) -> Inputs:
    """The inputs' values in the drawing once it is closed, rad and mm.

    Raises:
        PointcoordError: it is no car, its drawing does not close, or it has other freedoms.
    """
    return drawing_stands.drawn_inputs(at(car, dict.fromkeys(inputs, 1.0)))


def condition(car: Car, inputs: Mapping[str, float]) -> float:
    """The condition number of a pose.

    Raises:
        PointcoordError: there is none.
    """
    return float(simulate(at(car, inputs)).proof().condition.max())


def redrawn(car: Car, inputs: Mapping[str, float]) -> Car:
    """The car drawn anew at the pose of these inputs, rad and mm, each coordinate rounded.

    Raises:
        PointcoordError: there is none.
    """
    position = simulate(at(car, inputs)).position
    return car.drawn_as({name: position[name][0] for name in car.points})


def end(car: Car, held: Mapping[str, float], driven: str, ahead: bool) -> End | None:
    """The last value of an input that can be reached from a pose, the others held; None if there is no fold.

    Args:
        held: values of all inputs at that pose.
        ahead: whether the upper end is wanted.
    Raises:
        PointcoordError: there is no such pose, or no straight way from the drawing to the end.
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
        # Four times as near a fold it is 4, but for what the end before is off.
        if not 2.0 < grown < 8.0:
            return None
        value = nearer + (nearer - farther) / (grown - 1.0)
    return End(value, reach)
