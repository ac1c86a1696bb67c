"""The look of each method in pictures and on pages: a colour, a dash pattern and a marker.

A colour is used with several dash patterns. Colours are visible on white and on black. Markers differ from
method to method, so that colours need not be distinguished.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from validate.cost.ways.registry import WAYS

# Blue, vermilion, green, violet, olive, grey, pink, cyan.
COLOURS = ("#2f86c9", "#d9641c", "#2f9e44", "#8f6be8", "#94851a", "#808080", "#d0489a", "#129bb0")
DASHES: tuple[tuple[float, ...], ...] = ((), (5.0, 2.0), (6.0, 2.0, 1.5, 2.0))
# The markers by their names in matplotlib and in plotly.
MARKERS = (
    *(("o", "circle"), ("s", "square"), ("D", "diamond"), ("P", "cross"), ("^", "triangle-up")),
    *(("x", "x-thin"), ("*", "star"), ("d", "diamond-tall"), ("H", "hexagon2"), ("p", "pentagon")),
    *(("h", "hexagon"), ("v", "triangle-down"), ("<", "triangle-left"), (">", "triangle-right")),
    *(("8", "octagon"), ("X", "x"), ("1", "y-down"), ("+", "cross-thin"), ("2", "y-up")),
)
KEY = (
    "A line is a method, a mark is one of its settings; down is more accurate, left is faster. Filled and "
    "with a star: one solve serves any instant; hollow: every instant is solved."
)


@dataclass(frozen=True)
class Look:
    """The look of a method: `dash` in line widths, `marker` for matplotlib, `symbol` for plotly."""

    colour: str
    dash: tuple[float, ...]
    marker: str
    symbol: str


def looks(ways: Iterable[str]) -> dict[str, Look]:
    """A look for each method; a method of the registry always has the same look."""
    names, known = set(ways), [way.name for way in WAYS]
    every = enumerate([*known, *sorted(names - set(known))])
    return {
        name: Look(COLOURS[i % 8], DASHES[i // 8 % 3], *MARKERS[i % len(MARKERS)])
        for i, name in every
        if name in names
    }
