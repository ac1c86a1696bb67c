"""What the long table says: queries on it, and the three sentences of a reader who has no time.

Three rules keep it honest. A way is in a race for an accuracy only by a setting whose largest error, and the
reference's own radius on top of it, is at or below that accuracy: a wrong number is never quick. Times whose
quartiles overlap are a tie. Nothing is averaged over quantities, scenes or ways.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pandas as pd
from scipy.stats import linregress

from pointcoord.effects.registry import QUANTITIES
from validate.cost.ways.registry import OURS
from validate.cost.words import duration, listed, power, span, times

LINE = ["against", "scene", "way", "setting"]
"""The columns that say what grows."""
ACCURACIES = (1e-3, 1e-6, 1e-9)
"""In the unit of each quantity: mm of positions."""
DECADES = 2.0  # below the largest size: an exponent is fitted where fixed costs have been left behind
LISTED = 6  # ways that a sentence names


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
    return found[found.error.notna()] if part == "accuracy" else found


def heights(errors: pd.Series) -> tuple[pd.Series, str]:
    """Errors on a logarithmic axis, where nothing at all has no place, and words that say so.

    An error of exactly nothing is drawn a tenth below the least one.
    """
    least = errors[errors > 0.0].min()
    drawn = errors.clip(lower=(1e-16 if math.isnan(least) else least) / 10.0)
    return drawn, ", exactly 0 at the lower edge" if (errors == 0.0).any() else ""


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """By scene, quantity, way and accuracy the quickest setting that is accurate enough."""
    found = timed(table, "accuracy")
    near = pd.concat([found[found.error + found.radius <= a].assign(accuracy=a) for a in ACCURACIES])
    near = near.sort_values("time", kind="stable")
    return near.drop_duplicates(["scene", "quantity", "way", "accuracy"])


def races(table: pd.DataFrame) -> pd.DataFrame:
    """Who is quicker to an accuracy: the quickest of our ways, or of the others; and all that reach it."""
    best, found = cheapest(table), timed(table, "accuracy")
    lines = []
    for (scene, quantity), accuracy in product(
        found.groupby(["scene", "quantity"], sort=False).groups, ACCURACIES
    ):
        here = best[(best.scene == scene) & (best.quantity == quantity) & (best.accuracy == accuracy)]
        one, other = (
            next(side.itertuples(), None) for side in (here[here.way.isin(OURS)], here[~here.way.isin(OURS)])
        )
        if one is None or other is None:
            verdict = "only ours" if one else "only others" if other else "nobody"
        elif one.upper < other.lower or other.upper < one.lower:
            verdict = "ours" if one.time < other.time else "other"
        else:
            verdict = "tie"
        names = [None if side is None else side.way for side in (one, other)]
        ratio = other.time / one.time if one and other else None
        reached = here[["way", "setting", "time"]].to_dict("records")
        lines.append((scene, quantity, accuracy, verdict, *names, ratio, reached))
    columns = ["scene", "quantity", "accuracy", "verdict", "ours", "other", "ratio", "reached"]
    return pd.DataFrame(lines, columns=columns)


def grown(table: pd.DataFrame) -> pd.DataFrame:
    """What every size takes: `of` time or memory, with its `value`, s a run or bytes; sizes increase.

    Against instants without the set-up, which is the same for any number of them.
    """
    found = timed(table, "growth").sort_values("size", kind="stable")
    found = found.drop_duplicates([*LINE, "size"], keep="last")
    set_up = found.set_up.where(found.against != "instants", 0.0)
    time = found.assign(of="time", value=found.time * found.poses.astype(float) + set_up)
    both = pd.concat([time, found.assign(of="memory", value=found.peak_bytes.astype(float))])
    return both[both.value > 0.0]


def growths(table: pd.DataFrame) -> pd.DataFrame:
    """How time and memory grow: value = factor x size^exponent, of the largest sizes.

    The exponent is the slope of the logarithms, with its standard error; NaN from fewer than three sizes.
    """
    lines = []
    for key, line in grown(table).groupby([*LINE, "of"], sort=False):
        sizes, values = line["size"].to_numpy(float), line.value.to_numpy(float)
        large = sizes >= sizes[-1] * 10.0**-DECADES * (1.0 - 1e-9)
        large[-3:] = True
        slope = error = math.nan
        if len(sizes) > 1:
            fit = linregress(np.log(sizes[large]), np.log(values[large]))
            slope, error = float(fit.slope), float(fit.stderr) if large.sum() > 2 else math.nan
        lines.append((*key, slope, error, float(sizes[-1]), float(values[-1])))
    return pd.DataFrame(lines, columns=[*LINE, "of", "exponent", "error", "largest", "value"])


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
    order = list(finest.groupby("way", sort=False).time.median().sort_values().index)
    told = {way: f"{way} {span(finest[finest.way == way].time, duration)}" for way in order[:LISTED]}
    if "map" in told:
        made = span(finest[finest.way == "map"].set_up, duration)
        told["map"] += f" (once its map is made, which takes {made})"
    asked = timed(table, "accuracy")
    missed = [way for way in dict.fromkeys(asked[asked.quantity == "position"].way) if way not in order]
    rest = f"; {listed(missed)} do not reach it" if missed else ""
    goal = f"{power(ACCURACIES[-1])} mm of position"
    return f"A pose to {goal} takes {listed([*told.values()])}, the quickest of {len(order)} ways{rest}."


def _digits(table: pd.DataFrame) -> str:
    found = dials(table)
    if found.empty:
        return ""
    ours, others = found[found.way.isin(OURS)], found[~found.way.isin(OURS)].times
    told = ", ".join(f"{way} {span(line.times, times)}" for way, line in ours.groupby("way", sort=False))
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
    winners = f" ({listed([*lost.other.value_counts().index[:LISTED]])})" if len(lost) else ""
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
