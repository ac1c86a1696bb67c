"""What the scenes are: in their own words, which suspension, at how many instants."""

from __future__ import annotations

from collections.abc import Sequence

from pointcoord import Scene
from validate.comparison.examined import Examined
from validate.html.run import Run
from validate.html.section import Block, Section
from validate.output.table import Cell, Table

# Lines of the table, at most: there may be hundreds of scenes.
MOST = 100


def _blocks(run: Run) -> Sequence[Block]:
    scenes = run.record.scenes
    read = [(one, scenes[one.name]) for one in run.record.examined if one.name in scenes]
    more = (
        f" The first {MOST} of {len(read)}; the data beside this page have all." if len(read) > MOST else ""
    )
    rows = tuple(_row(examined, scene) for examined, scene in read[:MOST])
    head = ("scene", "title", "suspension", "instants")
    return [Table(head, rows, caption=f"What was compared.{more}")] if rows else []


def _row(examined: Examined, scene: Scene) -> tuple[str | Cell, ...]:
    mechanism = scene.mechanism
    return (
        examined.name,
        examined.title,
        Cell(mechanism.name.replace("_", " "), f"closed as {mechanism.closure}"),
        str(len(scene.instants)),
    )


SECTION = Section("scenes", "Scenes", 50, _blocks, folded=True)
