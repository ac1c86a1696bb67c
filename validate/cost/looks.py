"""How each way looks, in pictures and on pages: a colour with a dash, and a marker of its own.

A colour serves twice, with a full line and with a dashed one. They stand out of white and of black, and
nobody has to tell colours apart: no two ways share a marker.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from validate.cost.ways.registry import WAYS

# Blue, vermilion, green, violet, olive, grey, pink, cyan.
COLOURS = ("#2f86c9", "#d9641c", "#2f9e44", "#8f6be8", "#94851a", "#808080", "#d0489a", "#129bb0")
DASHES: tuple[tuple[float, ...], ...] = ((), (5.0, 2.0), (6.0, 2.0, 1.5, 2.0))
# As matplotlib and as plotly have them.
MARKERS = (
    *(("o", "circle"), ("s", "square"), ("D", "diamond"), ("P", "cross"), ("^", "triangle-up")),
    *(("x", "x-thin"), ("*", "star"), ("d", "diamond-tall"), ("H", "hexagon2"), ("p", "pentagon")),
    *(("h", "hexagon"), ("v", "triangle-down"), ("<", "triangle-left"), (">", "triangle-right")),
    *(("8", "octagon"), ("X", "x"), ("1", "y-down"), ("+", "cross-thin"), ("2", "y-up")),
)
KEY = (
    "A line is a way, a mark one of its settings; down is more accurate, left is quicker. Filled and with a "
    "star: one solve serves any instant; hollow: every instant is solved."
)


@dataclass(frozen=True)
class Look:
    """How a way is drawn: `dash` in widths of the line, `marker` of matplotlib, `symbol` of plotly."""

    colour: str
    dash: tuple[float, ...]
    marker: str
    symbol: str


def looks(ways: Iterable[str]) -> dict[str, Look]:
    """A look for each way; of those of the study always the same."""
    names, known = set(ways), [way.name for way in WAYS]
    every = enumerate([*known, *sorted(names - set(known))])
    return {
        name: Look(COLOURS[i % 8], DASHES[i // 8 % 3], *MARKERS[i % len(MARKERS)])
        for i, name in every
        if name in names
    }
