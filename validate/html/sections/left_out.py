"""What a report can hold and this one does not, with the command that adds it."""

from __future__ import annotations

from collections.abc import Sequence

from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.table import Table


def _blocks(run: Run) -> Sequence[Block]:
    rows = tuple(run.left_out)
    caption = "A page shows what was computed for it, or kept by an earlier run."
    return [Table(("not in this page", "how to add it"), rows, caption=caption)] if rows else []


SECTION = Section("left-out", "Not in this page", 890, _blocks, folded=True)
