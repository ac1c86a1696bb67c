"""What a program found: poses of a linkage at inputs, how they change, and how that is reported."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from validate.peers.linkage import Inputs, Linkage
from validate.reference.effects.registry import ANGLES
from validate.spanning_tree.chassis import ChassisMotion
from validate.spanning_tree.wheels import OF_CAR

Array = NDArray[np.float64]
Rates = dict[str, dict[str, Array]]
"""Velocity and acceleration of every moving point, in the linkage's unit, and of the turns of the bodies that
are reported, by quantity and name, (N, 3).
"""


@dataclass(frozen=True)
class Poses:
    """Poses of a linkage, in its unit and from its origin.

    Attributes:
        inputs: of the drives, (N, drives), rad and the unit.
        coordinates: the program's own, (N, ...).
        places: of every moving point, (N, 3).
        last_step: the last correction of Newton's method, rad and car sizes, (N,).
        counts: what was done.
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
    """All that is known of a motion, by quantity and name, in the car's axes, mm, s and rad.

    Args:
        inputs: what moves the chassis; it rests where there are none.
        effects: names of the numbers of the wheels that are wanted, see `spanning_tree.wheels`.
    """
    tree, unit, still = linkage.tree, linkage.tree.unit, np.zeros((len(poses.inputs), 3))
    near = {name: poses.places.get(name, still + place.at) for name, place in tree.points.items()}
    found: dict[str, dict[str, Array]] = {
        "position": {name: place * unit + tree.origin for name, place in near.items()}
    }
    if rates is not None:
        found |= rates
        for quantity in ("velocity", "acceleration"):
            found[quantity] = {name: rates[quantity].get(name, still) * unit for name in near}
    chassis = None if inputs is None else ChassisMotion.of(linkage.plain, inputs.laws)
    if chassis is not None:
        found = chassis.moved(found)
    found[OF_CAR] = linkage.wheels.numbers(near, {} if inputs is None else inputs.laws, effects)
    return found
