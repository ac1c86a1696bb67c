"""Error against time a configuration, of one scene: a panel for each quantity, a line for each way."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import fill

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter
from matplotlib.transforms import blended_transform_factory

from validate.cost.findings import ACCURACIES, a_configuration, phases, quantities_of, unit_of, words_of
from validate.cost.looks import looks
from validate.cost.picture.look import GREY, INK, SETTINGS, handles, plain, short, style
from validate.cost.row import Row
from validate.cost.tables import SHORT

COLUMNS = 3
WIDE, HIGH = 3.1, 2.9  # inches, of a panel
LEFT, BETWEEN, RIGHT, TOP, BELOW = 0.75, 0.85, 0.25, 0.7, 0.95
STRIP = 0.08  # of a panel's height, at its foot, for errors that are exactly 0
KEY = """\
A line is a way, a point one of its settings.
Down is more accurate, left is quicker.
* and filled: one solve serves any instant.
Hollow: every instant is solved.
Dotted: the floor of a way that is dialled.
Grey lines: 1e-3, 1e-6 and 1e-9.
Time: from instants to arrays, without set-up;
of rates, what they take beside positions too."""


@dataclass(frozen=True)
class Point:
    """One setting of a way: time in us, largest error, and whether one solve serves any instant."""

    time: float
    error: float
    dense: bool


def figure(here: Sequence[Row]) -> Figure:
    """Of one scene's rows of the accuracy."""
    quantities = [quantity for quantity in quantities_of(here) if quantity in SHORT]
    rows = -(-(len(quantities) + 1) // COLUMNS)
    wide = LEFT + COLUMNS * WIDE + (COLUMNS - 1) * BETWEEN + RIGHT
    high = rows * (TOP + HIGH + BELOW) - 0.1
    configurations = sorted({row.configurations for row in here if row.status == "measured"})
    with mpl.rc_context(SETTINGS):
        page = Figure(figsize=(wide, high))
        title = f"{here[0].scene}: error against time a configuration"
        if configurations:
            title += f", {' or '.join(map(str, configurations))} configurations a solve"
        page.text(0.15 / wide, 1.0 - 0.2 / high, title, fontsize=12, va="top")

        def place(cell: int) -> tuple[float, float, float, float]:
            left = LEFT + (cell % COLUMNS) * (WIDE + BETWEEN)
            top = TOP + (cell // COLUMNS) * (TOP + HIGH + BELOW - 0.15)
            return left / wide, 1.0 - (top + HIGH) / high, WIDE / wide, HIGH / high

        for cell, quantity in enumerate(quantities):
            axes = page.add_axes(place(cell))
            panel(axes, here, quantity)
            _note(axes, here, quantity)
        legend = page.add_axes(place(len(quantities)))
        legend.axis("off")
        legend.legend(
            handles=handles((row.way, row.dense) for row in here if row.status == "measured"),
            loc="upper left",
            bbox_to_anchor=(-0.1, 1.08),
            ncols=2,
            frameon=False,
            fontsize=8.5,
            handlelength=3.2,
            columnspacing=1.2,
            borderpad=0.0,
        )
        legend.text(-0.08, -0.25, KEY, fontsize=8, va="bottom", transform=legend.transAxes, linespacing=1.45)
    return page


def panel(axes: Axes, here: Sequence[Row], quantity: str) -> None:
    """One quantity: each way's settings joined in the order in which they are dialled."""
    ways = _points(here, quantity)
    every = [point for points in ways.values() for point in points]
    radius = max((row.errors[quantity].radius for row in here if quantity in row.errors), default=0.0)
    plain(axes)
    axes.set_title(words_of(quantity), loc="left")
    axes.set_xlabel("time a configuration, us", labelpad=2)
    axes.set_ylabel(f"largest error, {unit_of(quantity)}")
    low, high = _decades([p.error for p in every if p.error > 0.0], radius)
    zeros = any(point.error == 0.0 for point in every)
    foot = low / (high / low) ** (STRIP / (1.0 - STRIP)) if zeros else low
    middle = math.sqrt(foot * low)
    _scale(axes, [p.time for p in every], foot, low, high)
    for accuracy in ACCURACIES:
        if low < accuracy < high:
            axes.axhline(accuracy, color=GREY, linewidth=0.8, zorder=1)
    for way, look in looks(ways).items():
        points = ways[way]
        options = style(look, any(point.dense for point in points))
        # A line is broken by an exact zero, which has no place on it.
        heights = [point.error or math.nan for point in points]
        axes.plot([point.time for point in points], heights, zorder=3, **options)
        nothing = [point.time for point in points if point.error == 0.0]
        if nothing:
            at_foot = {**options, "linestyle": "none", "clip_on": False}
            axes.plot(nothing, [middle] * len(nothing), zorder=4, **at_foot)
        dialled = [point for point in points if point.error > 0.0]
        if len(dialled) > 2:
            floor = min(dialled, key=lambda point: point.error)
            right = axes.get_xlim()[1]
            axes.hlines(floor.error, floor.time, right, colors=look.colour, linestyles=":", linewidth=1.1)
    across = blended_transform_factory(axes.transAxes, axes.transData)
    if zeros:
        axes.axhspan(foot, low, color="#eeeeee", zorder=0)
        axes.text(0.015, middle, "exactly 0", transform=across, va="center", color=INK, fontsize=7)
    if radius >= low:
        axes.axhline(radius, color=INK, linewidth=1.1, linestyle="-.", zorder=2)
        axes.text(0.015, radius, "reference's own radius", transform=across, va="bottom", fontsize=7)


def _decades(errors: Sequence[float], radius: float) -> tuple[float, float]:
    """Whole decades that hold all errors, the accuracies, and the reference's radius if it is near them."""
    low, high = min(errors, default=1e-15), max([*errors, ACCURACIES[0]])
    if radius > 1e-3 * low:
        low = min(low, radius)
    return 10.0 ** math.floor(math.log10(low) - 0.3), 10.0 ** math.ceil(math.log10(high) + 0.1)


def _scale(axes: Axes, times: Sequence[float], foot: float, low: float, high: float) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    shortest, longest = min(times, default=1.0), max(times, default=100.0)
    left, right = shortest / 1.6, longest * 1.6
    axes.set_xlim(left, right)
    axes.set_ylim(foot, high)
    decades = range(math.floor(math.log10(left)), math.ceil(math.log10(right)) + 1)
    steps = (1.0, 2.0, 5.0) if right / left < 300.0 else (1.0,)
    ticks = [step * 10.0**k for k in decades for step in steps if left <= step * 10.0**k <= right]
    axes.xaxis.set_major_locator(FixedLocator(ticks))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    first, last = round(math.log10(low)), round(math.log10(high))
    # Thirds, so that the accuracies that are raced for have a number.
    every = 3 if last - first > 5 else 1
    axes.yaxis.set_major_locator(FixedLocator([10.0**k for k in range(first, last + 1) if k % every == 0]))
    axes.minorticks_off()


def _note(axes: Axes, here: Sequence[Row], quantity: str) -> None:
    """Below a panel: who is not in it, and how good the reference is."""
    radius = max((row.errors[quantity].radius for row in here if quantity in row.errors), default=0.0)
    lines = [*absent(here, quantity), f"reference's own radius: {radius:.0e} {unit_of(quantity)}"]
    text = "\n".join(fill(line, 58, subsequent_indent="  ", break_on_hyphens=False) for line in lines)
    axes.text(-0.12, -0.145, text, transform=axes.transAxes, va="top", fontsize=7, linespacing=1.3)


def _points(here: Sequence[Row], quantity: str) -> dict[str, list[Point]]:
    """By way, the coarsest setting first; what is no number is told of below the panel."""
    points: dict[str, list[Point]] = {}
    for row in here:
        error = row.errors.get(quantity)
        time = a_configuration(row, phases(quantity))
        if error is not None and time is not None and math.isfinite(error.largest):
            points.setdefault(row.way, []).append(Point(time.median * 1e6, error.largest, row.dense))
    return points


def absent(here: Sequence[Row], quantity: str) -> list[str]:
    """Ways that have no point, or fewer points than settings, by what became of them."""
    kinds: dict[str, dict[str, list[Row]]] = {}
    for row in here:
        kind = _kind(row, quantity)
        if kind:
            kinds.setdefault(kind, {}).setdefault(row.way, []).append(row)
    told = []
    for kind, ways in kinds.items():
        names = []
        for way, rows in ways.items():
            if len(rows) == sum(row.way == way for row in here):
                names.append(way)
            else:
                names += [f"{way} {row.setting}".strip() for row in rows]
        told.append(f"{kind}: {', '.join(names)}")
    return told


def _kind(row: Row, quantity: str) -> str:
    error = row.errors.get(quantity)
    if row.status != "measured":
        return str(row.status)
    if error is None:
        return "not given"
    if not math.isfinite(error.largest):
        return "not a number"
    return "" if a_configuration(row, phases(quantity)) else "without a time"
