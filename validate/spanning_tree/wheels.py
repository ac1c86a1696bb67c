"""Wheels of a mechanism for witnesses: numbers that are computed from positions of points.

The definitions are the reference's own, applied to arrays, so a witness that uses them is independent of the
reference in the positions of the points, but not in the definitions of these numbers.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.reference.car_data import PAIR, corners
from validate.reference.chassis import ChassisMotion
from validate.reference.effects.at_pose import car_at
from validate.reference.effects.car import DrawnCar
from validate.reference.effects.registry import ANGLES, EFFECTS
from validate.reference.vectors import Vector
from validate.spanning_tree.cut import SpanningTree

Array = NDArray[np.float64]

OF_CAR = "car"
"""The names of these numbers in the results of witnesses, by quantity."""


@dataclass(frozen=True)
class Wheels:
    """The wheels of a flat mechanism, in its tree's lengths.

    Attributes:
        unit: mm.
        cars: the drawn car of each part, by the prefix of the names of its roles and numbers.
        pair: the prefixes of the left and the right part, if there are these two.
    """

    unit: float
    cars: Mapping[str, DrawnCar]
    pair: tuple[str, ...]

    @classmethod
    def of(cls, plain: Mapping[str, Any], tree: SpanningTree) -> Wheels:
        """The wheels that are named by roles."""
        points, sides = {name: components(place) for name, place in tree.drawn.items()}, corners(plain)
        origin = components(tree.origin)
        cars = {part: DrawnCar.of(plain, part, points, origin, tree.unit, float) for part in sides}
        cars = {part: car for part, car in cars.items() if car.ends}
        both = tuple(sorted(sides, key=lambda part: sides[part]))
        is_pair = len(cars) == 2 and [sides[part] for part in both] == [-1, 1]
        return cls(tree.unit, cars, both if is_pair else ())

    def numbers(
        self, places: Mapping[str, Array], chassis: ChassisMotion, names: Iterable[str] = ANGLES
    ) -> dict[str, Array]:
        """Numbers of the wheels, (N,), rad or mm; those that need more than positions are left out.

        Args:
            places: positions of the points relative to the chassis, (N, 3), in the tree's unit of length.
            chassis: position and rotation of the chassis.
            names: the reference's names of the numbers.
        """
        cars = {
            part: car_at(drawn, chassis, {name: components(places[name]) for name in drawn.points})
            for part, drawn in self.cars.items()
        }
        found = {}
        for name in dict.fromkeys(name.rpartition(".")[2] for name in names):
            effect = EFFECTS.get(name)
            if effect is None or effect.along is not None:
                continue
            one_each = [(part,) for part in cars]
            for parts in one_each if PAIR not in effect.needs else [self.pair] if self.pair else []:
                has = [{PAIR, *self.cars[part].ends, *self.cars[part].data} for part in parts]
                if all(map(effect.of, has)):
                    label = name if PAIR in effect.needs else parts[0] + name
                    value = effect.evaluate(*(cars[part] for part in parts))
                    found[label] = value * self.unit**effect.power
        return found


def knuckles(plain: Mapping[str, Any]) -> dict[str, str]:
    """Bodies that carry a wheel, each by its own name."""
    return {body: body for role, body in plain["roles"].items() if role.rpartition(".")[2] == "knuckle"}


def components(array: Array) -> Vector:
    """Of a vector, (3,) or (N, 3)."""
    return array[..., 0], array[..., 1], array[..., 2]
