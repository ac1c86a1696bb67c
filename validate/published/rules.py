"""Rules that compute the columns of printed tables from our numbers.

Most columns are one of our numbers. Each other rule was found by reproducing the printed numbers. A table
lists the columns for which no rule is known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import number_called

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Solved:
    """A car at the rows of a table, as one formulation solves it.

    Attributes:
        numbers: numbers of the car, (N,), and places of points, (N, 3), by their names; rad and mm.
        over: the first column.
    """

    scene: Scene
    numbers: Mapping[str, Array]
    over: Array


@dataclass(frozen=True)
class Rule:
    """The rule of a printed column.

    Attributes:
        quantity: the kind of number (see `QUANTITIES`); empty if we have none. unit: unit of the values of
            `of`.
        of: the column, (N,), NaN where it does not exist.
    """

    quantity: str
    unit: str
    of: Callable[[Solved], Array]


def _drawn_length(solved: Solved, role: str) -> float:
    part = solved.scene.mechanism
    first, second = (np.array(part.points[name]) for name in part.structure.roles[role])
    return float(np.linalg.norm(second - first))


def _ratio(solved: Solved) -> Array:
    numbers = solved.numbers
    return -numbers["contact_travel_by_travel"] / numbers["damper_length_by_travel"]


def _outward(solved: Solved) -> Array:
    part = solved.scene.mechanism
    centre = part.topology.wheel_centre
    return np.asarray((solved.numbers[centre] - np.array(part.points[centre])) @ part.outboard)


def _length(of: Callable[[Solved], Array]) -> Rule:
    return Rule("dimension", "mm", of)


RULES: Mapping[str, Rule] = {
    # Wheel over damper, by the travel of the contact point: -dz_c / dl.
    "damper_ratio": Rule("dimension_gradient", "mm/mm", _ratio),
    # The damper's length minus its drawn length.
    "damper_travel": _length(lambda car: car.numbers["damper_length"] - _drawn_length(car, "damper")),
    # Of a front axle.
    "wheelbase_change": _length(lambda car: -car.numbers["recession"]),
    # At right angles to the steering axis in side view.
    "trail_at_the_axis": _length(lambda car: car.numbers["castor_offset"] * np.cos(car.numbers["caster"])),
    "roll_centre_to_body": _length(
        lambda car: car.numbers["roll_centre_height"] + car.numbers["contact_travel"]
    ),
    "wheel_centre_outward": _length(_outward),
    # The turning radius, printed as 0 straight ahead.
    "turning_circle": _length(lambda car: np.where(car.over == 0.0, 0.0, car.numbers["turning_radius"])),
}
"""Columns that are not simply one of our numbers."""


def rule_of(name: str) -> Rule:
    """The rule of a name: one of our numbers unchanged, or a rule of this file."""
    if name in RULES:
        return RULES[name]
    number = number_called(name)
    assert number is not None  # a table names what there is
    quantity = number.quantity
    return Rule(quantity.name, quantity.unit, lambda solved: solved.numbers[name])
