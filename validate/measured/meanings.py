"""What a column of a file can be: a time, an input, a travel, a rate of these, or a number of the car.

`travel.POINT` is how much higher a point is than in the closed drawing; `travel.contact` is that of the
lowest point of a thin disc of the rolling radius about the wheel's centre. Names are those of the files that
`pointcoord simulate -o` writes; the last part of a name will do where nothing else ends so.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

from pointcoord.effects.angle import Angle
from pointcoord.effects.registry import QUANTITIES, angle_called
from pointcoord.linkage.topology import Topology
from validate.solvers.names import known_names

AXES = "xyz"
# d(toe)/d(bump), or dtoe/dbump.
_DERIVATIVE = re.compile(r"d\(?(.+?)\)?/d\(?(.+?)\)?")
PLACES = next(q for q, quantity in QUANTITIES.items() if quantity.of == "point" and quantity.unit == "mm")
TIME, INPUT, TRAVEL, IGNORE, CONTACT = "time", "input", "travel", "ignore", "contact"
RATES = ("rate", "acceleration")


@dataclass(frozen=True)
class Meaning:
    """What a column is.

    Attributes:
        kind: time, an input, a travel, or a number of a quantity.
        quantity: of a number. name: of the input, of the point that travels, or of the number.
        axis: 0 to 2 of a component of a vector; None of what the car has one number of.
        unit: ours.
        per: what the independent column is, in words, of a derivative by it; empty of what is none.
        order: of the time derivative of an input or a travel; its name is then that of the whole, input.NAME.
    """

    kind: Literal["time", "input", "travel", "number", "rate"]
    name: str
    unit: str
    quantity: str = ""
    axis: int | None = None
    per: str = ""
    order: int = 0

    @property
    def label(self) -> str:
        """Under which name it is compared: that of the number, and by what it is a derivative."""
        return f"{self.name} per {self.per}" if self.per else self.name

    @property
    def words(self) -> str:
        """Its name as a map says it."""
        if self.kind == "number":
            end = () if self.axis is None else (AXES[self.axis],)
            whole = ".".join((self.quantity, self.name, *end))
            return f"d({whole})/d({self.per})" if self.per else whole
        if self.kind == "rate":
            return f"{self.name}.{RATES[self.order - 1]}"
        return TIME if self.kind == TIME else f"{self.kind}.{self.name}"


def meanings_of(topology: Topology) -> dict[str, Meaning]:
    """Everything that a column can be, by its whole name."""
    every = [Meaning("input", name, unit) for name, unit in topology.input_units.items()]
    contact = (CONTACT,) if topology.wheel_axis else ()
    every += [Meaning("travel", n, "mm") for n in (*contact, *topology.moving, *topology.carried)]
    found = {TIME: Meaning("time", TIME, "s")} | {one.words: one for one in every}
    for one in every:
        for order, per in ((1, "s"), (2, "s^2")):
            rate = Meaning("rate", one.words, f"{one.unit}/{per}", order=order)
            found[rate.words] = rate
    for quantity, names in known_names(topology).items():
        kind = QUANTITIES[quantity]
        for name, axis in product(names, (None,) if kind.of == "car" else (0, 1, 2)):
            number = Meaning("number", name, kind.unit, quantity, axis)
            found[number.words] = number
    return found


def named(name: str, meanings: Mapping[str, Meaning]) -> Meaning | None:
    """By its whole name, or by an end of it that nothing else has; a derivative by what it is of."""
    if (parts := _DERIVATIVE.fullmatch(name)) is not None:
        of = named(parts.group(1), meanings)
        return replace(of, per=parts.group(2)) if of is not None and of.kind == "number" else None
    if name in meanings:
        return meanings[name]
    ends = [one for whole, one in meanings.items() if whole.endswith(f".{name}")]
    ends = [one for one in ends if one.kind != TRAVEL and not one.name.startswith(f"{TRAVEL}.")]
    # A rod may be called as an angle of the wheel is, and have a force.
    ends = [one for one in ends if angle_of(one) is not None] or ends
    if not ends and name != name.lower():
        return named(name.lower(), meanings)
    return ends[0] if len(ends) == 1 else None


def angle_of(meaning: Meaning) -> Angle | None:
    """The angle that a number is; None if it is none of a line."""
    angle = angle_called(meaning.name)
    return angle if angle and meaning.quantity == angle.quantity.name else None
