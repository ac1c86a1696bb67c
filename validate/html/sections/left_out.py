"""What a report can hold and this one does not, with the command that adds it."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence

from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.table import Table

CAPTION = "A page shows what was computed for it, or kept by an earlier run."


def _blocks(run: Run) -> Sequence[Block]:
    rows = tuple(_rows(run))
    return [Table(("not in this page", "how to add it"), rows, caption=CAPTION)] if rows else []


def _rows(run: Run) -> Iterator[tuple[str, str]]:
    record, command = run.record, shlex.join(run.head.command)
    if not record.examined or record.files:
        # Of a file's scene no motion is solved and no other model.
        yield "scenes in motion, compared by two formulations", "pointcoord report DIR SCENE"
    if run.hard is None:
        yield "hard cases", "pointcoord hard --report DIR"
    elif run.head.kind != "hard" and run.hard.command_line == command:
        yield (
            "more than a few hard cases",
            "pointcoord hard --json hard.json; then pointcoord report DIR --hard hard.json",
        )
    if run.cost is None:
        yield "accuracy against time", "pointcoord cost --report DIR"
    elif run.head.kind != "cost" and run.cost.command == command:
        yield (
            "more than a first look at accuracy against time",
            "pointcoord cost --rows cost.parquet; then pointcoord report DIR --cost cost.parquet",
        )
    if not record.paper:
        yield "the paper's figures, tables and errata", "pointcoord report DIR"
    if not run.published:
        yield "other programs' tables", "pointcoord report DIR"


SECTION = Section("left-out", "Not in this page", 890, _blocks, folded=True)
