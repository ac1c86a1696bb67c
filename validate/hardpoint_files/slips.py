"""A point that lies apart from all the others, and would not but for one slip of the pen."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal

from validate.hardpoint_files.contents import Place

# How far a point must lie off the others, in sizes of the box around them, and which part of that may be left
# without the slip: the top of a strut lies off the others as it is drawn.
APART, LEFT = Decimal("0.1"), Decimal("0.5")
SLIPS: Mapping[str, tuple[Decimal | int, Decimal | int, Decimal | int]] = {
    "x of the other sign": (-1, 1, 1),
    "y of the other sign": (1, -1, 1),
    "z of the other sign": (1, 1, -1),
    "ten times as much": (10, 10, 10),
    "a tenth as much": (Decimal("0.1"), Decimal("0.1"), Decimal("0.1")),
}


def slips(places: Mapping[str, Place], names: Iterable[str]) -> Iterator[tuple[str, Place, str]]:
    """Points of these names that a slip brings back among the others: the name, the place, what undoes it."""
    for name in names:
        others = [*zip(*(place for other, place in places.items() if other != name), strict=True)]
        apart = _apart(places[name], others)
        for words, (a, b, c) in SLIPS.items() if apart > APART else ():
            x, y, z = places[name]
            if _apart(place := (a * x, b * y, c * z), others) < LEFT * apart:
                yield name, place, words


def _apart(place: Place, others: Iterable[tuple[Decimal, ...]]) -> Decimal:
    """How far a place lies off the box around others, in its sizes, all coordinates together."""
    apart = Decimal(0)
    for value, column in zip(place, others, strict=True):
        low, high = min(column), max(column)
        if high > low:
            apart += max(low - value, value - high, Decimal(0)) / (high - low)
    return apart
