"""The report of a study from its table: sentences and tables, a page, data, and a folder with the picture.

The same rows give the same bytes: nothing in it depends on when or where it is made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from textwrap import fill
from typing import TYPE_CHECKING, Any

from validate.cost.table import WHERE, Row, frame, read_rows
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
    """

    store: str
    command: str
    rows: tuple[Row, ...]

    @classmethod
    def of_file(cls, store: str, command: str = "") -> Report:
        """That of a file.

        Raises:
            UsageError: it cannot be read, or holds no rows.
        """
        rows = read_rows(store)
        return cls(store, command or rows[0].command, tuple(rows))

    @property
    def quick(self) -> bool:
        """Whether any row is one of `--quick`."""
        return any(row.quick for row in self.rows)

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
        return [*_reached(self.table, quantities), *_without_numbers(self.table)]

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
        from validate.cost.findings import races

        return {
            "quick": self.quick,
            "store": self.store,
            "measured_by": self.measured_by(),
            "sentences": self.sentences,
            "races": _records(races(self.table)),
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
        """Names and contents of the files of a folder: the picture, and all tables as a page.

        Raises:
            ImportError: matplotlib is not there.
        """
        if (picture := self.headline()) is not None:
            yield "headline.svg", picture
        yield "report.md", self.markdown("headline.svg" if picture else "").encode()


def _reached(table: pd.DataFrame, quantities: tuple[str, ...]) -> Iterator[Table]:
    """Time of a pose by the cheapest setting that reaches an accuracy, the quickest first."""
    from validate.cost.findings import ACCURACIES, cheapest, duration, timed, unit_of, words_of
    from validate.cost.way import power

    best, found = cheapest(table), timed(table)
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


def _without_numbers(table: pd.DataFrame) -> Iterator[Table]:
    """What failed or was left out: each reason with the settings and quantities that it is of."""
    here, lines = table[table.verdict != "measured"], []
    for (scene, way, verdict, reason), some in here.groupby(
        ["scene", "way", "verdict", "reason"], sort=False
    ):
        where = dict.fromkeys([*some.setting, *some.quantity])
        lines.append((f"{scene} {way}".strip(), verdict, ", ".join(filter(None, where)), reason))
    if lines:
        yield Table(("what", "verdict", "where", "reason"), tuple(lines), caption="Without numbers")


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Lines of a data frame as plain data; what is not there is null."""
    return list(table.astype(object).where(table.notna(), None).to_dict("records"))


def _wrapped(text: str) -> str:
    """A paragraph for a terminal; lines after the first stand further in."""
    return fill(text, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
