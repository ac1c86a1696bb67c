"""The tables of a report, as queries on the long table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pandas as pd

from validate.cost.findings import (
    ACCURACIES,
    cheapest,
    growths,
    quantities_of,
    timed,
    unit_of,
    words_of,
)
from validate.cost.parts.effects import NO_EFFECT
from validate.cost.words import bytes_words, duration, literal, power, times, wrapped
from validate.output.table import Part
from validate.output.table import Table as Columns


@dataclass(frozen=True)
class Table:
    """A table with what must be known to read it below.

    Attributes:
        brief: whether a terminal shows it.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()
    brief: bool = True

    def parts(self) -> tuple[Part, ...]:
        """For a terminal."""
        return (wrapped(self.title), Columns(self.head, self.rows), *map(wrapped, self.notes))

    def markdown(self) -> str:
        """For a page."""
        lines = [self.head, tuple("---" for _ in self.head), *self.rows]
        body = "\n".join("| " + " | ".join(c.replace("|", "\\|") for c in line) + " |" for line in lines)
        return "\n\n".join(
            (f"**{literal(self.title)}**", body, *(f"- {literal(note)}" for note in self.notes))
        )


def tables_of(table: pd.DataFrame) -> list[Table]:
    """All of them; of each scene what a pose takes to an accuracy, quantity by quantity."""
    found = [*_reached(table), *_effects(table), *_growths(table), *_loading(table), *_unrelated(table)]
    return [*found, *_without_numbers(table)]


def _reached(table: pd.DataFrame) -> Iterator[Table]:
    """Time of a pose by the cheapest setting that reaches an accuracy, the quickest first."""
    best, found = cheapest(table), timed(table, "accuracy")
    for scene, here in found.groupby("scene", sort=False):
        for quantity in quantities_of(here):
            these = here[here.quantity == quantity]
            near = best[(best.scene == scene) & (best.quantity == quantity)]
            lines = []
            for way, line in these.groupby("way", sort=False):
                mine = {one.accuracy: one for one in near[near.way == way].itertuples()}
                cells = [_reach(mine.get(accuracy)) for accuracy in ACCURACIES]
                order = [mine[a].time if a in mine else float("inf") for a in reversed(ACCURACIES)]
                star = "*" if line.dense.any() else ""
                lines.append(
                    (order, (f"{way}{star}", *cells, f"{line.error.min():.1e}", duration(line.set_up.min())))
                )
            unit = unit_of(quantity)
            yield Table(
                f"{scene}: time of a pose to an accuracy of {words_of(quantity)}, by the cheapest setting",
                ("way", *(f"{power(a)} {unit}" for a in ACCURACIES), f"floor, {unit}", "set-up"),
                tuple(cells for _, cells in sorted(lines, key=lambda line: line[0])),
                (
                    "*: one solve serves any instant; in brackets: the number that is dialled; "
                    f"{these.poses.max()} poses a run; the reference's own proven error: "
                    f"{these.radius.max():.0e} {unit}",
                ),
                brief=quantity == "position",
            )


def _reach(one: Any) -> str:
    """The time of a row of the table, with the number that was dialled; None where no row is there."""
    if one is None:
        return "not reached"
    return duration(one.time) + ("" if pd.isna(one.value) else f" ({power(one.value)})")


def _effects(table: pd.DataFrame) -> Iterator[Table]:
    """What reading a scene takes with each effect, beside a copy and beside positions alone."""
    for scene, here in timed(table, "effects").groupby("scene", sort=False):
        wide = here.pivot_table(index="setting", columns="quantity", values="time", sort=False)
        alone = wide["read"].get(NO_EFFECT, float("nan"))
        numbers = here.groupby("setting").numbers.max()
        yield Table(
            f"Reading {scene} at {here.poses.max()} instants, by effects",
            ("asked for", "numbers", "an instant", "of a copy", "of positions"),
            tuple(
                (
                    str(name),
                    str(numbers[name]),
                    duration(one["read"]),
                    times(one["read"] / one["copy"]),
                    times(one["read"] / alone),
                )
                for name, one in wide.iterrows()
            ),
        )


def _growths(table: pd.DataFrame) -> Iterator[Table]:
    """Fitted exponents of time and memory, a table for each thing that is varied and each scene."""
    for (against, scene), here in growths(table).groupby(["against", "scene"], sort=False):
        lines = []
        for one in here.itertuples():
            measure = duration if one.of == "time" else bytes_words
            fit = "-" if pd.isna(one.exponent) else f"{one.exponent:.2f}"
            fit += "" if pd.isna(one.error) else f" +- {one.error:.2f}"
            name = f"{one.way} {one.setting}".strip()
            lines.append(
                (name, one.of, fit, f"{one.largest:g}", measure(one.value), measure(one.value / one.largest))
            )
        yield Table(
            f"Growth in {against} of {scene}: value = factor x size^exponent, of the largest sizes",
            ("way and setting", "of", "exponent", "largest", "takes", "each"),
            tuple(lines),
        )


def _loading(table: pd.DataFrame) -> Iterator[Table]:
    here = timed(table, "loading")
    if not here.empty:
        lines = [
            (one.way, duration(one.time), f"{duration(one.lower)} to {duration(one.upper)}")
            for one in here.itertuples()
        ]
        yield Table("Loading, the start of Python included", ("what", "median", "quartiles"), tuple(lines))


def _unrelated(table: pd.DataFrame) -> Iterator[Table]:
    """What a pose takes at inputs that have nothing to do with each other, quickest first."""
    for scene, here in timed(table, "unrelated").groupby("scene", sort=False):
        lines = [
            (
                f"{one.way} {one.setting}".strip(),
                f"{one.poses:,}",
                duration(one.time),
                f"{one.error:.1e}",
                duration(one.set_up),
            )
            for one in here.sort_values("time").itertuples()
        ]
        yield Table(
            f"A pose of {scene} at inputs that have nothing to do with each other",
            ("way", "poses", "a pose", "error, mm", "set-up"),
            tuple(lines),
            ("errors are those of the first poses, against the reference",),
        )


def _without_numbers(table: pd.DataFrame) -> Iterator[Table]:
    """What failed or was left out: each reason with its runs."""
    here = table[table.verdict != "measured"]
    if here.empty:
        return
    lines = []
    for (scene, way, verdict, reason), some in here.groupby(
        ["scene", "way", "verdict", "reason"], sort=False
    ):
        what = dict.fromkeys([*some.setting, *map(words_of, some.quantity)])
        sizes = [
            f"{size:g} {against}" for size, against in zip(some["size"], some.against, strict=True) if against
        ]
        lines.append(
            (
                f"{scene} {way}".strip(),
                verdict,
                ": ".join(filter(None, (", ".join([*filter(None, what), *sizes]), reason))),
            )
        )
    yield Table("Without numbers", ("what", "verdict", "where"), tuple(lines))
