"""The summary of a run in Markdown, which services for continuous integration show with the run.

Names and messages are escaped: characters that could be Markdown or HTML become character references.
"""

from __future__ import annotations

from collections.abc import Sequence

from validate.ci.record import Record
from validate.ci.verdict import (
    HEAD,
    by_scene,
    complaints,
    disagreements,
    scene_row,
    sentence,
    since_lines,
    undecided,
)
from validate.comparison.examined import Examined
from validate.exit_status import MEANINGS, ExitStatus
from validate.output.table import Cell, Table, markdown

# Services limit the size of a summary (GitHub: 1 MiB a step); a line has some 200 characters.
LISTED = 200
ROWS = 500


def summary(record: Record, status: ExitStatus) -> str:
    """The Markdown of a run that ends with a status."""
    blocks = [
        "## pointcoord validate",
        f"**{status.verdict.capitalize()}**: {markdown(sentence(record))} "
        f"(exit status {status.value}: {markdown(MEANINGS[status])}).",
    ]
    rows = [_row(one) for one in sorted(record.examined, key=lambda one: one.status == 0)[:ROWS]]
    more = len(record.examined) - len(rows)
    blocks += [
        Table(HEAD, tuple(rows)).markdown,
        *([f"and {more} more scenes: --json has them all"] if more else ()),
    ]
    for title, of in (
        ("What disagrees", disagreements),
        ("Without a verdict", undecided),
        ("Not compared", complaints),
    ):
        blocks += _list(f"### {title}", by_scene(record, of))
    if record.baseline is not None:
        lines = [f"{one.scene}: {line}" for one in record.since for line in since_lines(one)]
        lines += [one.words for one in record.gone]
        blocks += _list(f"### Since the baseline {markdown(record.baseline.target)}", lines)
    return "\n\n".join(blocks) + "\n"


def _row(examined: Examined) -> tuple[str, Cell, str]:
    name, verdict, share = scene_row(examined)
    return name, Cell(verdict, verdict=verdict), share.strip()


def _list(title: str, lines: Sequence[str]) -> list[str]:
    """The first lines as a list with a title; nothing if there are no lines."""
    if not lines:
        return []
    more = [f"- and {len(lines) - LISTED} more"] if len(lines) > LISTED else []
    return [title, "\n".join([*(f"- {markdown(line)}" for line in lines[:LISTED]), *more])]
