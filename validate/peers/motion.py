"""Results of a program: poses of a linkage at given inputs, their rates, and the numbers reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from validate.peers.linkage import Inputs, Linkage
from validate.reference.chassis import ChassisMotion
from validate.reference.effects.registry import ANGLES
from validate.reference.jet import Jet
from validate.reference.kinematics import body_rates
from validate.reference.vectors import Vector
from validate.spanning_tree.wheels import OF_CAR, components

Array = NDArray[np.float64]
Rates = dict[str, dict[str, Array]]
"""Velocity and acceleration of every moving point, in the linkage's unit, and angular velocity and
acceleration of the reported bodies, by quantity and name, (N, 3).
"""


@dataclass(frozen=True)
class Poses:
    """Poses of a linkage, in its unit and from its origin.

    Attributes:
        inputs: of the drives, (N, drives), rad and the unit.
        coordinates: the program's own, (N, ...).
        places: of every moving point, (N, 3).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
        counts: effort of the solver.
    """

    inputs: Array
    coordinates: Array
    places: Mapping[str, Array]
    last_step: Array
    counts: Mapping[str, int]

    def first(self, count: int) -> Poses:
        """The first ones."""
        return replace(
            self,
            inputs=self.inputs[:count],
            coordinates=self.coordinates[:count],
            places={name: place[:count] for name, place in self.places.items()},
            last_step=self.last_step[:count],
        )


def numbers(
    linkage: Linkage,
    inputs: Inputs | None,
    poses: Poses,
    rates: Rates | None = None,
    effects: Iterable[str] = ANGLES,
) -> dict[str, dict[str, Array]]:
    """All quantities of a motion, by quantity and name, in the car's axes, mm, s and rad.

    The motion of the chassis and the numbers of the wheels are computed by the reference's code. The program
    only confirms the positions and rates of the mechanism's points relative to the chassis.

    Args:
        inputs: the inputs that move the chassis; without any, the chassis is at rest.
        effects: names of the numbers of the wheels that are wanted, see `spanning_tree.wheels`.
    """
    tree, unit, still = linkage.tree, linkage.tree.unit, np.zeros((len(poses.inputs), 3))
    near = {name: poses.places.get(name, still + place.at) for name, place in tree.points.items()}
    laws = {} if inputs is None else inputs.laws
    driven = {name: Jet(*laws.get(name, still).T) for name in linkage.plain["inputs"]}
    drawn = {name: components(place) for name, place in tree.drawn.items()}
    chassis = ChassisMotion.of(linkage.plain, drawn, Fraction(unit), driven, float)
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
    found[OF_CAR] = linkage.wheels.numbers(near, chassis.still(), effects)
    return found


def _jets(states: Sequence[Array]) -> Vector:
    """A vector's value and rates, (N, 3) each, as jets."""
    x, y, z = (Jet(*(state[:, axis] for state in states)) for axis in range(3))
    return x, y, z


def _states(vector: Vector, count: int, still: Array) -> list[Array]:
    """The inverse of that; a missing rate is zero."""
    return [np.stack([jet.part(order) + still[:, 0] for jet in vector], axis=-1) for order in range(count)]
