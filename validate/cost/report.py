"""The report of a study of cost from its rows: as text, as a page, as data, and as a folder with pictures.

The same rows give the same bytes: nothing in it depends on when or where it is made.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any

from validate.cost.findings import Findings, accuracy_rows, findings, scenes_of
from validate.cost.row import Row
from validate.cost.sentences import verdicts
from validate.cost.store import Header
from validate.cost.tables import csv_text, full_tables, short_tables, wrapped
from validate.output.document import json_text
from validate.output.terminal import Part, text_of

TITLE = "What accuracy costs in time"
NOTHING = "nothing was measured, so that there is nothing to say"


REFERENCE = (
    "against a reference in 60 digits whose assembly is proven by interval arithmetic, and whose equations "
    "share no code with any way; at instants that are special to none"
)
TIMES = (
    "medians of interleaved repeats with their quartiles, by one thread, the garbage collector off; set-up, "
    "solve, rates and output apart, and the first run of all apart from the others"
)


@dataclass(frozen=True)
class Report:
    """Rows with where they come from.

    Attributes:
        store: the file that holds them.
        header: where and by what they were measured; None if nothing was.
        command: that makes this report, as a shell would take it.
        quick: whether they are those of `--quick`.
    """

    store: str
    header: Header | None
    command: str
    quick: bool
    rows: tuple[Row, ...]

    @cached_property
    def found(self) -> Findings:
        """What the rows say."""
        return findings(self.rows)

    @cached_property
    def sentences(self) -> list[str]:
        """The same in sentences."""
        return verdicts(self.found)

    @property
    def measured(self) -> int:
        """How many rows hold numbers."""
        return sum(row.status == "measured" for row in self.rows)

    def head(self) -> list[tuple[str, str]]:
        """Machine, versions, threads and commands."""
        header = self.header
        told = [("command", self.command), ("rows", self._counted())]
        if header is not None:
            told += [
                ("measured by", header.command or "not known"),
                ("program", header.program),
                ("machine", header.machine),
                ("python", f"{header.python}; {_listed(header.packages)}"),
                ("threads", _listed(header.threads)),
            ]
        told += [("errors", REFERENCE), ("times", TIMES)]
        if self.quick:
            told.append(("quick", "fewer settings, instants and repeats: no more than a first look"))
        return told

    @property
    def _said(self) -> list[str]:
        """The sentences; that there are none only where nothing was measured."""
        return self.sentences or ([] if self.measured else [NOTHING])

    def _counted(self) -> str:
        states = {state: sum(row.status == state for row in self.rows) for state in ("failed", "left out")}
        rest = "".join(f", {count} {state}" for state, count in states.items() if count)
        return f"{self.store}: {self.measured} measured{rest}"

    def parts(self) -> tuple[Part, ...]:
        """For a terminal: sentences first, then short tables."""
        head = "\n".join(wrapped(f"{name}: {value}", "  ") for name, value in self.head())
        blocks = [f"{TITLE}\n{head}", *map(wrapped, self._said)]
        tables = (("", *table.parts()) for table in short_tables(self.rows, self.found))
        return ("\n".join(blocks), *(part for parts in tables for part in parts))

    def text(self) -> str:
        """The same in lines."""
        return text_of(self.parts())

    def markdown(self, pictures: Sequence[str] = ()) -> str:
        """For a page: sentences, pictures by the names of their files, and full tables."""
        blocks = [
            f"# {TITLE}",
            "\n".join(f"- {name}: {_literal(value)}" for name, value in self.head()),
            "\n".join(f"- {_literal(sentence)}" for sentence in self._said),
            *(f"![{name.removesuffix('.svg')}]({name})" for name in pictures),
            *(table.markdown().rstrip() for table in full_tables(self.rows, self.found)),
        ]
        return "\n\n".join(blocks) + "\n"

    def data(self) -> dict[str, Any]:
        """As plain data: see the schema of the documents, kind `cost`."""
        return {
            "quick": self.quick,
            "store": self.store,
            "measured_by": None if self.header is None else asdict(self.header),
            "sentences": self.sentences,
            **asdict(self.found),
            "rows": [asdict(row) for row in self.rows],
        }

    def files(self) -> Iterator[tuple[str, bytes]]:
        """Names and contents of the files of a folder.

        Raises:
            ImportError: matplotlib is not there.
        """
        # Nothing else of the program needs it.
        from validate.cost.picture import error_time, growing, headline
        from validate.cost.picture.look import drawn

        figures = {}
        first = headline.figure(self.rows, self.found)
        if first is not None:
            figures["headline"] = first
        accuracy = accuracy_rows(self.rows)
        for scene in scenes_of(accuracy):
            here = [row for row in accuracy if row.scene == scene]
            if any(row.errors for row in here):
                figures[_free(f"error-time-{_slug(scene)}", figures)] = error_time.figure(here)
        dense = frozenset(row.way for row in self.rows if row.dense)
        for against, scene in dict.fromkeys((one.against, one.scene) for one in self.found.growths):
            grown = [one for one in self.found.growths if (one.against, one.scene) == (against, scene)]
            if any(growth.points for growth in grown):
                figures[_free(f"growth-{against}-{_slug(scene)}", figures)] = growing.figure(grown, dense)
        for name, figure in figures.items():
            for ending in ("svg", "png"):
                yield f"{name}.{ending}", drawn(figure, ending)
        yield "report.md", self.markdown([f"{name}.svg" for name in figures]).encode()
        yield "table.csv", csv_text(self.rows).encode()
        yield "rows.json", json_text(self.data()).encode()


def _listed(values: Any) -> str:
    return ", ".join(f"{name} {value}" for name, value in values.items())


def _literal(text: str) -> str:
    """Text in which Markdown sees no marks of its own."""
    return re.sub(r"([*_<>|`\[\]])", r"\\\1", text)


def _slug(scene: str) -> str:
    """A scene's name as part of the name of a file."""
    return re.sub(r"[^A-Za-z0-9]+", "-", scene.rpartition("/")[2].removesuffix(".toml")).strip("-") or "scene"


def _free(name: str, taken: Any) -> str:
    """The name, with a number if there is one like it."""
    number, free = 2, name
    while free in taken:
        free, number = f"{name}-{number}", number + 1
    return free
