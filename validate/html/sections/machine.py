"""Where the numbers come from: command, versions, machine, settings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.report import held_to, pair_of
from validate.output.table import Table
from validate.plain_text import shown


def _blocks(run: Run) -> Iterator[Block]:
    rows = tuple((name, shown(value)) for name, value in _told(run))
    yield Table(("what", "value"), rows, caption="What this page was made by.")


def _told(run: Run) -> Iterator[tuple[str, str]]:
    document = run.document
    yield "command", document["command_line"]
    yield "program", " ".join(document["program"].values())
    if document["started"] is not None:
        yield "started", document["started"]
    yield "exit status", f"{document['exit_status']}, {document['verdict']}"
    if pairs := dict.fromkeys(map(pair_of, run.record.outcomes)):
        yield "compared", "; ".join(pairs)
    if run.record.examined:
        yield "differences", held_to(run.record.factor)
    # Where times were measured stands with them; where the page is made tells nothing of them.
    if run.head.kind != "cost":
        yield from _flat(document["machine"])


def _flat(data: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of plain data; a value that is a mapping stands for its own."""
    for name, value in data.items():
        if isinstance(value, Mapping):
            yield from _flat(value)
        else:
            yield name, "not there" if value is None else str(value)


SECTION = Section("machine", "Machine, versions, settings", 900, _blocks, folded=True)
