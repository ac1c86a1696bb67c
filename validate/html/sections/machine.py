"""Where the numbers come from: command, versions, machine, settings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.report import held_to, pair_of
from validate.output.table import Table
from validate.plain_text import shown


def _blocks(run: Run) -> Sequence[Block]:
    document = run.document
    told = {
        "command": document["command_line"],
        "program": " ".join(document["program"].values()),
        **({} if document["started"] is None else {"started": document["started"]}),
        "exit status": f"{document['exit_status']}, {document['verdict']}",
        **dict(_settings(run)),
        # Where times were measured stands with them; where the page is made tells nothing of them.
        **({} if run.head.kind == "cost" else dict(_flat(document["machine"]))),
    }
    rows = tuple((name, shown(value)) for name, value in told.items())
    return [Table(("what", "value"), rows, caption="What this page was made by.")]


def _settings(run: Run) -> Iterator[tuple[str, str]]:
    if pairs := dict.fromkeys(map(pair_of, run.record.outcomes)):
        yield "compared", "; ".join(pairs)
    if run.record.examined:
        yield "differences", held_to(run.record.factor)


def _flat(data: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    """Names and values of plain data; a value that is a mapping stands for its own."""
    for name, value in data.items():
        if isinstance(value, Mapping):
            yield from _flat(value)
        else:
            yield name, "not there" if value is None else str(value)


SECTION = Section("machine", "Machine, versions, settings", 900, _blocks, folded=True)
