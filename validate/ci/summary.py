"""The summary of a run in Markdown, which services for continuous integration show with the run.

Names and messages are escaped: characters that could be Markdown or HTML become character references.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validate.ci import verdict
from validate.ci.record import Record
from validate.exit_status import MEANINGS, ExitStatus
from validate.output.table import Cell, Table, markdown

# Services limit the size of a summary (GitHub: 1 MiB a step); a line has some 200 characters.
LISTED = 200
ROWS = 500


def summary(record: Record, status: ExitStatus) -> str:
    """The Markdown of a run that ends with a status."""
    return "\n\n".join(_blocks(record, status)) + "\n"


def _blocks(record: Record, status: ExitStatus) -> Iterator[str]:
    yield "## pointcoord validate"
    meaning = f"exit status {status.value}: {markdown(MEANINGS[status])}"
    yield f"**{status.verdict.capitalize()}**: {markdown(verdict.sentence(record))} ({meaning})."
    rows = map(verdict.scene_row, sorted(record.examined, key=lambda one: one.status == 0)[:ROWS])
    yield Table(
        verdict.HEAD, tuple((name, Cell(word, "", word), text.strip()) for name, word, text in rows)
    ).markdown
    if (more := len(record.examined) - ROWS) > 0:
        yield f"and {more} more scenes: --json has them all"
    yield from _list("What disagrees", verdict.by_scene(record, verdict.disagreements))
    yield from _list("Without a verdict", verdict.by_scene(record, verdict.undecided))
    yield from _list("Not compared", verdict.by_scene(record, verdict.complaints))
    if record.baseline is not None:
        lines = [f"{one.scene}: {line}" for one in record.since for line in verdict.since_lines(one)]
        lines += [one.words for one in record.gone]
        yield from _list(f"Since the baseline {record.baseline.target}", lines)


def _list(title: str, lines: Sequence[str]) -> Iterator[str]:
    """The first lines as a list with a title; nothing if there are no lines."""
    if lines:
        yield f"### {markdown(title)}"
        more = [f"- and {len(lines) - LISTED} more"] if len(lines) > LISTED else []
        yield "\n".join([*(f"- {markdown(line)}" for line in lines[:LISTED]), *more])
