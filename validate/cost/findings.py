"""What the long table says: queries on it, and the three sentences of a reader who has no time.

Three rules keep it honest. A way is in a race for an accuracy only by a setting whose largest error, and the
reference's own radius on top of it, is at or below that accuracy: a wrong number is never quick. Times whose
quartiles overlap are a tie. Nothing is averaged over quantities, scenes or ways.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import asdict, fields
from itertools import product

import numpy as np
import pandas as pd
from scipy.stats import linregress

from pointcoord.effects.registry import QUANTITIES
from validate.cost.row import Row
from validate.cost.ways.registry import OURS
from validate.cost.words import duration, listed, power, span, times

ACCURACIES = (1e-3, 1e-6, 1e-9)
"""In the unit of each quantity: mm of positions."""
DECADES = 2.0  # below the largest size: an exponent is fitted where fixed costs have been left behind
LISTED = 6  # ways that a sentence names


def frame(rows: Iterable[Row]) -> pd.DataFrame:
    """Rows as a data frame; of what is not there, nothing."""
    columns = {field.name: str(field.type).removesuffix(" | None") for field in fields(Row)}
    kinds = {"Count": "Int64", "Size": "float64", "bool": "bool"}
    found = pd.DataFrame([asdict(row) for row in rows], columns=list(columns))
    return found.astype({name: kinds.get(kind, "str") for name, kind in columns.items()})


def unit_of(quantity: str) -> str:
    """The unit of a quantity's numbers."""
    return QUANTITIES[quantity].unit if quantity in QUANTITIES else ""


def words_of(quantity: str) -> str:
    """A quantity for people."""
    return QUANTITIES[quantity].words if quantity in QUANTITIES else quantity


def quantities_of(table: pd.DataFrame) -> list[str]:
    """Quantities that any row has an error of, in the order of the registry."""
    found = set(table[table.error.notna()].quantity)
    return [*(q for q in QUANTITIES if q in found), *sorted(found - QUANTITIES.keys())]


def timed(table: pd.DataFrame, part: str) -> pd.DataFrame:
    """The rows of a part that have a time; of what has errors, those with one."""
    found = table[(table.part == part) & (table.verdict == "measured") & table.time.notna()]
    return found[found.error.notna()] if part in ("accuracy", "unrelated") else found


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """By scene, quantity, way and accuracy the quickest setting that is accurate enough."""
    found = timed(table, "accuracy")
    entries = []
    for accuracy in ACCURACIES:
        near = found[found.error + found.radius <= accuracy]
        best = near.groupby(["scene", "quantity", "way"], sort=False).time.idxmin()
        entries.append(near.loc[best].assign(accuracy=accuracy))
    return pd.concat(entries)


def races(table: pd.DataFrame) -> pd.DataFrame:
    """Who is quicker to an accuracy: the quickest of our ways, or of the others; and all that reach it."""
    best, found = cheapest(table), timed(table, "accuracy")
    lines = []
    for (scene, quantity), accuracy in product(
        found.groupby(["scene", "quantity"], sort=False).groups, ACCURACIES
    ):
        here = best[(best.scene == scene) & (best.quantity == quantity) & (best.accuracy == accuracy)]
        here = here.sort_values("time")
        ours, others = here[here.way.isin(OURS)].head(1), here[~here.way.isin(OURS)].head(1)
        one, other = (next(side.itertuples(), None) for side in (ours, others))
        if one is None or other is None:
            verdict = "only ours" if one else "only others" if other else "nobody"
        elif one.upper < other.lower or other.upper < one.lower:
            verdict = "ours" if one.time < other.time else "other"
        else:
            verdict = "tie"
        lines.append(
            {
                "scene": scene,
                "quantity": quantity,
                "accuracy": accuracy,
                "verdict": verdict,
                "ours": one.way if one else None,
                "other": other.way if other else None,
                "ratio": other.time / one.time if one and other else None,
                "reached": here[["way", "setting", "time"]].to_dict("records"),
            }
        )
    return pd.DataFrame(
        lines, columns=["scene", "quantity", "accuracy", "verdict", "ours", "other", "ratio", "reached"]
    )


