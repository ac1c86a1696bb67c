"""The pictures of a report: error against time of each scene, and how time and memory grow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd

from validate.cost.findings import (
    ACCURACIES,
    LINE,
    grown,
    growths,
    heights,
    quantities_of,
    timed,
    unit_of,
    words_of,
)
from validate.cost.looks import KEY, Look, looks
from validate.cost.words import power
from validate.extras import MissingPackage
from validate.output.figure import GREY, SETTINGS, plain

try:
    import matplotlib as mpl
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
except ImportError as error:
    raise MissingPackage("validate.cost.picture", error, "plot") from None

COLUMNS, WIDE, HIGH = 3, 3.7, 3.6  # of panels; inches of each


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
    for (against, scene), here in timed(table, "growth").groupby(["against", "scene"], sort=False):
        yield f"growth-{against}-{scene}", _growth(here, f"{scene}: growth in {against}")


@mpl.rc_context(SETTINGS)
def _errors(here: pd.DataFrame, quantities: list[str]) -> Figure:
    """A panel for each quantity, a line for each way."""
    title = f"{here.scene.iloc[0]}: largest error against time of a pose, {here.poses.max()} poses a run"
    page, panels = _page(title, len(quantities))
    for axes, quantity in zip(panels, quantities, strict=False):
        some = here[here.quantity == quantity]
        drawn, nothing = heights(some.error)
        for way, look in looks(some.way).items():
            line = some[some.way == way].sort_values("value", ascending=False)
            places = (1e6 * line.time, drawn[line.index])
            axes.plot(*places, zorder=3, **_style(look, bool(line.dense.any())))
        for accuracy in ACCURACIES:
            axes.axhline(accuracy, color=GREY, linewidth=0.8, zorder=1)
        axes.set_title(words_of(quantity) + nothing, loc="left")
        axes.set_xlabel("time of a pose, us")
        axes.set_ylabel(f"largest error, {unit_of(quantity)}")
    grey = f"Grey: {', '.join(map(power, ACCURACIES))}; the set-up is apart."
    _legend(page, here, KEY.replace(". ", ".\n") + f" {grey}")
    return page


@mpl.rc_context(SETTINGS)
def _growth(here: pd.DataFrame, title: str) -> Figure:
    """Time and memory of a run, a line for each way, with its exponent."""
    page, panels = _page(title, 2)
    values = grown(here).set_index([*LINE, "of"]).sort_index(kind="stable")
    labels = {"time": (1.0, "time of a run, s"), "memory": (1e-6, "peak of memory, MB")}
    for axes, (of, (unit, words)) in zip(panels, labels.items(), strict=False):
        for one in growths(here).query("of == @of").itertuples():
            line = values.loc[[(one.against, one.scene, one.way, one.setting, of)]]
            look = looks([one.way])[one.way]
            axes.plot(line["size"].astype(float), unit * line.value, **_style(look, bool(line.dense.any())))
            exponent = "" if pd.isna(one.exponent) else f" {one.exponent:.2f}"
            axes.annotate(exponent, (one.largest, unit * one.value), fontsize=7, color=look.colour)
        axes.set_title(of, loc="left")
        axes.set_xlabel(here.against.iloc[0])
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
        Line2D([], [], label=f"{way}*" if way in dense else way, **_style(look, way in dense))
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


def _style(look: Look, dense: bool) -> dict[str, Any]:
    """As matplotlib's options; markers are filled for a dense way, else hollow."""
    return {
        "color": look.colour,
        "marker": look.marker,
        "markersize": 5.5,
        "markerfacecolor": look.colour if dense else "white",
        "markeredgewidth": 1.1,
        "linewidth": 1.3,
        "linestyle": (0, look.dash) if look.dash else "-",
    }
