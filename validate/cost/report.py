"""The report of a study from its table: sentences and tables, a page, data, and a folder with pictures.

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
from validate.output.table import Part, Table, markdown, text_of

# Imported where they are needed: pandas takes half a second, and most pages show no costs.
if TYPE_CHECKING:
    import pandas as pd

TITLE = "What accuracy costs in time"
NOTHING = "nothing was measured, so that there is nothing to say"
REFERENCE = (
    "against a reference in 60 digits whose assembly is proven by interval arithmetic, and whose equations "
    "share no code with any way; at instants that are special to none"
)
TIMES = (
    "medians of interleaved repeats, by one thread, the garbage collector off; from instants to arrays, "
    "positions alone where positions are judged; the set-up apart"
)
WIDTH = 110  # columns of a terminal
MEASURED_BY = ("command", *WHERE)


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
        from validate.cost.tables import tables_of

        return tables_of(self.table, quantities)

    @property
    def measured(self) -> int:
        """How many rows hold numbers."""
        return sum(row.verdict == "measured" for row in self.rows)

    def measured_by(self) -> dict[str, str] | None:
        """Command, program and machine of the first row."""
        return {what: getattr(self.rows[0], what) for what in MEASURED_BY} if self.rows else None

    def head(self) -> list[tuple[str, str]]:
        """Machine, versions and commands."""
        from validate.cost.tables import KEY

        counts = {v: sum(row.verdict == v for row in self.rows) for v in ("failed", "left out")}
        rest = "".join(f", {count} {verdict}" for verdict, count in counts.items() if count)
        return [
            ("command", self.command),
            ("rows", f"{self.store}: {self.measured} measured{rest}"),
            *((what, value) for what, value in (self.measured_by() or {}).items() if value),
            ("errors", REFERENCE),
            ("times", TIMES),
            ("tables", KEY),
            *((("quick", "fewer settings, instants and repeats: a first look"),) if self.quick else ()),
        ]

    def parts(self) -> tuple[Part, ...]:
        """For a terminal: sentences, tables, of errors those of positions, and by what it was measured."""
        from validate.cost.tables import KEY

        said = self.sentences or ([] if self.measured else [NOTHING])
        shown = [part for table in self.tables("position") for part in ("", _wrapped(table.caption), table)]
        where = [f"{row.program}, {row.machine}" for row in self.rows[:1]]
        last = [_wrapped(f"{self.store}: {self.measured} rows measured by {words}") for words in where]
        key = [KEY] if any(row.part == "accuracy" and row.time is not None for row in self.rows) else []
        return ("\n".join(map(_wrapped, (TITLE, *said))), *shown, "", *key, *last)

    def text(self) -> str:
        """The same in lines."""
        return text_of(self.parts())

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


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Lines of a data frame as plain data; what is not there is null."""
    return list(table.astype(object).where(table.notna(), None).to_dict("records"))


def _wrapped(text: str) -> str:
    """A paragraph for a terminal; lines after the first stand further in."""
    return fill(text, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
