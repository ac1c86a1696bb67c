"""Wheels of a mechanism for witnesses: numbers that are made of where points are.

They are the reference's own definitions, over arrays: a witness that takes them shares these with the
reference. It is a witness of where the points are, not of what is made of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.reference.car_data import LENGTHS, car_data
from validate.reference.effects.car import RADIUS, Car, DrawnCar, Line
from validate.reference.effects.effect import PAIR
from validate.reference.effects.registry import ANGLES, EFFECTS
from validate.reference.vectors import Vector
from validate.spanning_tree.chassis import ChassisMotion
from validate.spanning_tree.cut import SpanningTree, car_directions

Array = NDArray[np.float64]
Ends = tuple[str, str]

OF_CAR = "car"
"""What witnesses call these numbers among all that they found, by quantity."""


@dataclass(frozen=True)
class Wheels:
    """The wheels of a flat mechanism, in its tree's lengths.

    Attributes:
        plain: the flat mechanism. tree: of it.
        cars: as drawn, of each part by its prefix, which the names of its roles and numbers have.
    """

    plain: Mapping[str, Any]
    tree: SpanningTree
    cars: Mapping[str, DrawnCar]

    @classmethod
    def of(cls, plain: Mapping[str, Any], tree: SpanningTree) -> Wheels:
        """The wheels that roles name."""
        parts: dict[str, dict[str, Any]] = {}
        for role, named in plain["roles"].items():
            part, dot, last = role.rpartition(".")
            parts.setdefault(part + dot, {})[last] = named
        directions, radius = car_directions(plain), plain["wheel_radius"]
        points = {name: _vector(place) for name, place in tree.drawn.items()}
        given = {key: float(one) for key, one in car_data(plain).items()}
        data = {key: one / tree.unit if key in LENGTHS else one for key, one in given.items()}
        cars = {
            prefix: DrawnCar.of(
                roles=roles,
                points=points,
                up=_vector(directions["up"]),
                right=_vector(directions["right"]),
                side=_side(plain, prefix),
                wheel_radius=None if radius is None else radius / tree.unit,
                origin=_vector(-tree.origin / tree.unit),
                data=data,
                number=float,
            )
            for prefix, roles in parts.items()
        }
        return cls(plain, tree, {prefix: car for prefix, car in cars.items() if car.ends})

    @property
    def ends(self) -> tuple[Ends, ...]:
        """The two points of every line."""
        return tuple(dict.fromkeys(pair for car in self.cars.values() for pair in car.ends.values()))

    def numbers(
        self,
        places: Mapping[str, Array],
        inputs: Mapping[str, Array],
        names: Iterable[str] = ANGLES,
    ) -> dict[str, Array]:
        """Numbers of the wheels, (N,), rad or mm; those that are not made of positions alone are left out.

        Args:
            places: of the points relative to the chassis, (N, 3), in the tree's lengths.
            inputs: value, rate and acceleration by name, (N, 3), rad or mm, and s; of those that turn the
                chassis, where they are given.
            names: of the numbers, as the reference has them.
        """
        points = {name: places[name] for ends in self.ends for name in ends}
        vectors = {ends: points[ends[1]] - points[ends[0]] for ends in self.ends}
        turned_points, turned_vectors = points, vectors
        turns = {name: given for name, given in self.plain["inputs"].items() if "turns" in given}
        still = {**self.plain, "points": self.tree.drawn, "inputs": turns}
        turning = ChassisMotion.of(still, inputs)
        if turning is not None:
            turned_points = turning.moved({"position": points})["position"]
            turned_vectors = {ends: turning.directions(vector) for ends, vector in vectors.items()}
        cars = {
            prefix: Car(one, _lines(one, turned_points, turned_vectors), _lines(one, points, vectors))
            for prefix, one in self.cars.items()
        }
        pair = self._pair()
        own = dict.fromkeys(name.rpartition(".")[2] for name in names)
        found = {}
        for name, effect in ((name, EFFECTS[name]) for name in own if name in EFFECTS):
            if effect.along is not None:
                continue
            both = PAIR in effect.needs
            for prefixes in [pair] if both and pair else [] if both else [(prefix,) for prefix in cars]:
                if not any(effect.lacks(self._has(prefix) | {PAIR}) for prefix in prefixes):
                    value = effect.evaluate(*(cars[prefix] for prefix in prefixes))
                    label = name if both else prefixes[0] + name
                    found[label] = value * self.tree.unit**effect.power
        return found

    def _has(self, prefix: str) -> set[str]:
        """What a part's car has of what effects need."""
        one = self.cars[prefix]
        return {*one.ends, *one.data, *([] if one.wheel_radius is None else [RADIUS])}

    def _pair(self) -> tuple[str, ...]:
        """The prefixes of the left and the right part, where there are these two."""
        sides = {side: f"{part}." for part, side in self.plain["sides"].items() if f"{part}." in self.cars}
        return (sides["left"], sides["right"]) if len(sides) == len(self.cars) == 2 else ()


def knuckles(plain: Mapping[str, Any]) -> dict[str, str]:
    """Bodies that carry a wheel, each by its own name."""
    return {body: body for role, body in plain["roles"].items() if role.rpartition(".")[2] == "knuckle"}


def _lines(car: DrawnCar, points: Mapping[str, Array], vectors: Mapping[Ends, Array]) -> dict[str, Line]:
    return {
        role: Line(_vector(points[ends[0]]), _vector(points[ends[1]]), _vector(vectors[ends]))
        for role, ends in car.ends.items()
    }


def _vector(array: Array) -> Vector:
    """Its components, (3,) or (N, 3)."""
    return array[..., 0], array[..., 1], array[..., 2]


def _side(plain: Mapping[str, Any], prefix: str) -> int:
    """1 where outboard of a part, or of the whole, is right: by its side, wherever its wheel is drawn."""
    return 1 if plain["sides"].get(prefix.removesuffix("."), plain["side"]) == "right" else -1
