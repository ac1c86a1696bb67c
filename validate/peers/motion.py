"""Results of a program: poses of a tree at given inputs, their rates, and the numbers reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from validate.arrays import Array
from validate.reference.car_data import corners
from validate.reference.chassis import ChassisMotion
from validate.reference.effects.at_pose import numbers_with
from validate.reference.effects.car import Car
from validate.reference.effects.registry import ANGLES, EFFECTS
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Vector
from validate.spanning_tree.tree import SpanningTree

Rates = dict[str, dict[str, Array]]
"""Velocity and acceleration of every moving point, in the tree's unit, and angular velocity and acceleration
of the knuckles, by quantity and name, (N, 3).
"""
OF_CAR = "car"
"""The quantity under which the numbers of the wheels are found."""


@dataclass(frozen=True)
class Poses:
    """Poses of a tree, in its unit and from its origin.

    Attributes:
        inputs: of the drives, (N, drives), rad and the unit.
        coordinates: of the program's joints, (N, ...).
        places: of every moving point, (N, 3).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
    """

    inputs: Array
    coordinates: Array
    places: Mapping[str, Array]
    last_step: Array

    def first(self, count: int) -> Poses:
        """The first poses."""
        return replace(
            self,
            inputs=self.inputs[:count],
            coordinates=self.coordinates[:count],
            places={name: place[:count] for name, place in self.places.items()},
            last_step=self.last_step[:count],
        )


def numbers(
    tree: SpanningTree,
    laws: Mapping[str, Array],
    poses: Poses,
    rates: Rates | None = None,
    effects: Iterable[str] = ANGLES,
) -> dict[str, dict[str, Array]]:
    """All quantities of a motion, by quantity and name, in the car's axes, mm, s and rad.

    The reference's code computes the motion of the chassis and the numbers of the wheels. So a program
    confirms only the positions and rates of the points relative to the chassis.

    Args:
        laws: every input with two time derivatives, (N or more, 3), rad or mm per s^d.
        effects: names of the numbers of the wheels; those that need more than positions are left out.
    """
    count, unit = len(poses.inputs), tree.unit
    still = np.zeros((count, 3))
    near = {name: poses.places.get(name, still + place.at) for name, place in tree.points.items()}
    driven = {name: Jet(*laws[name][:count].T if name in laws else still.T) for name in tree.plain["inputs"]}
    drawn = {name: _components(place) for name, place in tree.drawn.items()}
    chassis = ChassisMotion.of(tree.plain, drawn, Fraction(unit), driven, float)
    quantities = ("position",) if rates is None else ("position", "velocity", "acceleration")
    found: dict[str, dict[str, Array]] = {quantity: {} for quantity in quantities}
    for name, place in near.items():
        states = [place, *((rates or {})[quantity].get(name, still) for quantity in quantities[1:])]
        moved = _states(chassis.moved(_jets(states)), len(quantities), still)
        for quantity, state in zip(quantities, moved, strict=True):
            found[quantity][name] = state * unit + (tree.origin if quantity == "position" else 0.0)
    if rates is not None:
        turning = tuple(f"angular_{quantity}" for quantity in quantities[1:])
        found |= {quantity: {} for quantity in turning}
        along, across = (chassis.turned(_jets([axis + still])) for axis in np.eye(3)[:2])
        own = [np.stack([x + still[:, 0] for x in turn], axis=-1) for turn in body_rates(along, across)]
        for name in rates[turning[0]]:
            moved = _states(chassis.turned(_jets([rates[quantity][name] for quantity in turning])), 2, still)
            for quantity, state, more in zip(turning, moved, own, strict=True):
                found[quantity][name] = state + more
    found[OF_CAR] = _of_wheels(tree, drawn, near, chassis.still(), effects)
    return found


def _of_wheels(
    tree: SpanningTree,
    drawn: Mapping[str, Vector],
    near: Mapping[str, Array],
    chassis: ChassisMotion,
    names: Iterable[str],
) -> dict[str, Array]:
    """Numbers of the wheels that need positions only, (N,), rad or mm.

    Args:
        drawn, near: the points as drawn, and at the poses relative to the chassis, in the tree's unit.
    """
    sides, cars = corners(tree.plain), dict[str, Car]()
    for part in sides:
        car = Car.of(tree.plain, part, drawn, _components(tree.origin), tree.unit, float)
        cars[part] = car.at(chassis, {name: _components(near[name]) for name in car.points})
    of_positions = [n for n in (name.rpartition(".")[2] for name in names) if _needs_positions(n)]
    had = {part: {*car.ends, *car.data} for part, car in cars.items()}
    found = {}
    for number in numbers_with(sides, had, of_positions):
        value = number.effect.evaluate(*(cars[part] for part in number.corners))
        found[number.name] = value * tree.unit**number.effect.power
    return found


def _needs_positions(name: str) -> bool:
    """Whether a name is that of a number that needs positions only."""
    return name in EFFECTS and EFFECTS[name].along is None


def _components(array: Array) -> Vector:
    """The components of a vector, (3,) or (N, 3)."""
    return array[..., 0], array[..., 1], array[..., 2]


def _jets(states: Sequence[Array]) -> Vector:
    """A vector's value and rates, (N, 3) each, as jets."""
    x, y, z = (Jet(*(state[:, axis] for state in states)) for axis in range(3))
    return x, y, z


def _states(vector: Vector, count: int, still: Array) -> list[Array]:
    """The value and rates, (N, 3) each, of a vector of jets; a missing rate is zero."""
    return [np.stack([jet.part(order) + still[:, 0] for jet in vector], axis=-1) for order in range(count)]
