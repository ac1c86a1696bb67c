"""How columns of printed tables are made of our numbers.

Most are one of them. Each other rule was found by making the printed numbers again; a table says of which
columns none is known.
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
    """How a printed column is made.

    Attributes:
        quantity: the kind of number (see `QUANTITIES`); empty where we have none. unit: of what `of` gives.
        of: the column, (N,), NaN where it does not exist.
    """

    quantity: str
    unit: str
    of: Callable[[Solved], Array]


def _damper_ratio(solved: Solved) -> Array:
    """Wheel over damper, by the travel of the contact point: -dz_c / dl."""
    numbers = solved.numbers
    return -numbers["contact_travel_by_travel"] / numbers["damper_length_by_travel"]


def _damper_travel(solved: Solved) -> Array:
    """The damper's length less its drawn one."""
    part = solved.scene.mechanism
    first, second = (np.array(part.points[name]) for name in part.structure.roles["damper"])
    return np.asarray(solved.numbers["damper_length"] - np.linalg.norm(second - first))


def _trail_at_the_axis(solved: Solved) -> Array:
    """At right angles to the steering axis in side view."""
    return solved.numbers["castor_offset"] * np.cos(solved.numbers["caster"])


def _roll_centre_to_body(solved: Solved) -> Array:
    return solved.numbers["roll_centre_height"] + solved.numbers["contact_travel"]


def _wheel_centre_outward(solved: Solved) -> Array:
    part = solved.scene.mechanism
    centre = part.topology.wheel_centre
    moved = solved.numbers[centre] - np.array(part.points[centre])
    return np.asarray(moved @ part.outboard)


def _turning_circle(solved: Solved) -> Array:
    """The turning radius, printed as 0 straight ahead."""
    return np.where(solved.over == 0.0, 0.0, solved.numbers["turning_radius"])


RULES: Mapping[str, Rule] = {
    "damper_ratio": Rule("dimension_gradient", "mm/mm", _damper_ratio),
    "damper_travel": Rule("dimension", "mm", _damper_travel),
    # Of a front axle.
    "wheelbase_change": Rule("dimension", "mm", lambda solved: -solved.numbers["recession"]),
    "trail_at_the_axis": Rule("dimension", "mm", _trail_at_the_axis),
    "roll_centre_to_body": Rule("dimension", "mm", _roll_centre_to_body),
    "wheel_centre_outward": Rule("dimension", "mm", _wheel_centre_outward),
    "turning_circle": Rule("dimension", "mm", _turning_circle),
}
"""Columns that are none of our numbers."""


def rule_of(name: str) -> Rule:
    """A number of ours as it is, or a rule by its name."""
    if name in RULES:
        return RULES[name]
    number = number_called(name)
    assert number is not None  # a table names what there is
    quantity = number.quantity
    return Rule(quantity.name, quantity.unit, lambda solved: solved.numbers[name])
