"""What a report can hold and this one does not, with the command that adds it."""

from __future__ import annotations

from collections.abc import Sequence

from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Section


def _blocks(run: Run) -> Sequence[Block]:
    rows = tuple((Cell(what), Cell(command)) for what, command in run.left_out)
    caption = "A page shows what was computed for it, or kept by an earlier run."
    return [Grid(caption, ("not in this page", "how to add it"), rows)] if rows else []


SECTION = Section("left-out", "Not in this page", 890, _blocks)
