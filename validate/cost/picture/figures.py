"""The pictures of a report: error against time of each scene, and how time and memory grow."""

from __future__ import annotations

import math
from collections.abc import Iterator

import matplotlib as mpl
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validate.cost.findings import ACCURACIES, growths, quantities_of, timed, unit_of, words_of
from validate.cost.looks import looks
from validate.cost.picture.look import GREY, SETTINGS, plain, style

COLUMNS, WIDE, HIGH = 3, 3.7, 3.6  # of panels; inches of each
KEY = (
    "A line is a way, a mark one of its settings. Down is more accurate, left is quicker.\n"
    "* and filled: one solve serves any instant. Grey lines: 1e-3, 1e-6 and 1e-9. Set-up is apart."
)
BELOW = 10.0  # an error of exactly nothing is drawn so far below the least one


def headline(table: pd.DataFrame) -> Figure | None:
    """Error of positions against time, of the scene that is measured first."""
    found = timed(table, "accuracy")
    found = found[found.quantity == "position"]
    if found.empty:
        return None
    return _errors(found[found.scene == found.scene.iloc[0]], ["position"])


def figures(table: pd.DataFrame) -> Iterator[tuple[str, Figure]]:
    """All pictures by name, the headline first."""
    first = headline(table)
    if first is not None:
        yield "headline", first
    for scene, here in timed(table, "accuracy").groupby("scene", sort=False):
        yield f"error-time-{scene}", _errors(here, quantities_of(here))
    found = timed(table, "growth")
    for (against, scene), here in found.groupby(["against", "scene"], sort=False):
        yield f"growth-{against}-{scene}", _growth(growths(here), here, against, scene)


@mpl.rc_context(SETTINGS)
def _errors(here: pd.DataFrame, quantities: list[str]) -> Figure:
    """A panel for each quantity, a line for each way."""
    title = f"{here.scene.iloc[0]}: largest error against time of a pose, {here.poses.max()} poses a run"
    page, panels = _page(title, len(quantities))
    for axes, quantity in zip(panels, quantities, strict=False):
        some = here[here.quantity == quantity]
        least = some.error[some.error > 0.0].min()
        floor = (1e-16 if math.isnan(least) else least) / BELOW
        for way, look in looks(some.way).items():
            line = some[some.way == way].sort_values("value", ascending=False)
            heights = line.error.clip(lower=floor)
            axes.plot(1e6 * line.time, heights, zorder=3, **style(look, bool(line.dense.any())))
        for accuracy in ACCURACIES:
            axes.axhline(accuracy, color=GREY, linewidth=0.8, zorder=1)
        nothing = "; exactly 0 at the lower edge" if (some.error == 0.0).any() else ""
        axes.set_title(words_of(quantity) + nothing, loc="left")
        axes.set_xlabel("time of a pose, us")
        axes.set_ylabel(f"largest error, {unit_of(quantity)}")
    _legend(page, here, KEY)
    return page


@mpl.rc_context(SETTINGS)
def _growth(fits: pd.DataFrame, here: pd.DataFrame, against: str, scene: str) -> Figure:
    """Time and memory of a run, a line for each way, with its exponent."""
    page, panels = _page(f"{scene}: growth in {against}", 2)
    for axes, (of, unit, words) in zip(
        panels, (("time", 1.0, "time of a run, s"), ("memory", 1e-6, "peak of memory, MB")), strict=False
    ):
        for one in fits[fits.of == of].itertuples():
            line = here[(here.way == one.way) & (here.setting == one.setting)]
            line = line.sort_values("size").drop_duplicates("size", keep="last")
            run = line.time * line.poses.astype(float) + (0.0 if against == "instants" else line.set_up)
            values = run if of == "time" else line.peak_bytes.astype(float)
            look = looks([one.way])[one.way]
            axes.plot(line["size"].astype(float), unit * values, **style(look, bool(line.dense.any())))
            power = "" if pd.isna(one.exponent) else f" {one.exponent:.2f}"
            end = (float(line["size"].iloc[-1]), unit * float(values.iloc[-1]))
            axes.annotate(power, end, fontsize=7, color=look.colour)
        axes.set_title(of, loc="left")
        axes.set_xlabel(against)
        axes.set_ylabel(words)
    _legend(page, here, "Beside a line: the exponent p of value = factor x size^p, of the largest sizes.")
    return page


def _page(title: str, panels: int) -> tuple[Figure, list[Axes]]:
    """A page of panels with logarithmic axes."""
    columns = min(panels, COLUMNS)
    rows = -(-panels // columns)
    size = (max(columns * WIDE, 1.5 * WIDE), rows * HIGH + 1.3)
    page = Figure(figsize=size, layout="constrained")
    page.suptitle(title, x=0.01, ha="left", fontsize=11)
    found = [page.add_subplot(rows, columns, i + 1) for i in range(panels)]
    for axes in found:
        axes.set_xscale("log")
        axes.set_yscale("log")
        plain(axes)
    return page, found


def _legend(page: Figure, here: pd.DataFrame, key: str) -> None:
    """The ways below the panels, and how to read them."""
    dense = {way for way, some in here.groupby("way") if some.dense.any()}
    entries = [
        Line2D([], [], label=f"{way}*" if way in dense else way, **style(look, way in dense))
        for way, look in looks(here.way).items()
    ]
    columns = max(int(page.get_figwidth() / 1.5), 2)
    page.legend(
        handles=entries,
        loc="outside lower left",
        ncols=columns,
        frameon=False,
        fontsize=7.5,
        title=key,
        title_fontsize=7.5,
    ).set_alignment("left")
