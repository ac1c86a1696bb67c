"""The style of matplotlib pictures: fonts, frame and colours. Needs the extra `plot`."""

from __future__ import annotations

import io
from contextlib import ContextDecorator
from textwrap import fill
from typing import Any

from validate.extras import needing
from validate.plain_text import shown

with needing("a picture"):
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito, Color Universal Design, 2008, without yellow, which is too light for lines on paper.
ORANGE, SKY, GREEN = "#e69f00", "#56b4e9", "#009e73"
BLUE, RED, PINK = "#0072b2", "#d55e00", "#cc79a7"
GREY = "#777777"
FAINT = "#cccccc"
INK = "#222222"
# Text is drawn as outlines, so that a picture looks the same everywhere; the hash salt keeps ids constant.
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
"""Decorator of a drawing function: applies `SETTINGS`."""
SHADES = mpl.colormaps["viridis"]  # from dark to light
DOTS = 200  # dots per inch of a PNG
TITLE = 0.08  # average width of a letter of a title, inches


def panels(
    size: tuple[float, float], title: str, rows: int, columns: int, sharex: bool = False, sharey: bool = False
) -> tuple[Figure, list[Axes]]:
    """A new page and its panels, row by row, below a title that is wrapped to the width.

    Only the left and bottom sides of the frames are drawn, and a faint grid at the major ticks.

    Args:
        size: width and height, inches. sharex, sharey: whether the panels share this axis.
    """
    page = Figure(figsize=size, layout="constrained")
    heading = fill(shown(title), int(size[0] / TITLE))
    page.suptitle(heading, x=0.02, ha="left", fontsize=9.0, parse_math=False)
    every = [*page.subplots(rows, columns, squeeze=False, sharex=sharex, sharey=sharey).flat]
    for axes in every:
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(True, which="major", color=FAINT, linewidth=0.4)
        axes.set_axisbelow(True)
        axes.minorticks_off()
    return page, every


@LOOK
def drawn(figure: Figure, target: str = "") -> bytes:
    """A figure as the bytes of a file: PNG if its name ends in .png, else SVG. Equal figures, equal bytes."""
    ending, stream = "png" if target.endswith(".png") else "svg", io.BytesIO()
    # Without a date and library version, which would change the bytes.
    metadata: dict[str, Any] = {"Date": None, "Creator": None} if ending == "svg" else {"Software": None}
    figure.savefig(stream, format=ending, dpi=DOTS, metadata=metadata)
    return stream.getvalue()
