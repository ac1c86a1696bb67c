"""The paper's printed tables: its points beside what its own equations give at the same instants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from validate.html.plot import OTHER, OURS, Panel, Plots, axis, numbers
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Paragraph, Section
from validate.paper.tables import WHY_NOT_EQUAL, PaperRow, root_mean_square

HEAD = ("t [s]", "input, printed", "input, ours", "wheel centre apart [mm]", "omega apart", "alpha apart")


def _blocks(run: Run) -> Sequence[Block]:
    if not run.paper:
        return []
    rms = f"Wheel centre, both tables: {root_mean_square(run.paper):.1f} mm r.m.s. per coordinate."
    blocks: list[Block] = [Paragraph(f"{WHY_NOT_EQUAL} {rms}")]
    for table in dict.fromkeys(row.printed.table for row in run.paper):
        rows = [row for row in run.paper if row.printed.table == table]
        blocks.append(Plots(f"Table {table}: crosses as printed, rings as computed", tuple(_panels(rows))))
        cells = tuple(_cells(row) for row in rows)
        blocks.append(Grid(f"Table {table}, printed and computed", (*HEAD, "slip of print"), cells))
    return blocks


def _panels(rows: Sequence[PaperRow]) -> Iterator[Panel]:
    kinds = (
        ("wheel centre", "mm", [(row.printed.wheel_centre, row.wheel_centre) for row in rows]),
        ("omega", "rad/s", [(row.printed.omega, row.omega) for row in rows]),
        ("alpha", "rad/s^2", [(row.printed.alpha, row.alpha) for row in rows]),
    )
    times = numbers(np.array([row.printed.time for row in rows]), 6)
    for words, unit, pairs in kinds:
        values = np.array(pairs)
        for i, component in enumerate("xyz"):
            layout = {"xaxis": axis("time [s]"), "yaxis": axis(f"[{unit}]")}
            looks = (("printed", "x", OTHER), ("computed", "circle-open", OURS))
            traces = tuple(
                {
                    "x": times,
                    "y": numbers(values[:, side, i], 6),
                    "name": name,
                    "mode": "markers",
                    "marker": {"symbol": symbol, "color": colour, "size": 7},
                }
                for side, (name, symbol, colour) in enumerate(looks)
            )
            yield Panel(f"{words}, {component}, over time", traces, layout)


def _cells(row: PaperRow) -> tuple[Cell, ...]:
    texts = (
        f"{row.printed.time:.2f}",
        f"{row.printed.input:g}",
        f"{row.input:.2f}",
        f"{row.position_gap:.1f}",
        f"{row.omega_gap:.2f}",
        f"{row.alpha_gap:.2f}",
        row.printed.slip,
    )
    return tuple(Cell(text) for text in texts)


SECTION = Section("paper", "The paper's printed tables", 60, _blocks)
