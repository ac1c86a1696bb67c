"""How a picture looks: its letters and frame, and the look of each way as matplotlib has it."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validate.cost.looks import Look, looks

# Okabe and Ito, Color Universal Design, 2008; yellow is left out, being too light for lines on paper.
ORANGE, SKY, GREEN, BLUE, RED, PINK = (
    "#e69f00",
    "#56b4e9",
    "#009e73",
    "#0072b2",
    "#d55e00",
    "#cc79a7",
)
GREY = "#777777"
FAINT = "#cccccc"
INK = "#222222"
# Text becomes outlines, so that a picture looks alike everywhere; ids do not change from run to run.
SETTINGS: Any = {
    "svg.hashsalt": "pointcoord",
    "svg.fonttype": "path",
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.titlesize": 9.0,
    "axes.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
}
DOTS = 200  # to an inch, of a PNG


def style(look: Look, dense: bool) -> dict[str, Any]:
    """As matplotlib's options; markers are filled for a dense way, else hollow."""
    return {
        "color": look.colour,
        "marker": look.marker,
        "markersize": look.size,
        "markerfacecolor": look.colour if dense else "white",
        "markeredgecolor": look.colour,
        "markeredgewidth": 1.1,
        "linewidth": look.width,
        "linestyle": (0, look.dash) if look.dash else "-",
    }


def handles(ways: Iterable[tuple[str, bool]]) -> list[Line2D]:
    """Entries of a legend, of ways and whether they are dense."""
    named = list(ways)
    found = looks(way for way, _ in named)
    dense = {way: any(d for w, d in named if w == way) for way in found}
    return [
        Line2D([], [], label=f"{way}*" if dense[way] else way, **style(look, dense[way]))
        for way, look in found.items()
    ]


def plain(axes: Axes) -> None:
    """A frame of two sides and a faint grid of the decades."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, which="major", color=FAINT, linewidth=0.4)
    axes.set_axisbelow(True)
    axes.minorticks_off()


def short(number: float) -> str:
    """A number of an axis in few letters: 0.5, 500, 1e4."""
    return f"{number:g}" if number < 9999.0 else f"{number:.0e}".replace("e+0", "e").replace("e+", "e")


def spread(places: Sequence[float], room: float) -> list[float]:
    """Places between 0 and 1 moved apart until each has room, as far as there is any; their order stays.

    Those that crowd stand around their middle.
    """
    order = sorted(range(len(places)), key=lambda i: places[i])
    groups: list[list[int]] = []

    def bottom(group: Sequence[int]) -> float:
        high = room * (len(group) - 1)
        middle = sum(places[i] for i in group) / len(group)
        return max(min(middle - 0.5 * high, 1.0 - high), 0.0)

    for i in order:
        groups.append([i])
        while len(groups) > 1 and bottom(groups[-1]) - bottom(groups[-2]) < room * len(groups[-2]):
            last = groups.pop()
            groups[-1] += last
    found = [0.0] * len(places)
    for group in groups:
        for k, i in enumerate(group):
            found[i] = bottom(group) + k * room
    return found


def drawn(figure: Figure, ending: str) -> bytes:
    """A figure as the bytes of a file, `svg` or `png`; the same for the same figure."""
    stream = io.BytesIO()
    with mpl.rc_context(SETTINGS):
        # A date, or the version of a library, would make a file of the same rows another one.
        metadata: dict[str, Any] = {"Date": None, "Creator": None} if ending == "svg" else {"Software": None}
        figure.savefig(stream, format=ending, dpi=DOTS, metadata=metadata)
    return stream.getvalue()
