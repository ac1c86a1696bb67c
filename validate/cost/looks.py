"""How each way looks, in pictures and on pages: a colour, a dash and a marker of its own.

A colour serves twice, with a full line and with a dashed one. They stand out of white and of black, and
nobody has to tell colours apart: no two ways share a marker.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

BLUE, VERMILION, GREEN, VIOLET, OLIVE, GREY, PINK, CYAN = (
    "#2f86c9",
    "#d9641c",
    "#2f9e44",
    "#8f6be8",
    "#94851a",
    "#808080",
    "#d0489a",
    "#129bb0",
)
Dash = tuple[float, ...]
FULL: Dash = ()
DASHED: Dash = (5.0, 2.0)
DASHED_AND_DOTTED: Dash = (6.0, 2.0, 1.5, 2.0)


@dataclass(frozen=True)
class Look:
    """How a way is drawn.

    Attributes:
        dash: lengths of strokes and gaps in widths of the line; none of a full one.
        marker: as matplotlib has it. symbol: the same as plotly has it.
        width, size: of line and marker, in points.
    """

    colour: str
    dash: Dash
    marker: str
    symbol: str
    width: float = 1.3
    size: float = 6.0


LOOKS = {
    "series": Look(BLUE, FULL, "o", "circle", 2.0, 5.5),
    "map": Look(CYAN, FULL, "d", "diamond-tall", 1.6, 6.5),
    "newton": Look(VERMILION, FULL, "s", "square", 1.6, 5.0),
    "newton-cold": Look(VERMILION, DASHED, "H", "hexagon2"),
    "chord": Look(OLIVE, FULL, "^", "triangle-up", 1.6),
    "series-differences": Look(BLUE, DASHED, "p", "pentagon"),
    "newton-differences": Look(OLIVE, DASHED, "h", "hexagon"),
    "printed": Look(GREY, FULL, "x", "x-thin"),
    "absolute": Look(GREEN, FULL, "D", "diamond", size=5.0),
    "relative": Look(VIOLET, FULL, "P", "cross", size=6.5),
    "scipy-root": Look(VIOLET, DASHED, "v", "triangle-down"),
    "scipy-root-jac": Look(CYAN, DASHED, "<", "triangle-left"),
    "least-squares": Look(PINK, DASHED, ">", "triangle-right"),
    "least-squares-jac": Look(GREY, DASHED, "8", "octagon"),
    "mujoco": Look(PINK, FULL, "*", "star", size=9.0),
    "exudyn": Look(GREEN, DASHED, "X", "x", size=6.5),
}
"""The ways that are known; no two of them share colour and dash, nor a marker."""
# For ways that have no look of their own yet, in their order.
FURTHER = tuple(
    Look(colour, DASHED_AND_DOTTED, marker, symbol, size=7.0)
    for marker, symbol in (("1", "y-down"), ("+", "cross-thin"), ("2", "y-up"))
    for colour in (BLUE, VERMILION, GREEN, VIOLET, OLIVE, GREY, PINK, CYAN)
)


def looks(ways: Iterable[str]) -> dict[str, Look]:
    """A look for each way; the same for the same ways."""
    names = list(dict.fromkeys(ways))
    order = [*(name for name in LOOKS if name in names), *sorted(set(names) - set(LOOKS))]
    new = [name for name in order if name not in LOOKS]
    return {name: LOOKS[name] if name in LOOKS else FURTHER[new.index(name) % len(FURTHER)] for name in order}
