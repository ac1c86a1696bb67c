"""What came of a sweep, gathered block by block: how many designs, why some failed, how far numbers range."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Sweep
from pointcoord.effects.registry import ALWAYS, QUANTITIES
from pointcoord.sweeping.swept import Failure, Noted, merged
from validate.output.report import counted_as
from validate.output.table import Part, Table
from validate.tables.units import degrees_of

Array = NDArray[np.float64]

# What is told of the point that is always reported, and of drawings: angles of the car.
PLACE = ALWAYS[0].quantities[0].name
ANGLES = next(quantity.name for quantity in QUANTITIES.values() if quantity.of == "car")
# Numbers of failed designs that are listed; a table of the sweep has all.
LISTED = 10_000


@dataclass(frozen=True)
class Extremes:
    """The lowest and the highest of numbers, and the designs that have them."""

    lowest: float
    design_of_lowest: int
    highest: float
    design_of_highest: int


Label = tuple[str, str]
"""Quantity and name."""
Ranges = dict[Label, Extremes]


@dataclass
class Summary:
    """What is there so far of a sweep.

    Attributes:
        total: how many designs were asked for.
        told: the point whose place is told.
        failures: by reason how many designs, and the first of them.
        varied, as_drawn, in_motion: how far what varies, the drawings and the motions range.
    """

    total: int
    told: str
    tried: int = 0
    instants: int = 0
    failed: list[int] = field(default_factory=list)
    failures: dict[str, tuple[int, Failure]] = field(default_factory=dict)
    notes: tuple[Noted, ...] = ()
    varied: Ranges = field(default_factory=dict)
    as_drawn: Ranges = field(default_factory=dict)
    in_motion: Ranges = field(default_factory=dict)

    def add(self, block: Sweep) -> None:
        """Take in a block."""
        self.tried += len(block)
        self.instants = len(block.times)
        self.failed += list(block.failures)[: LISTED - len(self.failed)]
        for failure in block.failures.values():
            count, first = self.failures.get(failure.reason, (0, failure))
            self.failures[failure.reason] = (count + 1, first)
        self.notes = merged((*self.notes, *block.notes))
        for name, values in block.varied.items():
            _extend(self.varied, ("", name), values, block.first)
        for name, values in block.drawn.items():
            _extend(self.as_drawn, (ANGLES, name), values, block.first)
        for label, values in _told(block, self.told):
            _extend(self.in_motion, label, values, block.first)

    @property
    def solved(self) -> int:
        """How many designs were solved."""
        return self.tried - sum(count for count, _ in self.failures.values())

    def failed_lines(self) -> list[str]:
        """Why designs failed, the most frequent reason first."""
        return [
            f"{count} of {self.tried} designs failed, {reason}; design {first.design} for one: {first.error}"
            for reason, (count, first) in sorted(self.failures.items(), key=lambda item: -item[1][0])
        ]

    def parts(self) -> tuple[Part, ...]:
        """For people, angles in degrees."""
        said = [
            f"varied: {name} from {one.lowest:.6g} to {one.highest:.6g} mm"
            for (_, name), one in self.varied.items()
        ]
        instants = counted_as(self.instants, "instant")
        said += [f"solved: {self.solved} of {self.tried} designs, at {instants} each", *self.failed_lines()]
        rows = []
        for label in sorted(self.in_motion, key=lambda label: label not in self.as_drawn):
            quantity, name = label
            factor, unit = degrees_of(QUANTITIES[quantity].unit)
            what = name if quantity == ANGLES else f"{QUANTITIES[quantity].words}, {name}"
            ranges = (_range(ranges.get(label), factor) for ranges in (self.as_drawn, self.in_motion))
            rows.append((f"{what} [{unit}]", *ranges))
        return (*said, *([Table(("", "as drawn", "over the motion"), tuple(rows))] if rows else ()))

    def data(self) -> dict[str, Any]:
        """As plain data, angles in rad."""
        failures = [
            {"reason": reason, "designs": count, "design": first.design, "instant": first.instant}
            | {"problem": str(first.error)}
            for reason, (count, first) in self.failures.items()
        ]
        notes = [
            {"warning": note.warns, "designs": note.count, "design": note.design, "note": note.words}
            for note in self.notes
        ]
        when = {"as_drawn": self.as_drawn, "in_motion": self.in_motion}
        ranges = [
            {"quantity": label[0], "name": label[1], "unit": QUANTITIES[label[0]].unit}
            | {name: asdict(some[label]) if label in some else None for name, some in when.items()}
            for label in dict.fromkeys((*self.as_drawn, *self.in_motion))
        ]
        return {
            "designs": self.total,
            "instants": self.instants,
            "tried": self.tried,
            "solved": self.solved,
            "varied": {name: asdict(one) for (_, name), one in self.varied.items()},
            "failures": failures,
            "failed": self.failed,
            "notes": notes,
            "ranges": ranges,
        }


def _told(block: Sweep, point: str) -> Iterator[tuple[Label, Array]]:
    """The numbers whose ranges are told: of the car each, of a body its size, of the wheel where it is."""
    for quantity, channel in block.numbers.items():
        for name, array in channel.items():
            if channel.quantity.of == "car":
                yield (quantity, name), array
            elif name == point and quantity == PLACE:
                for i, axis in enumerate("xyz"):
                    yield (quantity, f"{name}.{axis}"), array[..., i]
            elif channel.quantity.of == "body" or name == point:
                yield (quantity, f"size of {name}"), np.linalg.norm(array, axis=-1)


def _extend(found: Ranges, label: Label, values: Array, first: int) -> None:
    """Take in numbers of consecutive designs, (D, ...); nothing if there are none."""
    flat = values.reshape(len(values), -1)
    if not np.isfinite(flat).any():
        return
    low, high = int(np.nanargmin(flat)), int(np.nanargmax(flat))
    one, other = (first + place // flat.shape[1] for place in (low, high))
    here = (float(flat.flat[low]), one), (float(flat.flat[high]), other)
    if (old := found.get(label)) is not None:
        before = (old.lowest, old.design_of_lowest), (old.highest, old.design_of_highest)
        # Of equal ones the first design is told.
        here = min(before[0], here[0]), max(before[1], here[1], key=lambda end: (end[0], -end[1]))
    found[label] = Extremes(*here[0], *here[1])


def _range(extremes: Extremes | None, factor: float) -> str:
    if extremes is None:
        return ""
    # Adding 0 turns a rounded -0 into 0.
    low, high = (f"{round(factor * one, 4) + 0.0:.6g}" for one in (extremes.lowest, extremes.highest))
    if low == high:
        # As far as it is shown; which of them is lowest is rounding.
        return f"{low} in all designs"
    return f"{low} (design {extremes.design_of_lowest}) to {high} (design {extremes.design_of_highest})"
