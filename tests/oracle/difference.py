"""What differs between two records: facts that are not equal, numbers further apart than both bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd
from record import COLUMNS, KEYS, Fact, Record

# A number now with a bound so many times what its kind had tests nothing: a fault of that size would pass.
LOOSEST = 1000.0
AGREES = "agrees"  # of a quantity that was not given before
EPS = np.finfo(float).eps


@dataclass(frozen=True)
class Difference:
    """One thing that is not as it was frozen."""

    part: str
    case: str
    quantity: str
    frozen: str
    now: str
    allowed: str = "equal"

    def __str__(self) -> str:
        return (
            f"{self.part} | {self.case} | {self.quantity} | frozen {self.frozen} | now {self.now} | "
            f"allowed {self.allowed}"
        )


@dataclass(frozen=True)
class Comparison:
    """A part held to what was frozen of it.

    Attributes:
        count: of the facts and numbers that were compared.
        widened: median of bound now / frozen bound, of numbers that have bounds; wide ones test nothing.
    """

    differences: list[Difference]
    count: int
    widened: float | None = None

    def __str__(self) -> str:
        bounds = "" if self.widened is None else f", bounds {self.widened:.2g} times the frozen ones (median)"
        return f"{len(self.differences):,} differences in {self.count:,} facts and numbers{bounds}"


def compared(part: str, frozen: Record, now: Record) -> Comparison:
    """All that differs."""
    facts, count = [*_of_facts(part, frozen, now)], sum(map(len, frozen.facts.values()))
    if not len(frozen.numbers):
        return Comparison(facts, count)
    numbers = _of_numbers(part, frozen.numbers, now.numbers)
    return Comparison(facts + numbers.differences, count + numbers.count, numbers.widened)


def _of_facts(part: str, frozen: Record, now: Record) -> Iterator[Difference]:
    for case, facts in frozen.facts.items():
        others = now.facts.get(case)
        if others is None:
            yield Difference(part, case, "the case", "there", "gone")
            continue
        for quantity in dict.fromkeys((*facts, *others)):
            if quantity not in facts and others[quantity] == AGREES:
                continue
            then, there = facts.get(quantity, "nothing"), others.get(quantity, "nothing")
            if _is_number(then) and _is_number(there):
                allowed = then[1] + there[1]
                if not abs(then[0] - there[0]) <= allowed:
                    yield Difference(part, case, quantity, repr(then[0]), repr(there[0]), f"{allowed:.3g}")
            elif then != there:
                yield Difference(part, case, quantity, _words(then), _words(there))


def _is_number(fact: Fact) -> bool:
    """Whether a fact is a value with how far it may be off."""
    return (
        isinstance(fact, list)
        and len(fact) == 2
        and all(isinstance(number, int | float) and not isinstance(number, bool) for number in fact)
    )


def _words(fact: Fact) -> str:
    return ", ".join(map(str, fact)) if isinstance(fact, list) else str(fact)


def _of_numbers(part: str, frozen: pd.DataFrame, now: pd.DataFrame) -> Comparison:
    r"""Numbers with |now - frozen| > both bounds + eps^2 M, with M the largest of the quantity in the case.

    A number that is zero is solved for together with others that are not, and keeps a rounding of a rounding.
    The paper's quotient for omega is 0/0 where nothing turns: whether zeros or roundings are divided there is
    a matter of the last digit of a cosine, which processors round differently.
    """
    both = _with_words(frozen).merge(
        _with_words(now), on=KEYS, how="left", suffixes=("", "_now"), indicator=True
    )
    kind = ["case", "formulation", "quantity"]
    groups = both.assign(size=both["value"].abs()).groupby(kind, sort=False)
    size, usual = groups["size"].transform("max"), groups["bound"].transform("max")
    both["allowed"] = both["bound"] + both["bound_now"] + EPS**2 * size
    both["loose"] = both["bound_now"] > LOOSEST * np.maximum(usual, EPS * size)
    apart = (both["value_now"] - both["value"]).abs()
    neither = both["value"].isna() & both["value_now"].isna() & (both["_merge"] == "both")
    # A number that is not there any more, or has no bound, is not within it.
    both["share"] = (apart / both["allowed"]).fillna(np.inf)
    no_turn = (both["formulation"] == "printed") & (both["_merge"] == "both")
    for value, bound in (("value", "bound"), ("value_now", "bound_now")):
        no_turn &= both[value].isna() | (both[value].abs() <= both[bound])
    right = neither | no_turn | (apart == 0.0) | (apart <= both["allowed"])
    wrong = both[~right | both["loose"]]
    worst = wrong.sort_values("share", ascending=False, kind="stable").drop_duplicates([*kind, "name"])
    widened = (both["bound_now"] / both["bound"])[both["bound"] > 0.0].median()
    lines = [_line(part, row) for row in worst.sort_index().to_dict("records")]
    return Comparison(lines, len(both), float(widened))


def _with_words(table: pd.DataFrame) -> pd.DataFrame:
    """Keys as plain words and numbers as numbers: tables may have other categories, or no rows."""
    kinds = {"instant": "int64", "value": "float64", "bound": "float64"}
    return table.astype({name: kinds.get(name, "object") for name in COLUMNS})


def _line(part: str, row: dict[str, object]) -> Difference:
    place = f"{row['name']}.{row['axis']}" if row["axis"] else str(row["name"])
    quantity = f"{row['formulation']}: {row['quantity']} {place}, instant number {row['instant']}"
    now = "nothing" if row["_merge"] == "left_only" else repr(row["value_now"])
    allowed = f"{row['allowed']:.3g}"
    if row["loose"]:
        allowed = f"a bound up to {LOOSEST:g} times the frozen one, which is {row['bound_now']:.3g} now"
    return Difference(part, str(row["case"]), quantity, repr(row["value"]), now, allowed)
