"""What a column of a file can be: a time, an input, a travel, or a number of the car.

`travel.POINT` is how much higher a point is than in the closed drawing; `travel.contact` is that of the
lowest point of a thin disc of the rolling radius about the wheel's centre. Names are those of the files that
`pointcoord simulate -o` writes; inputs and numbers that a car has one of may be called by their last part.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Literal

from pointcoord.effects.angle import Angle
from pointcoord.effects.registry import QUANTITIES, angle_called
from pointcoord.linkage.topology import Topology
from validate.formulations.asked_numbers import per_second
from validate.solvers.names import known_names

AXES = "xyz"
PLACES = next(q for q, of in QUANTITIES.items() if of.of == "point" and of.unit == "mm")
TIME, INPUT, TRAVEL, IGNORE, CONTACT = "time", "input", "travel", "ignore", "contact"


@dataclass(frozen=True)
class Meaning:
    """What a column is.

    Attributes:
        kind: time, an input, a travel, or a number of a quantity.
        quantity: of a number. name: of the input, of the point that travels, or of the number.
        axis: 0 to 2 of a component of a vector; None of what the car has one number of.
        unit: ours.
    """

    kind: Literal["time", "input", "travel", "number"]
    name: str
    unit: str
    quantity: str = ""
    axis: int | None = None

    @property
    def words(self) -> str:
        """Its name as a map says it."""
        if self.kind == "number":
            end = () if self.axis is None else (AXES[self.axis],)
            return ".".join((self.quantity, self.name, *end))
        return TIME if self.kind == TIME else f"{self.kind}.{self.name}"

    @property
    def row(self) -> tuple[str, str]:
        """Under which quantity and name a number is compared, with others of its vector."""
        return self.quantity, self.name

    @property
    def drives(self) -> str:
        """The input that it gives, which is called as the travel where it gives one; time likewise."""
        return self.words if self.kind == TRAVEL else self.name

    @property
    def of_a_pose(self) -> bool:
        """Whether it is a number of places alone: a coordinate, or an angle of a line."""
        return self.quantity == PLACES or angle_of(self) is not None

    @property
    def per_second(self) -> int:
        """How many times it is divided by a time."""
        return per_second(self.quantity) if self.quantity else 0


def meanings_of(topology: Topology) -> dict[str, Meaning]:
    """Everything that a column can be, by its whole name."""
    every = [Meaning("time", TIME, "s")]
    every += [Meaning("input", name, unit) for name, unit in topology.input_units.items()]
    contact = (CONTACT,) if topology.wheel_axis else ()
    every += [Meaning("travel", n, "mm") for n in (*contact, *topology.moving, *topology.carried)]
    for quantity, names in known_names(topology).items():
        kind = QUANTITIES[quantity]
        axes = (None,) if kind.of == "car" else (0, 1, 2)
        every += [Meaning("number", name, kind.unit, quantity, axis) for name, axis in product(names, axes)]
    return {one.words: one for one in every}


def named(name: str, meanings: Mapping[str, Meaning]) -> Meaning | None:
    """By its whole name, or by the last part of an input's or of a number that a car has one of."""
    if name in meanings:
        return meanings[name]
    short = [one for one in meanings.values() if one.name == name and one.axis is None and one.kind != TRAVEL]
    # A rod may be called as an angle of the wheel is, and have a force.
    short = [one for one in short if angle_of(one) is not None] or short
    if not short and name != name.lower():
        return named(name.lower(), meanings)
    return short[0] if len(short) == 1 else None


def angle_of(meaning: Meaning) -> Angle | None:
    """The angle that a number is; None if it is none of a line."""
    angle = angle_called(meaning.name)
    return angle if angle and meaning.quantity == angle.quantity.name else None
