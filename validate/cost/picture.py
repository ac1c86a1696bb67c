"""The picture of a report: error of positions against time, with a line for each method."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from validate.cost.findings import ACCURACIES, heights, timed, unit_of, words_of
from validate.cost.looks import KEY, looks
from validate.cost.way import power
from validate.output.figure import GREY, LOOK, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@LOOK
def headline(table: pd.DataFrame) -> Figure | None:
    """Error of positions against time, for the first measured scene; None if nothing was measured."""
    here = timed(table)
    here = here[here.quantity == "position"]
    if here.empty:
        return None
    here = here[here.scene == here.scene.iloc[0]]
    title = f"{here.scene.iloc[0]}: largest error against time of a pose, {here.poses.max()} poses a run"
    page, (axes,) = panels((7.0, 5.0), title, 1, 1)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.minorticks_off()
    errors, nothing = heights(here.error)
    for way, look in looks(here.way).items():
        line = here[here.way == way].sort_values("value", ascending=False)
        # If one solve serves any instant, markers are filled and the name has a star.
        dense = bool(line.dense.any())
        axes.plot(
            1e6 * line.time,
            errors[line.index],
            label=f"{way}*" if dense else way,
            color=look.colour,
            marker=look.marker,
            markersize=5.5,
            markerfacecolor=look.colour if dense else "white",
            markeredgewidth=1.1,
            linewidth=1.3,
            linestyle=(0, look.dash) if look.dash else "-",
            zorder=3,
        )
    for accuracy in ACCURACIES:
        axes.axhline(accuracy, color=GREY, linewidth=0.8, zorder=1)
    axes.set_title(words_of("position") + nothing, loc="left")
    axes.set_xlabel("time of a pose, us")
    axes.set_ylabel(f"largest error, {unit_of('position')}")
    key = f"{KEY.replace('. ', '.' + chr(10))} Grey: {', '.join(map(power, ACCURACIES))}; without the set-up."
    legend = page.legend(
        loc="outside lower left", ncols=4, frameon=False, fontsize=7.5, title=key, title_fontsize=7.5
    )
    legend.set_alignment("left")
    return page
