"""What the scenes are: in their own words, which suspension, at how many instants."""

from __future__ import annotations

from collections.abc import Sequence

from pointcoord import Scene
from validate.comparison.examined import Examined
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Section

# Lines of the table, at most: there may be hundreds of scenes.
MOST = 100


def _blocks(run: Run) -> Sequence[Block]:
    read = [(one.examined, one.scene) for one in run.told if one.scene is not None]
    more = (
        f" The first {MOST} of {len(read)}; the data beside this page have all." if len(read) > MOST else ""
    )
    rows = tuple(_row(examined, scene) for examined, scene in read[:MOST])
    head = ("scene", "title", "suspension", "instants")
    return [Grid(f"What was compared.{more}", head, rows)] if rows else []


def _row(examined: Examined, scene: Scene) -> tuple[Cell, ...]:
    mechanism = scene.mechanism
    return (
        Cell(examined.name),
        Cell(examined.title),
        Cell(mechanism.type.replace("_", " "), f"closed as {mechanism.closure}"),
        Cell(str(len(scene.instants))),
    )


SECTION = Section("scenes", "Scenes", 25, _blocks)
