"""How pictures by matplotlib look: their letters, frame and colours. It is of the extra `plot`."""

from __future__ import annotations

import io
from contextlib import ContextDecorator
from textwrap import fill
from typing import Any

from validate.extras import not_there
from validate.plain_text import shown

try:
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
except ImportError as error:
    raise not_there("validate.output.figure", error, "plot") from None

# Okabe and Ito, Color Universal Design, 2008; yellow is left out, being too light for lines on paper.
ORANGE, SKY, GREEN = "#e69f00", "#56b4e9", "#009e73"
BLUE, RED, PINK = "#0072b2", "#d55e00", "#cc79a7"
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
LOOK: ContextDecorator = mpl.rc_context(SETTINGS)
"""Decorates a function that draws: what it draws looks so."""
SHADES = mpl.colormaps["viridis"]  # from dark to light
DOTS = 200  # to an inch, of a PNG
TITLE = 0.08  # inches, of a letter of a title, on average


def panels(
    size: tuple[float, float], title: str, rows: int, columns: int, sharex: bool = False, sharey: bool = False
) -> tuple[Figure, list[Axes]]:
    """A new page and its panels, row by row, below a title that takes as many lines as it needs.

    Args:
        size: width and height, inches. sharex, sharey: whether panels have that axis in common.
    """
    page = Figure(figsize=size, layout="constrained")
    heading = fill(shown(title), int(size[0] / TITLE))
    page.suptitle(heading, x=0.02, ha="left", fontsize=9.0, parse_math=False)
    every = [*page.subplots(rows, columns, squeeze=False, sharex=sharex, sharey=sharey).flat]
    for axes in every:
        plain(axes)
    return page, every


def plain(axes: Axes) -> None:
    """A frame of two sides and a faint grid of the decades."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(True, which="major", color=FAINT, linewidth=0.4)
    axes.set_axisbelow(True)
    axes.minorticks_off()


@LOOK
def drawn(figure: Figure, ending: str) -> bytes:
    """A figure as the bytes of a file, `svg` or `png`; the same for the same figure."""
    stream = io.BytesIO()
    # A date, or the version of a library, would make a file of the same rows another one.
    metadata: dict[str, Any] = {"Date": None, "Creator": None} if ending == "svg" else {"Software": None}
    figure.savefig(stream, format=ending, dpi=DOTS, metadata=metadata)
    return stream.getvalue()
