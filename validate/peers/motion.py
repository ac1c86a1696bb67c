"""Results of a program: poses of a tree at given inputs, their rates, and the numbers reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
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

OF_CAR = "car"
"""The quantity under which the numbers of the wheels are found."""


@dataclass(frozen=True)
class Motion:
    """A motion of a tree, in its unit and from its origin.

    Attributes:
        inputs: of the drives, (N, drives), rad and the unit.
        coordinates: of the program's joints, (N, ...).
        linear: position of every moving point, and its velocity and acceleration if they are computed,
            (N, 1 or 3, points, 3).
        angular: angular velocity and acceleration of the knuckles, if computed, (N, 0 or 2, knuckles, 3).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
    """

    inputs: Array
    coordinates: Array
    linear: Array
    angular: Array
    last_step: Array


def numbers(
    tree: SpanningTree, laws: Mapping[str, Array], motion: Motion, effects: Iterable[str] = ANGLES
) -> dict[str, dict[str, Array]]:
    """All quantities of a motion, by quantity and name, in the car's axes, mm, s and rad.

    The reference's code computes the motion of the chassis and the numbers of the wheels. So a program
    confirms only the positions and rates of the points relative to the chassis.

    Args:
        laws: every input with two time derivatives, (N or more, 3), rad or mm per s^d.
        effects: names of the numbers of the wheels; those that need more than positions are left out.
    """
    (count, orders), unit = motion.linear.shape[:2], tree.unit
    still = np.zeros((count, 3))
    driven = {name: Jet(*laws[name][:count].T if name in laws else still.T) for name in tree.plain["inputs"]}
    drawn = {name: _components(place) for name, place in tree.drawn.items()}
    chassis = ChassisMotion.of(tree.plain, drawn, Fraction(unit), driven, float)
    quantities = ("position", "velocity", "acceleration")[:orders]
    turning = tuple(f"angular_{quantity}" for quantity in quantities[1:])
    found: dict[str, dict[str, Array]] = {quantity: {} for quantity in (*quantities, *turning)}
    states = {name: np.zeros((count, orders, 3)) for name in tree.points}
    for name, place in tree.points.items():
        states[name][:, 0] = place.at
    states |= zip(tree.moving, np.moveaxis(motion.linear, 2, 0), strict=True)
    for name, of_point in states.items():
        for quantity, state in zip(quantities, _states(chassis.moved(_jets(of_point)), still), strict=False):
            found[quantity][name] = state * unit + (tree.origin if quantity == "position" else 0.0)
    along, across = (chassis.turned(_jets(axis + still[:, None])) for axis in np.eye(3)[:2])
    own = body_rates(along, across)
    for name, of_body in zip(tree.knuckles, np.moveaxis(motion.angular, 2, 0), strict=True):
        moved = _states(chassis.turned(_jets(of_body)), still) if turning else ()
        for quantity, state, turn in zip(turning, moved, own, strict=False):
            found[quantity][name] = state + np.stack([x + still[:, 0] for x in turn], axis=-1)
    near = {name: of_point[:, 0] for name, of_point in states.items()}
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
    asked = numbers_with(sides, had, of_positions)
    return {number.name: number.value(lambda part, _: cars[part], tree.unit) for number in asked}


def _needs_positions(name: str) -> bool:
    """Whether a name is that of a number that needs positions only."""
    return name in EFFECTS and EFFECTS[name].along is None


def _components(array: Array) -> Vector:
    """The components of a vector, (3,) or (N, 3)."""
    return array[..., 0], array[..., 1], array[..., 2]


def _jets(states: Array) -> Vector:
    """A vector with its rates, (N, orders, 3), as jets."""
    x, y, z = (Jet(*states[..., axis].T) for axis in range(3))
    return x, y, z


def _states(vector: Vector, still: Array) -> list[Array]:
    """The value and two rates, (N, 3) each, of a vector of jets; a missing rate is zero."""
    return [np.stack([jet.part(order) + still[:, 0] for jet in vector], axis=-1) for order in range(3)]
