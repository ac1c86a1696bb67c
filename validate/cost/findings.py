"""Findings from the table of measurements: queries, and three sentences that summarise them.

Three rules keep the comparison fair. A method takes part in the race for an accuracy only with settings whose
largest error plus the reference's radius is at or below this accuracy: a wrong number never wins. Times whose
quartiles overlap are a tie. Nothing is averaged over quantities, scenes or methods.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np
import pandas as pd

from pointcoord.effects.registry import QUANTITIES
from validate.cost.way import power
from validate.cost.ways.registry import OURS

ACCURACIES = (1e-3, 1e-6, 1e-9)
"""The accuracies of the races, in the unit of each quantity, such as mm for positions."""
LISTED = 6  # largest number of methods that a sentence names


def unit_of(quantity: str) -> str:
    """The unit of a quantity's numbers."""
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else ""


def words_of(quantity: str) -> str:
    """The name of a quantity in words."""
    return QUANTITIES[quantity].words if quantity in QUANTITIES else quantity


def duration(seconds: float) -> str:
    """A time with three digits and a suitable unit, such as 14.3 us."""
    units = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
    name = next((name for name, size in units.items() if seconds >= 0.9995 * size), "ns")
    return f"{float(f'{seconds / units[name]:.3g}'):g} {name}"


def timed(table: pd.DataFrame) -> pd.DataFrame:
    """The measured rows, which have a time and an error."""
    return table[(table.verdict == "measured") & table.time.notna() & table.error.notna()]


def heights(errors: pd.Series) -> tuple[pd.Series, str]:
    """Errors for a logarithmic axis, with zero drawn at a tenth of the least error, and a remark on it."""
    least = errors[errors > 0.0].min()
    drawn = errors.clip(lower=(1e-16 if math.isnan(least) else least) / 10.0)
    return drawn, ", exactly 0 at the lower edge" if (errors == 0.0).any() else ""


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """The fastest setting that is accurate enough, by scene, quantity, method and accuracy."""
    found = timed(table)
    near = pd.concat([found[found.error + found.radius <= a].assign(accuracy=a) for a in ACCURACIES])
    near = near.sort_values("time", kind="stable")
    return near.drop_duplicates(["scene", "quantity", "way", "accuracy"])


def races(table: pd.DataFrame) -> pd.DataFrame:
    """By scene, quantity and accuracy: the fastest of pointcoord's methods against the fastest other."""
    best, asked = cheapest(table), timed(table).groupby(["scene", "quantity"], sort=False)
    lines = []
    for (scene, quantity), accuracy in product(asked.groups, ACCURACIES):
        here = best[(best.scene == scene) & (best.quantity == quantity) & (best.accuracy == accuracy)]
        sides = here[here.way.isin(OURS)], here[~here.way.isin(OURS)]
        one, other = (next(side.itertuples(), None) for side in sides)
        verdict, ratio = "nobody", None
        if one and other:
            apart = one.upper < other.lower or other.upper < one.lower
            verdict = "tie" if not apart else "ours" if one.time < other.time else "other"
            ratio = other.time / one.time
        elif one or other:
            verdict = "only ours" if one else "only others"
        names = (side.way if side else None for side in (one, other))
        reached = here[["way", "setting", "time"]].to_dict("records")
        lines.append((scene, quantity, accuracy, verdict, *names, ratio, reached))
    columns = ["scene", "quantity", "accuracy", "verdict", "ours", "other", "ratio", "reached"]
    return pd.DataFrame(lines, columns=columns)


def sentences(table: pd.DataFrame) -> list[str]:
    """Three sentences: the fastest methods, the cost of further digits, and the races that others win."""
    return [line for line in (_quickest(table), _digits(table), _won(table)) if line]


def _quickest(table: pd.DataFrame) -> str:
    best, asked = cheapest(table), timed(table)
    finest = best[(best.quantity == "position") & (best.accuracy == ACCURACIES[-1])]
    times = finest.groupby("way").time.agg(["median", "min", "max"]).sort_values("median")
    if times.empty:
        return ""
    spans = [f"{one.Index} {_span(one.min, one.max, duration)}" for one in times[:LISTED].itertuples()]
    missed = [w for w in asked[asked.quantity == "position"].way.unique() if w not in times.index]
    made = finest[finest.way == "map"].set_up
    return (
        f"To solve a pose to {power(ACCURACIES[-1])} mm, the fastest of {len(times)} methods take "
        f"{', '.join(spans)}"
        + (f"; the map is made once, in {_span(made.min(), made.max(), duration)}" if len(made) else "")
        + (f"; not reached by {', '.join(missed)}" if missed else "")
        + "."
    )


def _digits(table: pd.DataFrame) -> str:
    found = timed(table)
    found = found[(found.quantity == "position") & found.value.notna()].sort_values("value")
    ends = found.groupby(["scene", "way"], sort=False).agg(["first", "last"])
    ends = ends[ends.value["first"] < ends.value["last"]]
    if ends.empty:
        return ""
    digits = np.log10(ends.value["last"] / ends.value["first"]).max()
    times = (ends.time["first"] / ends.time["last"]).rename("times").reset_index()
    who = times.way.where(times.way.isin(OURS), "other methods")
    spans = times.groupby(who, sort=False).times.agg(["min", "max"])
    ratios = [f"{one.Index} {_span(one.min, one.max, '{:.2g}'.format)}" for one in spans.itertuples()]
    return (
        f"Time of a pose with the finest setting over that with the coarsest, {digits:.0f} digits apart: "
        f"{', '.join(ratios)}."
    )


def _won(table: pd.DataFrame) -> str:
    found, without = races(table), races(table[table.way != "map"])
    if found.empty:
        return ""
    lost = found[found.verdict.isin(["other", "only others"])]
    counts = found.verdict.value_counts()
    winners = f" ({', '.join(lost.other.value_counts().index[:LISTED])})" if len(lost) else ""
    unmade = int(without.verdict.isin(["other", "only others"]).sum())
    return (
        f"Of {len(found)} races, one for each scene, quantity and accuracy of "
        f"{', '.join(map(power, ACCURACIES))}, methods other than pointcoord's win {len(lost)}{winners}, or "
        f"{unmade} without the map, whose making is not counted; {counts.get('tie', 0)} are ties; in "
        f"{counts.get('nobody', 0)} no method reaches the accuracy."
    )


def _span(least: float, largest: float, words: Callable[[float], str]) -> str:
    return " to ".join(dict.fromkeys(map(words, (least, largest))))
