"""What came of a sweep, gathered block by block: how many designs, why some failed, how far numbers range."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Sweep
from pointcoord.effects.registry import ALWAYS, QUANTITIES
from pointcoord.sweeping.swept import Failure, Noted, merged

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

    @classmethod
    def of(cls, numbers: Array, first: int) -> Extremes | None:
        """Those of numbers of consecutive designs, (D, ...); None if there are none."""
        flat = numbers.reshape(len(numbers), -1)
        if not np.isfinite(flat).any():
            return None
        low, high = (int(place(flat, axis=None)) // flat.shape[1] for place in (np.nanargmin, np.nanargmax))
        return cls(float(np.nanmin(flat)), first + low, float(np.nanmax(flat)), first + high)

    def with_more(self, other: Extremes) -> Extremes:
        """Of both."""
        low = self if self.lowest <= other.lowest else other
        high = self if self.highest >= other.highest else other
        return Extremes(low.lowest, low.design_of_lowest, high.highest, high.design_of_highest)

    @property
    def data(self) -> dict[str, float | int]:
        """As plain data."""
        return dict(vars(self))


Label = tuple[str, str]
"""Quantity and name."""


@dataclass
class Summary:
    """What is there so far of a sweep.

    Attributes:
        total: how many designs were asked for.
        told: the point whose place is told.
    """

    total: int
    told: str
    tried: int = 0
    instants: int = 0
    failed: list[int] = field(default_factory=list)
    failures: dict[str, tuple[int, Failure]] = field(default_factory=dict)
    count_failed: int = 0
    notes: tuple[Noted, ...] = ()
    varied: dict[str, Extremes] = field(default_factory=dict)
    as_drawn: dict[Label, Extremes] = field(default_factory=dict)
    in_motion: dict[Label, Extremes] = field(default_factory=dict)

    def add(self, block: Sweep) -> None:
        """Take in a block."""
        self.tried += len(block)
        self.instants = len(block.times)
        self.count_failed += len(block.failures)
        self.failed += list(block.failures)[: LISTED - len(self.failed)]
        for failure in block.failures.values():
            count, first = self.failures.get(failure.reason, (0, failure))
            self.failures[failure.reason] = (count + 1, first)
        self.notes = merged((*self.notes, *block.notes))
        for name, values in block.varied.items():
            _extend(self.varied, name, values, block.first)
        for name, values in block.drawn.items():
            _extend(self.as_drawn, (ANGLES, name), values, block.first)
        for label, values in _told(block, self.told):
            _extend(self.in_motion, label, values, block.first)

    @property
    def solved(self) -> int:
        """How many designs were solved."""
        return self.tried - self.count_failed

    def lines(self) -> list[str]:
        """For people, angles in degrees."""
        said = [
            f"varied: {name} from {one.lowest:.6g} to {one.highest:.6g} mm"
            for name, one in self.varied.items()
        ]
        said.append(f"solved: {self.solved} of {self.tried} designs, at {_counted(self.instants)} each")
        for reason, (count, first) in sorted(self.failures.items(), key=lambda item: -item[1][0]):
            said.append(f"failed: {count}, {reason}; design {first.design} for one: {first.error}")
        labels = [label for label in self.in_motion if label in self.as_drawn]
        labels += [label for label in self.in_motion if label not in self.as_drawn]
        if labels:
            rows = [
                (_name(one), _range(self.as_drawn.get(one), one), _range(self.in_motion[one], one))
                for one in labels
            ]
            said += _table([("", "as drawn", "over the motion"), *rows])
        return said

    def data(self) -> dict[str, Any]:
        """As plain data, angles in rad."""
        return {
            "designs": self.total,
            "instants": self.instants,
            "tried": self.tried,
            "solved": self.solved,
            "varied": {name: one.data for name, one in self.varied.items()},
            "failures": [
                {
                    "reason": reason,
                    "designs": count,
                    "design": first.design,
                    "instant": first.instant,
                    "problem": str(first.error),
                }
                for reason, (count, first) in self.failures.items()
            ],
            "failed": self.failed,
            "notes": [
                {"warning": note.warns, "designs": note.count, "design": note.design, "note": note.words}
                for note in self.notes
            ],
            "ranges": [
                {
                    "quantity": quantity,
                    "name": name,
                    "unit": QUANTITIES[quantity].unit,
                    "as_drawn": _data(self.as_drawn.get((quantity, name))),
                    "in_motion": _data(self.in_motion.get((quantity, name))),
                }
                for quantity, name in dict.fromkeys((*self.as_drawn, *self.in_motion))
            ],
        }


def _told(block: Sweep, point: str) -> Iterator[tuple[Label, Array]]:
    """The numbers whose ranges are told: of the car each, of a body its size, of the wheel where it is."""
    for quantity, channel in block.numbers.items():
        for name, array in channel.items():
            if channel.quantity.of == "car":
                yield (quantity, name), array
            elif channel.quantity.of == "body":
                yield (quantity, f"size of {name}"), np.linalg.norm(array, axis=-1)
            elif name == point and quantity == PLACE:
                for i, axis in enumerate("xyz"):
                    yield (quantity, f"{name}.{axis}"), array[..., i]
            elif name == point:
                yield (quantity, f"size of {name}"), np.linalg.norm(array, axis=-1)


def _extend(found: dict[Any, Extremes], key: object, values: Array, first: int) -> None:
    more = Extremes.of(values, first)
    if more is not None:
        found[key] = found[key].with_more(more) if key in found else more


def _data(extremes: Extremes | None) -> Mapping[str, float | int] | None:
    return None if extremes is None else extremes.data


def _name(label: Label) -> str:
    quantity, name = label
    unit = QUANTITIES[quantity].unit
    what = name if quantity == ANGLES else f"{QUANTITIES[quantity].words}, {name}"
    return f"{what} [{'deg' if unit == 'rad' else unit}]"


def _range(extremes: Extremes | None, label: Label) -> str:
    if extremes is None:
        return ""
    factor = 180.0 / np.pi if QUANTITIES[label[0]].unit == "rad" else 1.0
    low, high = (_number(factor * value) for value in (extremes.lowest, extremes.highest))
    if low == high:
        # As far as it is shown; which of them is lowest is rounding.
        return f"{low} in all designs"
    return f"{low} (design {extremes.design_of_lowest}) to {high} (design {extremes.design_of_highest})"


def _number(value: float) -> str:
    return f"{round(value, 4) + 0.0:.6g}"


def _counted(instants: int) -> str:
    return "1 instant" if instants == 1 else f"{instants} instants"


def _table(rows: list[tuple[str, str, str]]) -> list[str]:
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
