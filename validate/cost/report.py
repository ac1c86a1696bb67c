"""The report of a study from its rows: sentences, tables, data and the picture.

Equal rows give equal bytes: the report does not depend on the time or place where it is made.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from textwrap import fill
from typing import TYPE_CHECKING, Any

from validate.cost.table import WHERE, Row, frame, read_rows
from validate.output.table import Part, Table

# pandas and `findings` are imported where needed: pandas takes half a second, and most pages have no costs.
if TYPE_CHECKING:
    import pandas as pd

TITLE = "Run time against accuracy"
NOTHING = "nothing was measured, so there are no findings"
HOW = (
    "errors are against a many-digit reference, whose radius is added; times are medians of interleaved "
    "repeats with one thread, from instants to arrays, without the set-up; *: one solve serves any instant"
)
WIDTH = 110  # columns of a terminal


@dataclass(frozen=True)
class Report:
    """The rows of a study and their source.

    Attributes:
        store: the file of the rows.
        command: the command line that makes this report, quoted for a shell.
    """

    store: str
    command: str
    rows: tuple[Row, ...]

    @classmethod
    def of_file(cls, store: str, command: str = "") -> Report:
        """The report of a file.

        Raises:
            UsageError: the file cannot be read, or has no rows.
        """
        rows = read_rows(store)
        return cls(store, command or rows[0].command, tuple(rows))

    @property
    def quick(self) -> bool:
        """Whether any row was measured with `--quick`."""
        return any(row.quick for row in self.rows)

    @cached_property
    def table(self) -> pd.DataFrame:
        """The rows as a data frame."""
        return frame(self.rows)

    @cached_property
    def sentences(self) -> list[str]:
        """The findings in sentences."""
        from validate.cost.findings import sentences

        return sentences(self.table)

    @property
    def tables(self) -> list[Table]:
        """The times to the finest accuracy, and the rows without numbers."""
        return [*_reached(self.table), *_without_numbers(self.table)]

    @property
    def measured(self) -> int:
        """The number of rows with numbers."""
        return sum(row.verdict == "measured" for row in self.rows)

    def measured_by(self) -> dict[str, str] | None:
        """Command, program and machine of the first row."""
        return {what: getattr(self.rows[0], what) for what in ("command", *WHERE)} if self.rows else None

    def head(self) -> list[tuple[str, str]]:
        """Names and values: command, rows, program, machine, versions and how it was measured."""
        return [
            ("command", self.command),
            ("rows", f"{self.store}: {self.measured} measured of {len(self.rows)}"),
            *((what, value) for what, value in (self.measured_by() or {}).items() if value),
            ("how", HOW),
            *((("quick", "fewer settings, instants and repeats: a first look"),) if self.quick else ()),
        ]

    def parts(self) -> tuple[Part, ...]:
        """The report for a terminal: sentences, tables, program and machine."""
        lines = self.sentences or ([] if self.measured else [NOTHING])
        shown = [part for table in self.tables for part in ("", table)]
        by = "".join(f" by {row.program}, {row.machine}" for row in self.rows[:1])
        last = f"{self.store}: {self.measured} rows measured{by}"
        return ("\n".join(map(_wrapped, (TITLE, *lines))), *shown, "", _wrapped(HOW), _wrapped(last))

    def csv(self) -> str:
        """All rows as CSV."""
        return str(self.table.to_csv(index=False, lineterminator="\n"))

    def data(self) -> dict[str, Any]:
        """The report as plain data; see the JSON Schema, kind `cost`."""
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
        """The picture, as SVG; None if nothing was measured.

        Raises:
            ImportError: matplotlib is not installed.
        """
        from validate.cost.picture import headline
        from validate.output.figure import drawn

        figure = headline(self.table)
        return None if figure is None else drawn(figure)


def _reached(table: pd.DataFrame) -> Iterator[Table]:
    """Time of a pose with the fastest setting that reaches the finest accuracy, the fastest method first."""
    from pandas import crosstab

    from validate.cost.findings import ACCURACIES, cheapest, duration, timed
    from validate.cost.way import power

    tried, best = timed(table), cheapest(table)
    tried = tried[tried.quantity == "position"]
    best = best[(best.quantity == "position") & (best.accuracy == ACCURACIES[-1])]
    if tried.empty:
        return
    scenes, dense = list(dict.fromkeys(tried.scene)), tried.groupby("way").dense.any()
    times = best.pivot(index="way", columns="scene", values="time").reindex(
        tried.way.unique(), columns=scenes
    )
    times = times.loc[times.median(axis=1).sort_values(na_position="last", kind="stable").index]
    there = crosstab(tried.way, tried.scene).loc[times.index, scenes]
    texts = times.astype(object).map(duration, na_action="ignore")
    texts = texts.where(times.notna(), there.map(lambda count: "not reached" if count else "-"))
    rows = ((f"{way}*" if dense[way] else way, *cells) for way, *cells in texts.itertuples())
    caption = (
        f"Time of a pose to {power(ACCURACIES[-1])} mm of position, with the fastest setting; "
        f"{' to '.join(dict.fromkeys(map(str, (tried.poses.min(), tried.poses.max()))))} poses a run"
    )
    yield Table(("method", *scenes), tuple(rows), caption=caption)


def _without_numbers(table: pd.DataFrame) -> Iterator[Table]:
    """Rows that failed or were left out: each reason with its settings and quantities."""
    here, lines = table[table.verdict != "measured"], []
    for (scene, way, verdict, reason), some in here.groupby(
        ["scene", "way", "verdict", "reason"], sort=False
    ):
        where = dict.fromkeys([*some.setting, *some.quantity])
        lines.append((f"{scene} {way}".strip(), verdict, ", ".join(filter(None, where)), reason))
    if lines:
        yield Table(("what", "verdict", "where", "reason"), tuple(lines), caption="Without numbers")


def _records(table: pd.DataFrame) -> list[dict[str, Any]]:
    """Rows of a data frame as plain data; missing values are None."""
    return list(table.astype(object).where(table.notna(), None).to_dict("records"))


def _wrapped(text: str) -> str:
    """A paragraph wrapped for a terminal; lines after the first are indented."""
    return fill(text, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
