"""The report of a study from its table: sentences and short tables, a page, data, and a folder with pictures.

The same rows give the same bytes: nothing in it depends on when or where it is made.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from validate.cost.row import Row
from validate.cost.words import literal, wrapped
from validate.output.document import json_text
from validate.output.table import Part, text_of

if TYPE_CHECKING:
    import pandas as pd

    from validate.cost.tables import Table

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

    @cached_property
    def table(self) -> pd.DataFrame:
        """The rows as a data frame."""
        # Imported here and below: pandas takes half a second, and most pages tell of no cost.
        from validate.cost.findings import frame

        return frame(self.rows)

    @cached_property
    def sentences(self) -> list[str]:
        """What the rows say."""
        from validate.cost.findings import sentences

        return sentences(self.table)

    @cached_property
    def tables(self) -> list[Table]:
        """The same with its numbers."""
        from validate.cost.tables import tables_of

        return tables_of(self.table)

    @property
    def measured(self) -> int:
        """How many rows hold numbers."""
        return sum(row.verdict == "measured" for row in self.rows)

    def head(self) -> list[tuple[str, str]]:
        """Machine, versions and commands."""
        counts = {v: sum(row.verdict == v for row in self.rows) for v in ("failed", "left out")}
        rest = "".join(f", {count} {verdict}" for verdict, count in counts.items() if count)
        first = self.rows[0] if self.rows else None
        return [
            ("command", self.command),
            ("rows", f"{self.store}: {self.measured} measured{rest}"),
            *((what, getattr(first, what)) for what in _WHERE if first and getattr(first, what)),
            ("errors", REFERENCE),
            ("times", TIMES),
            *((("quick", "fewer settings, instants and repeats: a first look"),) if self.quick else ()),
        ]

    def parts(self) -> tuple[Part, ...]:
        """For a terminal: sentences, short tables, and by what it was measured."""
        said = self.sentences or ([] if self.measured else [NOTHING])
        tables = [part for table in self.tables if table.brief for part in ("", *table.parts())]
        where = [f"{row.program}, {row.machine}" for row in self.rows[:1]]
        last = [wrapped(f"{self.store}: {self.measured} rows measured by {words}") for words in where]
        return ("\n".join(map(wrapped, (TITLE, *said))), *tables, "", *last)

    def text(self) -> str:
        """The same in lines."""
        return text_of(self.parts())

    def markdown(self, pictures: Sequence[str] = ()) -> str:
        """For a page: sentences, pictures by the names of their files, and all tables."""
        said = self.sentences or [NOTHING]
        blocks = [
            f"# {TITLE}",
            "\n".join(f"- {literal(sentence)}" for sentence in said),
            *(f"![{name.removesuffix('.svg')}]({name})" for name in pictures),
            *(table.markdown() for table in self.tables),
            "\n".join(f"- {name}: {literal(value)}" for name, value in self.head()),
        ]
        return "\n\n".join(blocks) + "\n"

    def csv(self) -> str:
        """The long table."""
        return str(self.table.to_csv(index=False, lineterminator="\n"))

    def data(self) -> dict[str, Any]:
        """As plain data: see the schema of the documents, kind `cost`."""
        from validate.cost.findings import growths, races

        first = self.rows[0] if self.rows else None
        return {
            "quick": self.quick,
            "store": self.store,
            "measured_by": None if first is None else {what: getattr(first, what) for what in _WHERE},
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
        from validate.cost.picture.figures import headline
        from validate.cost.picture.look import drawn

        figure = headline(self.table)
        return None if figure is None else drawn(figure, "svg")

    def files(self) -> Iterator[tuple[str, bytes]]:
        """Names and contents of the files of a folder.

        Raises:
            ImportError: matplotlib is not there.
        """
        from validate.cost.picture.figures import figures
        from validate.cost.picture.look import drawn

        found: dict[str, Any] = {}
        for name, figure in figures(self.table):
            found[_free(_slug(name), found)] = figure
        for name, figure in found.items():
            for ending in ("svg", "png"):
                yield f"{name}.{ending}", drawn(figure, ending)
        yield "report.md", self.markdown([f"{name}.svg" for name in found]).encode()
        yield "table.csv", self.csv().encode()
        yield "rows.json", json_text(self.data()).encode()


_WHERE = ("command", "program", "machine", "python", "packages")


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Lines of a data frame as plain data; what is not there is null."""
    return list(table.astype(object).where(table.notna(), None).to_dict("records"))


def _slug(name: str) -> str:
    """A name with a scene's as the name of a file."""
    return re.sub(r"[^A-Za-z0-9]+", "-", name.removesuffix(".toml")).strip("-")


def _free(name: str, taken: Any) -> str:
    """The name, with a number if there is one like it."""
    number, free = 2, name
    while free in taken:
        free, number = f"{name}-{number}", number + 1
    return free
