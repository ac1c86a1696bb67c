"""Draws curves: a panel for each kind of number; all panels share one axis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from validate.arrays import Array
from validate.curves.numbers import PLACE, TRAVEL, Curves, Number
from validate.output.columns import DESIGN
from validate.output.figure import BLUE, FAINT, GREEN, LOOK, ORANGE, PINK, RED, SHADES, SKY, panels
from validate.plain_text import gathered, shown

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Values = Callable[[Number], Array]

COLOURS = (BLUE, RED, GREEN, ORANGE, PINK, SKY)
STYLES = ("-", "--", "-.", ":")  # for readers who cannot see colours, and for more curves than colours
# Width and height, inches: of a single panel, of panels side by side, of panels above each other, and the
# room for labels and the title.
ALONE, BESIDE, ABOVE, LABELS = (4.4, 3.6), (2.3, 3.6), (5.5, 2.3), (0.9, 1.1)
LETTER = 0.066  # average width of a letter of a label, inches
MOST = 400  # largest number of designs drawn, evenly chosen: more curves would cover each other
# Relative change below which a number is drawn as constant: smaller changes are rounding.
STILL = 1e-9


@LOOK
def figure(curves: Curves, values: Values, title: str) -> Figure:
    """Draw curves.

    Args:
        values: returns the values of a number as shown, (N,).
    """
    upright = len(_panels(curves.across)) > 1 or curves.up[0].path[0] == TRAVEL
    several = _panels(curves.across if upright else curves.up)
    rows, columns = (1, len(several)) if upright else (len(several), 1)
    size = ALONE if len(several) == 1 else BESIDE if upright else ABOVE
    wide, high = columns * size[0] + LABELS[0], rows * size[1] + LABELS[1]
    page, grid = panels((wide, high), title, rows, columns, sharex=not upright, sharey=upright)
    for axes, panel in zip(grid, several, strict=True):
        across, up = (panel, curves.up) if upright else (curves.across, panel)
        _draw(axes, Curves(tuple(across), tuple(up)), values, size)
        axes.label_outer()
    return page


@LOOK
def figure_of(table: pd.DataFrame, across: str, up: Sequence[str], title: str) -> Figure:
    """Draw columns of a sweep's table: a panel for each column in `up`, a curve for each design."""
    designs = [table] if DESIGN not in table else [one for _, one in table.groupby(DESIGN)]
    chosen = np.unique(np.linspace(0, len(designs) - 1, min(len(designs), MOST)).round().astype(int))
    page, grid = panels((5.5, 2.2 * len(up) + 0.8), title, len(up), 1, sharex=True)
    for axes, column in zip(grid, up, strict=True):
        for place in chosen.tolist():
            shade = SHADES(place / max(len(designs) - 1, 1))
            axes.plot(designs[place][across], designs[place][column], color=shade, linewidth=1.0)
        axes.set_ylabel(shown(column), parse_math=False)
    grid[-1].set_xlabel(shown(across), parse_math=False)
    return page


def _panels(numbers: Sequence[Number]) -> list[list[Number]]:
    """Groups of numbers that are drawn on the same axis."""

    def kind(path: tuple[str, ...]) -> tuple[str, ...]:
        if len(path) < 3:
            # The wheels of an axle share an axis.
            return (*path[:-1], path[-1].rpartition(".")[2])
        # The components of a position differ much: on one axis their changes would not be visible.
        return (path[0], path[2]) if path[0] == PLACE else path[:1]

    return [*gathered(((*kind(number.path), number.unit), number) for number in numbers).values()]


def _draw(axes: Axes, curves: Curves, values: Values, size: tuple[float, float]) -> None:
    for set_limits, numbers in ((axes.set_xlim, curves.across), (axes.set_ylim, curves.up)):
        every = np.concatenate([values(number).ravel() for number in numbers])
        known = every[np.isfinite(every)]
        if known.size and np.ptp(known) <= STILL * max(float(np.abs(known).max()), 1.0):
            middle = float(np.median(known))
            reach = max(0.1 * abs(middle), 0.1)
            set_limits(middle - reach, middle + reach)
    several = len(curves.across) > 1 or len(curves.up) > 1
    for i, (across, up) in enumerate(curves.pairs):
        axes.plot(
            values(across),
            values(up),
            color=COLOURS[i % len(COLOURS)],
            linestyle=STYLES[i % len(STYLES)] if several else "-",
            linewidth=1.4,
            label=(across if len(curves.across) > 1 else up).called,
        )
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(nbins=6)
    wide, high = (int(side / LETTER) for side in size)
    axes.set_xlabel(_label(curves.across, wide))
    axes.set_ylabel(_label(curves.up, high))
    if several:
        axes.legend(fontsize=7.0, framealpha=0.8, edgecolor=FAINT)


def _label(numbers: Sequence[Number], letters: int) -> str:
    """The label of an axis: number, unit and positive direction; several numbers are named in the legend."""
    first, signs = numbers[0], list(dict.fromkeys(f"{n.mark} {n.sign}" for n in numbers if n.sign))
    words = f"{first.words} " if len(numbers) == 1 else ""
    positive = "; ".join(dict.fromkeys(f"{n.mark}{n.called} {n.sign}" for n in numbers if n.sign))
    if len(signs) == 1:
        positive = signs[0]
    return "\n".join(fill(line, letters) for line in (f"{words}[{first.unit_shown}]", positive) if line)
