"""How time and memory grow: a picture for each thing that is varied, with the fitted exponents."""

from __future__ import annotations

import math
from collections.abc import Sequence
from textwrap import fill

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter
from matplotlib.transforms import blended_transform_factory

from validate.cost.findings import Fit, Growth
from validate.cost.looks import Look, looks
from validate.cost.picture.look import GREY, SETTINGS, plain, short, spread, style

LABEL = 0.055  # of a panel's height, from label to label
WIDE, HIGH, LEFT, RIGHT = 3.3, 3.1, 0.8, 0.35  # inches: of a panel, and beside it
LETTER = 0.062  # inches, of a label
UNITS = {"time": ("time of a run, s", 1.0), "memory": ("peak above what was held before, MB", 1e-6)}
KEY = (
    "Beside a line: the exponent p of value = factor x size^p, fitted to the largest sizes (broken line), "
    "with its standard error. * and filled: one solve serves any instant."
)


def figure(growths: Sequence[Growth], dense: frozenset[str]) -> Figure:
    """Of one scene against one thing; `dense` are the ways whose one solve serves any instant."""
    against = growths[0].against
    kinds = [kind for kind in UNITS if any(g.of == kind and g.points for g in growths)]
    stopped = dict.fromkeys(
        f"x  {f'{g.way} {g.setting}'.strip()} at {size:g} {against}: {reason}"
        for g in growths
        for size, reason in g.stopped
    )
    letters = max((len(_name(g, growths, dense) + _exponent(g.fit)) for g in growths), default=0)
    cell = LEFT + WIDE + RIGHT + LETTER * letters
    wide = cell * max(len(kinds), 1)
    notes = "\n".join(fill(note, int(17 * wide), subsequent_indent="  ") for note in (KEY, *stopped))
    foot = 0.7 + 0.145 * (notes.count("\n") + 1)
    high = 0.75 + HIGH + foot
    with mpl.rc_context(SETTINGS):
        page = Figure(figsize=(wide, high))
        title = f"Growth in {against}: {growths[0].scene}"
        page.text(0.15 / wide, 1.0 - 0.15 / high, title, fontsize=12, va="top")
        for i, kind in enumerate(kinds):
            left = LEFT + i * cell
            axes = page.add_axes((left / wide, foot / high, WIDE / wide, HIGH / high))
            panel(axes, [g for g in growths if g.of == kind], dense)
        page.text(0.15 / wide, 0.08 / high, notes, fontsize=7, va="bottom", linespacing=1.3)
    return page


def panel(axes: Axes, growths: Sequence[Growth], dense: frozenset[str], small: bool = False) -> None:
    """One of time and memory: points, fitted lines, and a label at the end of each.

    A small one has neither exponents nor marks of what was not measured, which its picture does not explain.
    """
    of, against = growths[0].of, growths[0].against
    words, unit = UNITS[of]
    plain(axes)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_title(of, loc="left")
    axes.set_xlabel(against, labelpad=2)
    axes.set_ylabel(words)
    found = looks(g.way for g in growths)
    ends = []
    for growth in growths:
        if not growth.points:
            continue
        look = found[growth.way]
        sizes = [size for size, _ in growth.points]
        values = [value * unit for _, value in growth.points]
        axes.plot(sizes, values, zorder=3, **{**style(look, growth.way in dense), "linestyle": "none"})
        axes.plot(sizes, values, "-", color=look.colour, linewidth=0.6, alpha=0.6, zorder=2)
        if growth.fit is not None:
            reach = np.array([growth.fit.smallest, growth.fit.largest])
            law = [growth.fit.at(size) * unit for size in reach]
            axes.plot(reach, law, "--", color=look.colour, linewidth=1.2, zorder=2)
        name = _name(growth, growths, dense) + ("" if small else _exponent(growth.fit))
        ends.append((sizes[-1], values[-1], look, name))
    axes.xaxis.set_major_locator(FixedLocator(sorted({size for g in growths for size, _ in g.points})))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda size, _: short(size)))
    axes.minorticks_off()
    _label(axes, ends)
    if not small:
        _mark_stops(axes, growths)


def _name(growth: Growth, growths: Sequence[Growth], dense: frozenset[str]) -> str:
    """A way, with its setting where there is another one of it."""
    several = len({g.setting for g in growths if g.way == growth.way}) > 1
    return growth.way + ("*" if growth.way in dense else "") + (f" {growth.setting}" if several else "")


def _exponent(fit: Fit | None) -> str:
    if fit is None:
        return ""
    return f"  p = {fit.exponent:.2f}" + (f" \u00b1 {fit.error:.2f}" if fit.error is not None else "")


def _label(axes: Axes, ends: Sequence[tuple[float, float, Look, str]]) -> None:
    """Names to the right of the panel at the height of the last points, moved apart, with leaders."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    heights = [math.log(value / low) / math.log(high / low) for _, value, _, _ in ends]
    for (size, _, look, text), height, moved in zip(ends, heights, spread(heights, LABEL), strict=True):
        axes.annotate(
            text,
            (math.log(size / left) / math.log(right / left), height),
            xytext=(1.05, moved),
            xycoords="axes fraction",
            textcoords="axes fraction",
            va="center",
            fontsize=7.5,
            color=look.colour,
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": look.colour,
                "linewidth": 0.5,
                "alpha": 0.7,
                "shrinkB": 4,
                "relpos": (0.0, 0.5),
            },
        )


def _mark_stops(axes: Axes, growths: Sequence[Growth]) -> None:
    """A cross at the top for every size that gave no number; the notes below the picture say why."""
    if not any(growth.stopped for growth in growths):
        return
    across = blended_transform_factory(axes.transData, axes.transAxes)
    found = looks(g.way for g in growths)
    left, right = axes.get_xlim()
    shown = {(g.way, size) for g in growths for size, _ in g.stopped if left <= size <= right}
    crowd: dict[float, int] = {}
    for way, size in sorted(shown):
        level = 1.02 + 0.04 * crowd.setdefault(size, 0)
        crowd[size] += 1
        colour = found[way].colour
        axes.plot([size], [level], "x", color=colour, markersize=5, transform=across, clip_on=False)
    text = "x: not measured, see below"
    axes.text(1.05, 1.02, text, transform=axes.transAxes, color=GREY, fontsize=7, va="center")