def growths(table: pd.DataFrame) -> pd.DataFrame:
    """How time (s a run) and memory (bytes) grow: value = factor x size^exponent, of the largest sizes.

    The exponent is the slope of the logarithms, with its standard error; None from fewer than three sizes.
    """
    found = timed(table, "growth").sort_values("size", kind="stable")
    found = found.drop_duplicates(["against", "scene", "way", "setting", "size"], keep="last")
    set_up = found.set_up.where(found.against != "instants", 0.0)
    lines = []
    for of, values in (
        ("time", found.time * found.poses.astype(float) + set_up),
        ("memory", found.peak_bytes),
    ):
        some = found.assign(value=values.astype(float))
        some = some[some.value > 0.0]
        for key, line in some.groupby(["against", "scene", "way", "setting"], sort=False):
            sizes, points = line["size"].to_numpy(float), line.value.to_numpy()
            large = sizes >= sizes[-1] * 10.0**-DECADES * (1.0 - 1e-9)
            large[-3:] = True
            fit = linregress(np.log(sizes[large]), np.log(points[large])) if len(sizes) > 1 else None
            lines.append(
                {
                    **dict(zip(("against", "scene", "way", "setting"), key, strict=True)),
                    "of": of,
                    "exponent": None if fit is None else float(fit.slope),
                    "error": float(fit.stderr) if fit is not None and large.sum() > 2 else None,
                    "largest": float(sizes[-1]),
                    "value": float(points[-1]),
                }
            )
    columns = ["against", "scene", "way", "setting", "of", "exponent", "error", "largest", "value"]
    return pd.DataFrame(lines, columns=columns)


def dials(table: pd.DataFrame) -> pd.DataFrame:
    """What the finest setting of each way costs: its time and its error over those of the coarsest."""
    found = timed(table, "accuracy")
    found = found[(found.quantity == "position") & found.value.notna()]
    lines = []
    for (scene, way), line in found.groupby(["scene", "way"], sort=False):
        line = line.sort_values("value")
        fine, coarse = line.iloc[0], line.iloc[-1]
        if fine.value < coarse.value:
            digits = math.log10(coarse.value / fine.value)
            lines.append({"scene": scene, "way": way, "digits": digits, "times": fine.time / coarse.time})
    return pd.DataFrame(lines, columns=["scene", "way", "digits", "times"])


def sentences(table: pd.DataFrame) -> list[str]:
    """Who is quickest, what digits cost, and where others win."""
    return [line for line in (_quickest(table), _digits(table), _races(table)) if line]


def _quickest(table: pd.DataFrame) -> str:
    best = cheapest(table)
    finest = best[(best.quantity == "position") & (best.accuracy == ACCURACIES[-1])]
    if finest.empty:
        return ""
    order = finest.groupby("way", sort=False).time.median().sort_values().index
    told = [f"{way} {span(finest[finest.way == way].time, duration)}" for way in order[:LISTED]]
    made = finest[finest.way == "map"].set_up
    if "map" in order[:LISTED]:
        place = list(order).index("map")
        told[place] += f" (once its map is made, which takes {span(made, duration)})"
    asked = timed(table, "accuracy")
    missed = [way for way in dict.fromkeys(asked[asked.quantity == "position"].way) if way not in set(order)]
    rest = f"; {listed(missed)} do not reach it" if missed else ""
    goal = f"{power(ACCURACIES[-1])} mm of position"
    return f"A pose to {goal} takes {listed(told)}, the quickest of {len(order)} ways{rest}."


def _digits(table: pd.DataFrame) -> str:
    found = dials(table)
    if found.empty:
        return ""
    ours = found[found.way.isin(OURS)]
    told = ", ".join(f"{way} {span(line.times, times)}" for way, line in ours.groupby("way", sort=False))
    others = found[~found.way.isin(OURS)].times
    more = f"; other ways {span(others, times)}" if len(others) else ""
    digits = span(found.digits, lambda digits: f"{digits:.0f}")
    return (
        f"From the coarsest setting to the finest, {digits} digits on, a pose "
        f"takes these times as long: {told or 'none of ours'}{more}."
    )


def _races(table: pd.DataFrame) -> str:
    found, without = races(table), races(table[table.way != "map"])
    if found.empty:
        return ""
    counts = found.verdict.value_counts()
    lost = found[found.verdict.isin(["other", "only others"])]
    winners = f" ({listed(list(lost.other.value_counts().index[:LISTED]))})" if len(lost) else ""
    nobody = f", and nobody reaches {counts['nobody']}" if "nobody" in counts else ""
    slower = int(without.verdict.isin(["other", "only others"]).sum())
    unmade = f"; without the map, whose making is not counted, others win {slower}"
    return (
        f"Of {len(found)} races, each of a scene, a quantity and an accuracy of "
        f"{', '.join(map(power, ACCURACIES))}, other ways than pointcoord's win {len(lost)}{winners}, "
        f"{counts.get('tie', 0)} are ties, pointcoord wins "
        f"{counts.get('ours', 0) + counts.get('only ours', 0)}{nobody}"
        f"{unmade if 'map' in set(table.way) else ''}."
    )
