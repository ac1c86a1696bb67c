"""The tables of a report, as queries on the long table."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pandas as pd

from validate.cost.findings import ACCURACIES, cheapest, growths, quantities_of, timed, unit_of, words_of
from validate.cost.words import BYTES, SECONDS, duration, in_units, power
from validate.output.table import Table

KEY = "*: one solve serves any instant; in brackets: the setting"


def tables_of(table: pd.DataFrame, quantities: tuple[str, ...] = ()) -> list[Table]:
    """All of them.

    Args:
        quantities: whose times to an accuracy are shown; all if none is given.
    """
    return [*_reached(table, quantities), *_growths(table), *_without_numbers(table)]


def _table(caption: str, head: tuple[str, ...], rows: Any) -> Table:
    return Table(head, tuple(map(tuple, rows)), caption=caption)


def _named(one: Any) -> str:
    return f"{one.way} {one.setting}".strip()


def _reached(table: pd.DataFrame, quantities: tuple[str, ...]) -> Iterator[Table]:
    """Time of a pose by the cheapest setting that reaches an accuracy, the quickest first."""
    best = cheapest(table)
    for scene, here in timed(table, "accuracy").groupby("scene", sort=False):
        for quantity in quantities_of(here):
            if quantities and quantity not in quantities:
                continue
            these = here[here.quantity == quantity]
            near = best[(best.scene == scene) & (best.quantity == quantity)]
            lines = []
            for way, line in these.groupby("way", sort=False):
                mine = {one.accuracy: one for one in near[near.way == way].itertuples()}
                order = [mine[a].time if a in mine else float("inf") for a in reversed(ACCURACIES)]
                ends = (f"{line.error.min():.1e}", duration(line.set_up.min()))
                name = f"{way}*" if line.dense.any() else way
                lines.append((order, (name, *(_reach(mine.get(a)) for a in ACCURACIES), *ends)))
            unit = unit_of(quantity)
            yield _table(
                f"{scene}: time of a pose to an accuracy of {words_of(quantity)}, by the cheapest setting; "
                f"{these.poses.max()} poses a run, reference to {these.radius.max():.0e} {unit}",
                ("way", *(f"{power(a)} {unit}" for a in ACCURACIES), f"floor, {unit}", "set-up"),
                (cells for _, cells in sorted(lines, key=lambda line: line[0])),
            )


def _reach(one: Any) -> str:
    """The time of a row, with its setting; None where no row is there."""
    if one is None:
        return "not reached"
    return duration(one.time) + ("" if pd.isna(one.value) else f" ({power(one.value)})")


def _growths(table: pd.DataFrame) -> Iterator[Table]:
    """Fitted exponents of time and memory, a table for each thing that is varied and each scene."""
    for (against, scene), here in growths(table).groupby(["against", "scene"], sort=False):
        lines = []
        for one in here.itertuples():
            units = SECONDS if one.of == "time" else BYTES
            fit = "-" if pd.isna(one.exponent) else f"{one.exponent:.2f}"
            fit += "" if pd.isna(one.error) else f" +- {one.error:.2f}"
            each = in_units(one.value / one.largest, units)
            lines.append((_named(one), one.of, fit, f"{one.largest:g}", in_units(one.value, units), each))
        yield _table(
            f"Growth in {against} of {scene}: value = factor x size^exponent, of the largest sizes",
            ("way and setting", "of", "exponent", "largest", "takes", "each"),
            lines,
        )


def _without_numbers(table: pd.DataFrame) -> Iterator[Table]:
    """What failed or was left out: each reason with its runs."""
    here = table[table.verdict != "measured"]
    by = ["scene", "way", "verdict", "reason"]
    lines = []
    for (scene, way, verdict, reason), some in here.groupby(by, sort=False):
        grew = some[some.against != ""]
        sizes = [f"{size} {against}" for size, against in zip(grew["size"], grew.against, strict=True)]
        what = dict.fromkeys([*some.setting, *map(words_of, some.quantity), *sizes])
        where = ", ".join(filter(None, what))
        lines.append((f"{scene} {way}".strip(), verdict, ": ".join(filter(None, (where, reason)))))
    if lines:
        yield _table("Without numbers", ("what", "verdict", "where"), lines)
