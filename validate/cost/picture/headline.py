"""The small picture for a first page: error against time of one scene, and time against instants."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.figure import Figure

from validate.cost.findings import Findings, accuracy_rows, scenes_of, words_of
from validate.cost.picture import error_time, growing
from validate.cost.picture.look import SETTINGS, handles
from validate.cost.row import Row

SCENE = "bounce"
QUANTITIES = ("position", "acceleration")
WIDE, HIGH, LEFT, RIGHT, TOP, BELOW = 2.55, 2.5, 0.7, 0.95, 0.35, 0.75  # inches
ENTRY, LINE = 1.7, 0.17  # inches, of the legend
KEY = (
    "* and filled: one solve serves any instant. Down is more accurate, left is quicker. "
    "Dotted: a way's floor."
)


def figure(rows: Sequence[Row], found: Findings) -> Figure | None:
    """Error against time for two quantities, and growth in instants if measured; None of no rows."""
    accuracy = accuracy_rows(rows)
    scenes = scenes_of(accuracy)
    if not scenes:
        return None
    scene = SCENE if SCENE in scenes else scenes[0]
    here = [row for row in accuracy if row.scene == scene]
    quantities = [q for q in QUANTITIES if any(q in row.errors for row in here)]
    grown = [g for g in found.growths if (g.against, g.of) == ("instants", "time") and g.points]
    grown = [g for g in grown if g.scene == grown[0].scene]
    count = len(quantities) + bool(grown)
    if not count:
        return None
    ways = handles((row.way, row.dense) for row in here if row.status == "measured")
    cell = LEFT + WIDE
    wide = count * cell + (RIGHT if grown else 0.2)
    columns = max(int(wide / ENTRY), 1)
    below = BELOW + LINE * -(-len(ways) // columns)
    high = TOP + HIGH + below
    with mpl.rc_context(SETTINGS):
        page = Figure(figsize=(wide, high))
        places = [
            ((LEFT + i * cell) / wide, below / high, (WIDE - 0.05) / wide, HIGH / high) for i in range(count)
        ]
        for place, quantity in zip(places, quantities, strict=False):
            axes = page.add_axes(place)
            error_time.panel(axes, here, quantity)
            axes.set_title(f"{scene}: {words_of(quantity)}", loc="left")
        if grown:
            axes = page.add_axes(places[-1])
            growing.panel(axes, grown, frozenset(row.way for row in rows if row.dense), small=True)
            axes.set_title(f"{grown[0].scene}: growth in instants", loc="left")
        page.legend(
            handles=ways,
            loc="lower left",
            bbox_to_anchor=(0.1 / wide, 0.22 / high),
            ncols=columns,
            frameon=False,
            fontsize=7.5,
            handlelength=3.0,
            columnspacing=1.4,
            borderpad=0.0,
        )
        page.text(0.15 / wide, 0.08 / high, KEY, fontsize=7.5, va="bottom")
    return page
