"""The report of a study from its table: sentences and tables, a page, data, and a folder with the picture.

The same rows give the same bytes: nothing in it depends on when or where it is made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

from validate.cost.table import WHERE, Row, StoreError, frame, latest, read_rows
from validate.output.document import json_text
from validate.output.table import Part, Table, markdown

# Imported where they are needed, as `findings` is: pandas takes half a second, and most pages show no costs.
if TYPE_CHECKING:
    import pandas as pd

TITLE = "What accuracy costs in time"
NOTHING = "nothing was measured, so that there is nothing to say"
HOW = (
    "errors are against a many-digit reference, whose radius counts; times are medians of interleaved "
    "repeats by one thread, from instants to arrays, the set-up apart; *: one solve serves any instant; in "
    "brackets: the setting"
)
WIDTH = 110  # columns of a terminal


@dataclass(frozen=True)
class Report:
    """Rows with where they come from.

    Attributes:
        store: the file that holds them. command: that makes this report, as a shell would take it.
        quick: whether they are those of `--quick`.
    """

    store: str
    command: str
    quick: bool
    rows: tuple[Row, ...]

    @classmethod
    def of_file(cls, store: str, command: str = "", quick: bool = False) -> Report:
        """That of a file: of its rows that are not quick, unless quick ones are asked for or all there are.

        Raises:
            StoreError: it cannot be read, or holds none.
        """
        found = read_rows(Path(store))
        if not found:
            raise StoreError(f"{store}: holds no rows; measure them first")
        quick = quick or all(row.quick for row in found)
        return cls(store, command or found[0].command, quick, tuple(latest(found, quick)))

    @cached_property
    def table(self) -> pd.DataFrame:
        """The rows as a data frame."""
        return frame(self.rows)

    @cached_property
    def sentences(self) -> list[str]:
        """What the rows say."""
        from validate.cost.findings import sentences

        return sentences(self.table)

    def tables(self, *quantities: str) -> list[Table]:
        """The same with its numbers; of errors those of some quantities, or of all."""
        return [*_reached(self.table, quantities), *_growths(self.table), *_without_numbers(self.table)]

    @property
    def measured(self) -> int:
        """How many rows hold numbers."""
        return sum(row.verdict == "measured" for row in self.rows)

    def measured_by(self) -> dict[str, str] | None:
        """Command, program and machine of the first row."""
        return {what: getattr(self.rows[0], what) for what in ("command", *WHERE)} if self.rows else None

    def head(self) -> list[tuple[str, str]]:
        """Machine, versions and commands."""
        return [
            ("command", self.command),
            ("rows", f"{self.store}: {self.measured} measured of {len(self.rows)}"),
            *((what, value) for what, value in (self.measured_by() or {}).items() if value),
            ("how", HOW),
            *((("quick", "fewer settings, instants and repeats: a first look"),) if self.quick else ()),
        ]

    def parts(self) -> tuple[Part, ...]:
        """For a terminal: sentences, tables, of errors those of positions, and by what it was measured."""
        said = self.sentences or ([] if self.measured else [NOTHING])
        shown = [part for table in self.tables("position") for part in ("", _wrapped(table.caption), table)]
        by = "".join(f" by {row.program}, {row.machine}" for row in self.rows[:1])
        last = f"{self.store}: {self.measured} rows measured{by}"
        return ("\n".join(map(_wrapped, (TITLE, *said))), *shown, "", _wrapped(HOW), _wrapped(last))

    def markdown(self, picture: str = "") -> str:
        """For a page: sentences, a picture by the name of its file, and all tables."""
        blocks = [
            f"# {TITLE}",
            "\n".join(f"- {markdown(sentence)}" for sentence in self.sentences or [NOTHING]),
            *([f"![error against time]({picture})"] if picture else []),
            *(f"**{markdown(table.caption)}**\n\n{table.markdown}" for table in self.tables()),
            "\n".join(f"- {name}: {markdown(value)}" for name, value in self.head()),
        ]
        return "\n\n".join(blocks) + "\n"

    def csv(self) -> str:
        """The long table."""
        return str(self.table.to_csv(index=False, lineterminator="\n"))

    def data(self) -> dict[str, Any]:
        """As plain data: see the schema of the documents, kind `cost`."""
        from validate.cost.findings import growths, races

        return {
            "quick": self.quick,
            "store": self.store,
            "measured_by": self.measured_by(),
            "sentences": self.sentences,
            "races": _records(races(self.table)),
            "growths": _records(growths(self.table)),
            "rows": [asdict(row) for row in self.rows],
        }

    def headline(self) -> bytes | None:
        """The one picture, as SVG; None if there is nothing to draw.

        Raises:
            ImportError: matplotlib is not there.
        """
        from validate.cost.picture import headline
        from validate.output.figure import drawn

        figure = headline(self.table)
        return None if figure is None else drawn(figure, "svg")

    def files(self) -> Iterator[tuple[str, bytes]]:
        """Names and contents of the files of a folder: the picture, all tables as a page, and the rows.

        Raises:
            ImportError: matplotlib is not there.
        """
        if (picture := self.headline()) is not None:
            yield "headline.svg", picture
        yield "report.md", self.markdown("headline.svg" if picture else "").encode()
        yield "table.csv", self.csv().encode()
        yield "rows.json", json_text(self.data()).encode()


def _reached(table: pd.DataFrame, quantities: tuple[str, ...]) -> Iterator[Table]:
    """Time of a pose by the cheapest setting that reaches an accuracy, the quickest first."""
    from validate.cost.findings import ACCURACIES, cheapest, duration, timed, unit_of, words_of
    from validate.cost.way import power

    best, found = cheapest(table), timed(table, "accuracy")
    settings = (f" ({power(value)})" if value == value else "" for value in best.value)
    best = best.assign(cell=[duration(time) + more for time, more in zip(best.time, settings, strict=True)])
    for (scene, quantity), here in found.groupby(["scene", "quantity"], sort=False):
        if quantities and quantity not in quantities:
            continue
        near = best[(best.scene == scene) & (best.quantity == quantity)]
        times, cells = (
            near.pivot(index="way", columns="accuracy", values=of).reindex(columns=ACCURACIES)
            for of in ("time", "cell")
        )
        ways = here.groupby("way", sort=False).agg({"error": "min", "set_up": "min", "dense": "any"})
        ways = ways.join(times).sort_values([*reversed(ACCURACIES)], kind="stable")
        cells = cells.reindex(ways.index).astype(object).fillna("not reached")
        rows = (
            (f"{way.Index}{'*' * way.dense}", *reached, f"{way.error:.1e}", duration(way.set_up))
            for way, reached in zip(ways.itertuples(), cells.to_numpy().tolist(), strict=True)
        )
        unit = unit_of(quantity)
        yield Table(
            ("way", *(f"{power(a)} {unit}" for a in ACCURACIES), f"floor, {unit}", "set-up"),
            tuple(rows),
            caption=f"{scene}: time of a pose to an accuracy of {words_of(quantity)}, by the cheapest "
            f"setting; {here.poses.max()} poses a run, reference to {here.radius.max():.0e} {unit}",
        )


def _growths(table: pd.DataFrame) -> Iterator[Table]:
    """Fitted exponents of time and memory, a table for each thing that is varied and each scene."""
    from validate.cost.findings import duration, growths, in_units

    for (against, scene), here in growths(table).groupby(["against", "scene"], sort=False):
        lines = []
        for one in here.itertuples():
            fit = "-" if one.exponent != one.exponent else f"{one.exponent:.2f}"
            fit += "" if one.error != one.error else f" +- {one.error:.2f}"
            values = one.value, one.value / one.largest
            takes = [
                duration(v) if one.of == "time" else in_units(v, GB=1e9, MB=1e6, kB=1e3, B=1.0)
                for v in values
            ]
            lines.append((f"{one.way} {one.setting}".strip(), one.of, fit, f"{one.largest:g}", *takes))
        yield Table(
            ("way and setting", "of", "exponent", "largest", "takes", "each"),
            tuple(lines),
            caption=f"Growth in {against} of {scene}: value = factor x size^exponent, of the largest sizes",
        )


def _without_numbers(table: pd.DataFrame) -> Iterator[Table]:
    """What failed or was left out: each reason with the settings, quantities and sizes that it is of."""
    here = table[table.verdict != "measured"]
    here = here.assign(
        sized=[f"{n} {of}" if of else "" for n, of in zip(here["size"], here.against, strict=True)]
    )
    lines = []
    for (scene, way, verdict, reason), some in here.groupby(
        ["scene", "way", "verdict", "reason"], sort=False
    ):
        where = dict.fromkeys([*some.setting, *some.quantity, *some.sized])
        lines.append((f"{scene} {way}".strip(), verdict, ", ".join(filter(None, where)), reason))
    if lines:
        yield Table(("what", "verdict", "where", "reason"), tuple(lines), caption="Without numbers")


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Lines of a data frame as plain data; what is not there is null."""
    return list(table.astype(object).where(table.notna(), None).to_dict("records"))


def _wrapped(text: str) -> str:
    """A paragraph for a terminal; lines after the first stand further in."""
    return fill(text, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
