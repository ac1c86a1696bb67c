"""The blocks of a section of the page, as plain data: text, plots for plotly, and tables.

plotly interprets some HTML in its labels. So texts in plots come from the registries of the program, or pass
through `plain`; a title of a scene is placed outside the plot.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from validate.arrays import Array
from validate.output.table import Table

Trace = dict[str, Any]
"""A trace of plotly: a curve or a set of points."""

# Blue and vermilion, which colour-blind readers can distinguish, visible on white and on black.
OURS, OTHER = "#2f86c9", "#d9641c"


@dataclass(frozen=True)
class Paragraph:
    """Text, with small print below it; `verdict` colours it if it states a verdict."""

    template: ClassVar[str] = "paragraph.html"
    text: str
    verdict: str = ""
    detail: str = ""


@dataclass(frozen=True)
class Panel:
    """A plot with one pair of axes.

    Attributes:
        words: what is drawn: the caption, also for screen readers.
        traces, layout: in the format of plotly.
        rem: height of a panel as wide as the page; 0 for a panel next to others.
    """

    words: str
    traces: tuple[Trace, ...]
    layout: Mapping[str, Any]
    rem: float = 0.0

    @property
    def json(self) -> str:
        """The panel as JSON for the script of the page."""
        return json.dumps({"data": self.traces, "layout": self.layout}, allow_nan=False)


@dataclass(frozen=True)
class Plots:
    """Panels side by side, as many in a row as fit the page; unfolded if few or the first of a section."""

    template: ClassVar[str] = "plots.html"
    caption: str
    panels: tuple[Panel, ...]


@dataclass(frozen=True)
class Spatial:
    """An animated 3D drawing of the mechanism; the first of a section is unfolded.

    Attributes:
        scene: name of the scene.
        caption: explains the lines.
        json: the data for the script of the page.
        count: number of instants.
        curves: plots next to the drawing.
    """

    template: ClassVar[str] = "spatial.html"
    scene: str
    caption: str
    json: str
    count: int
    curves: Plots | None = None


Block = Paragraph | Plots | Spatial | Table
"""A piece of a page; the file named `template` renders it, as the variable `block`."""


def panel(words: str, across: str, up: str, traces: Iterable[Trace], logarithmic: str = "") -> Panel:
    """A panel with traces over a pair of axes.

    Args:
        across, up: titles of the horizontal and the vertical axis.
        logarithmic: the logarithmic axes, `y` or `xy`.
    """
    layout: dict[str, Any] = {"showlegend": True}
    for name, title in (("x", across), ("y", up)):
        scale = {"type": "log", "exponentformat": "power", "nticks": 6} if name in logarithmic else {}
        layout[f"{name}axis"] = {"title": {"text": title}, "automargin": True, **scale}
    return Panel(words, tuple(traces), layout)


def curve(name: str, x: ArrayLike, y: ArrayLike, colour: str, **line: Any) -> Trace:
    """A line through N points, x and y (N,); a single point is drawn as a marker."""
    mode = "lines" if np.size(x) > 1 else "markers"
    look = {"mode": mode, "line": {"color": colour, **line}, "marker": {"color": colour}}
    return {"x": numbers(x), "y": numbers(y), "name": name, **look}


def marks(name: str, x: ArrayLike, y: ArrayLike, colour: str, symbol: str = "x", size: int = 7) -> Trace:
    """N markers without a line, x and y (N,); crosses by default."""
    look = {"symbol": symbol, "color": colour, "size": size}
    return {"x": numbers(x), "y": numbers(y), "name": name, "mode": "markers", "marker": look}


def gaps(words: str, over: str, x: Array, difference: Array, tolerance: Array, unit: str) -> Panel:
    """A panel of differences and their tolerances, (N,) each, on a logarithmic axis."""
    # Zero has no place on a logarithmic axis.
    held, apart = (np.where(part > 0.0, part, np.nan) for part in (tolerance, difference))
    dots = {"mode": "lines+markers", "marker": {"size": 4}}
    traces = curve("tolerance", x, held, OTHER), curve("difference", x, apart, OURS, width=1) | dots
    return panel(words, over, f"[{unit}]", traces, logarithmic="y")


def numbers(array: ArrayLike) -> list[float | None]:
    """Numbers rounded to 6 digits, enough for a drawing; None for NaN and infinity."""
    values = np.asarray(array, dtype=float).tolist()
    return [float(f"{value:.6g}") if math.isfinite(value) else None for value in values]


def fewer(weight: Array, most: int) -> Sequence[int]:
    """Indices of at most `most` of N numbers: the largest weight of each stretch, and the ends.

    Args:
        weight: (N,).
    """
    count = len(weight)
    if count <= most:
        return range(count)
    stretches = np.array_split(np.arange(count), most - 2)
    peaks = {int(stretch[np.argmax(weight[stretch])]) for stretch in stretches}
    return sorted(peaks | {0, count - 1})


def plain(text: str) -> str:
    """A text for a plot label, with characters that plotly could read as HTML replaced by question marks."""
    return re.sub(r"[^\w .,:;()[\]/^+=-]", "?", text)
