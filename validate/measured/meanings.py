"""The possible meanings of a column: time, an input, a travel, or a number of the car.

`travel.POINT` is the height of a point above its position in the closed drawing; `travel.contact` is that of
the lowest point of a thin disc with the rolling radius about the wheel centre. Names are those of the files
that `pointcoord simulate -o` writes. For inputs and numbers of the car the last part of the name is enough,
for positions POINT.AXIS.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Literal

from pointcoord.effects.registry import QUANTITIES, number_called
from pointcoord.linkage.topology import Topology
from validate.formulations.asked_numbers import known_names, per_second

AXES = "xyz"
PLACES = next(q for q, of in QUANTITIES.items() if of.of == "point" and of.unit == "mm")
TIME, INPUT, TRAVEL, NUMBER, IGNORE, CONTACT = "time", "input", "travel", "number", "ignore", "contact"


@dataclass(frozen=True)
class Meaning:
    """The meaning of a column.

    Attributes:
        kind: time, an input, a travel, or a number of a quantity.
        name: name of the input, of the point that travels, or of the number.
        unit: our unit.
        quantity: the quantity of a number.
        axis: component of a vector, 0 to 2; None for a number of the car.
    """

    kind: Literal["time", "input", "travel", "number"]
    name: str
    unit: str
    quantity: str = ""
    axis: int | None = None

    @property
    def words(self) -> str:
        """Its full name, as in a map."""
        if self.kind == "number":
            end = () if self.axis is None else (AXES[self.axis],)
            return ".".join((self.quantity, self.name, *end))
        return TIME if self.kind == TIME else f"{self.kind}.{self.name}"

    @property
    def row(self) -> tuple[str, str]:
        """The quantity and name under which a number is compared with the components of its vector."""
        return self.quantity, self.name

    @property
    def drives(self) -> str:
        """The name of the input that it gives; for a travel its full name."""
        return self.words if self.kind == TRAVEL else self.name

    @property
    def per_second(self) -> int:
        """The order of its time derivative."""
        return per_second(self.quantity) if self.quantity else 0


def meanings_of(topology: Topology) -> dict[str, Meaning]:
    """All possible meanings of a column, by their full names."""
    every = [Meaning("time", TIME, "s")]
    every += [Meaning("input", name, unit) for name, unit in topology.input_units.items()]
    contact = (CONTACT,) if topology.wheel_axis else ()
    every += [Meaning("travel", n, "mm") for n in (*contact, *topology.moving, *topology.carried)]
    for quantity, names in known_names(topology).items():
        kind = QUANTITIES[quantity]
        axes = (None,) if kind.of == "car" else (0, 1, 2)
        every += [Meaning("number", name, kind.unit, quantity, axis) for name, axis in product(names, axes)]
    return {one.words: one for one in every}


def first_numbers(meanings: Mapping[str, Meaning]) -> list[str]:
    """The full names of numbers that can be compared, numbers of the car first."""
    numbers = (one for one in meanings.values() if one.kind == NUMBER)
    return [one.words for one in sorted(numbers, key=lambda one: one.axis is not None)]


def poses_of(topology: Topology) -> str:
    """The columns that can give the pose of a row, in words."""
    inputs = [f"{INPUT}.{name}" for name in topology.inputs]
    centre = f" such as {TRAVEL}.{topology.wheel_centre}" if topology.wheel_centre else ""
    return ", ".join((TIME, *inputs, f"{TRAVEL}.POINT{centre}", f"{TRAVEL}.{CONTACT}"))


def named(name: str, meanings: Mapping[str, Meaning]) -> Meaning | None:
    """The meaning with a full name, or with the last part of the name of an input or a number of the car.

    POINT.AXIS is a position. If there is none, the name is read in small letters, with _ for spaces and
    hyphens.
    """
    for full in (name, f"{PLACES}.{name}"):
        if full in meanings:
            return meanings[full]
    short = [one for one in meanings.values() if one.name == name and one.axis is None and one.kind != TRAVEL]
    # The force of a rod may have the name of a wheel angle; the angle is taken.
    number = number_called(name)
    short = [one for one in short if number and one.quantity == number.quantity.name] or short
    if not short and name != (plain := re.sub(r"[\s-]+", "_", name.lower())):
        return named(plain, meanings)
    return short[0] if len(short) == 1 else None
