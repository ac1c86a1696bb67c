"""A point that lies apart from all the others, and would not but for one slip of the pen.

A slip is a wrong sign of one coordinate, or a point ten times too large or too small.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal

from validate.hardpoint_files.contents import Place

# How far a point must lie off the others, in sizes of the box around them, and which part of that may be left
# without the slip: the top of a strut lies off the others as it is drawn.
APART, LEFT = Decimal("0.1"), Decimal("0.5")
TEN = Decimal(10)


@dataclass(frozen=True)
class Slip:
    """A slip that may have been made.

    Attributes:
        name: of the point, ours. place: where it lies without the slip. words: what undoes it.
    """

    name: str
    place: Place
    words: str


def slips(places: Mapping[str, Place], names: Iterable[str]) -> Iterator[Slip]:
    """The slips of points of these names that bring them back among the others."""
    for name in names:
        others = [place for other, place in places.items() if other != name]
        apart = _apart(places[name], others)
        if apart <= APART:
            continue
        for slip in _undone(name, places[name]):
            if _apart(slip.place, others) < LEFT * apart:
                yield slip


def _undone(name: str, place: Place) -> Iterator[Slip]:
    x, y, z = place
    yield Slip(name, (-x, y, z), "x of the other sign")
    yield Slip(name, (x, -y, z), "y of the other sign")
    yield Slip(name, (x, y, -z), "z of the other sign")
    yield Slip(name, (x * TEN, y * TEN, z * TEN), "ten times as much")
    yield Slip(name, (x / TEN, y / TEN, z / TEN), "a tenth as much")


def _apart(place: Place, others: Iterable[Place]) -> Decimal:
    """How far a place lies off the box around others, in its sizes, all coordinates together."""
    apart = Decimal(0)
    for value, column in zip(place, zip(*others, strict=True), strict=True):
        low, high = min(column), max(column)
        if high > low:
            apart += max(low - value, value - high, Decimal(0)) / (high - low)
    return apart
