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
from validate.formulations.asked_numbers import known_names

AXES = "xyz"
PLACES = next(q for q, of in QUANTITIES.items() if of.of == "point" and of.unit == "mm")
TIME, INPUT, TRAVEL, NUMBER, IGNORE, CONTACT = "time", "input", "travel", "number", "ignore", "contact"
NAMED = 5  # largest number of names in a message


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
        if self.kind == NUMBER:
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


def some_meanings(topology: Topology) -> str:
    """The possible meanings of a column in words: all that give the pose of a row, and some numbers."""
    inputs = [f"{INPUT}.{name}" for name in topology.inputs]
    numbers = [one for one in meanings_of(topology).values() if one.kind == NUMBER]
    some = [one.words for one in sorted(numbers, key=lambda one: one.axis is not None)[:NAMED]]
    centre, travel = topology.wheel_centre, f"{TRAVEL}.POINT"
    if centre:
        some.insert(0, f"{PLACES}.{centre}.z")
        travel = f"{travel} such as {TRAVEL}.{centre}, {TRAVEL}.{CONTACT}"
    such = f"QUANTITY.NAME[.AXIS] such as {', '.join(some)}"
    return f"{', '.join((TIME, *inputs, travel, such))}, or {IGNORE}"


def named(name: str, meanings: Mapping[str, Meaning]) -> Meaning | None:
    """The meaning with a full name, or with the last part of the name of an input or a number of the car.

    POINT.AXIS is a position. If there is none, the name is read in small letters, with _ for spaces and
    hyphens.
    """
    for one in (name, re.sub(r"[\s-]+", "_", name.lower())):
        if whole := meanings.get(one) or meanings.get(f"{PLACES}.{one}"):
            return whole
        short = [m for m in meanings.values() if m.name == one and m.axis is None and m.kind != TRAVEL]
        # The force of a rod may have the name of a wheel angle; the angle is taken.
        number = number_called(one)
        short = [m for m in short if number and m.quantity == number.quantity.name] or short
        if len(short) == 1:
            return short[0]
    return None
