"""What a section of the page is made of, as plain data: text, plots as plotly draws them, and tables.

Texts in plots come from our own registries, or through `plain`: plotly reads some HTML in its labels, and a
scene's own words stand around a plot and not in it.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from validate.output.table import Table

Array = NDArray[np.float64]
Trace = dict[str, Any]
"""What plotly draws in one colour, as it has it."""

# Blue and vermilion, which colour-blind eyes tell apart, in tones that stand out of white and of black.
OURS, OTHER = "#2f86c9", "#d9641c"


@dataclass(frozen=True)
class Paragraph:
    """Text, and what kind of verdict it tells, if any, with small print below it."""

    template: ClassVar[str] = "paragraph.html"
    text: str
    verdict: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes:
        words: what is drawn, for people who see the page and for those who hear it.
        traces, layout: as plotly has them.
        rem: height of one that is as wide as the page; 0 of one that stands beside others.
    """

    words: str
    traces: tuple[Trace, ...]
    layout: Mapping[str, Any]
    rem: float = 0.0

    @property
    def json(self) -> str:
        """The panel for the script of the page."""
        return json.dumps({"data": self.traces, "layout": self.layout}, allow_nan=False)


@dataclass(frozen=True)
class Plots:
    """Panels side by side, as many as the page is wide.

    Attributes:
        at_once: whether they are seen before anybody opens them, however many others stand beside them.
    """

    template: ClassVar[str] = "plots.html"
    caption: str
    panels: tuple[Panel, ...]
    at_once: bool = False


@dataclass(frozen=True)
class Spatial:
    """A drawing in space that moves.

    Attributes:
        scene: whose it is. caption: what its lines are. json: what is drawn, for the script of the page.
        count: of its instants. curves: that stand beside it.
        at_once: whether it is seen before anybody opens it, as the first one is.
    """

    template: ClassVar[str] = "spatial.html"
    scene: str
    caption: str
    json: str
    count: int
    curves: Plots | None = None
    at_once: bool = False


Block = Paragraph | Plots | Spatial | Table
"""A piece of a page; its `template` draws it as `block`."""


def panel(words: str, across: str, up: str, traces: Iterable[Trace], logarithmic: str = "") -> Panel:
    """Traces over a pair of axes.

    Args:
        across, up: titles of the axes. logarithmic: which of them are, `y` or `xy`.
    """
    layout: dict[str, Any] = {"showlegend": True}
    for name, title in (("x", across), ("y", up)):
        scale = {"type": "log", "exponentformat": "power", "nticks": 6} if name in logarithmic else {}
        layout[f"{name}axis"] = {"title": {"text": title}, "automargin": True, **scale}
    return Panel(words, tuple(traces), layout)


def curve(name: str, x: ArrayLike, y: ArrayLike, colour: str, **line: Any) -> Trace:
    """A line through points, (N,) each; a single one is seen as such."""
    mode = "lines" if np.size(x) > 1 else "markers"
    look = {"mode": mode, "line": {"color": colour, **line}, "marker": {"color": colour}}
    return {"x": numbers(x), "y": numbers(y), "name": name, **look}


def marks(name: str, x: ArrayLike, y: ArrayLike, colour: str, symbol: str = "x", size: int = 7) -> Trace:
    """Points, (N,) each, that no line joins; crosses if not said otherwise."""
    look = {"symbol": symbol, "color": colour, "size": size}
    return {"x": numbers(x), "y": numbers(y), "name": name, "mode": "markers", "marker": look}


def gaps(words: str, over: str, x: Array, difference: Array, tolerance: Array, unit: str) -> Panel:
    """Differences and what each is held to, (N,) each."""
    # A logarithm has no place for a difference or a tolerance of nothing.
    held, apart = (np.where(part > 0.0, part, np.nan) for part in (tolerance, difference))
    dots = {"mode": "lines+markers", "marker": {"size": 4}}
    traces = curve("tolerance", x, held, OTHER), curve("difference", x, apart, OURS, width=1) | dots
    return panel(words, over, f"[{unit}]", traces, logarithmic="y")


def numbers(array: ArrayLike) -> list[float | None]:
    """Numbers in as many digits as a drawing needs; None where there is none."""
    values = np.asarray(array, dtype=float).tolist()
    return [float(f"{value:.6g}") if math.isfinite(value) else None for value in values]


def fewer(weight: Array, most: int) -> Sequence[int]:
    """Places of at most so many numbers of (N,): of each stretch that which weighs most, and the ends."""
    count = len(weight)
    if count <= most:
        return range(count)
    stretches = np.array_split(np.arange(count), most - 2)
    peaks = {int(stretch[np.argmax(weight[stretch])]) for stretch in stretches}
    return sorted(peaks | {0, count - 1})


def plain(text: str) -> str:
    """Words from a file as a label: plotly reads some HTML, and these are no marks of it."""
    return re.sub(r"[^\w .,:;()[\]/^+=-]", "?", text)
