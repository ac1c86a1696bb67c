"""The paper's errata, each with what it measures, and what its formulas as printed get wrong by how much."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Paragraph, Section
from validate.paper.measured_errata import errata


def _blocks(run: Run) -> Sequence[Block]:
    return [*_numbered(run), *_by_scene(run)]


def _numbered(run: Run) -> Iterator[Block]:
    if not run.paper:
        return
    rows = tuple(
        (Cell(str(one.number)), Cell(one.where), Cell(one.wrong), Cell(one.measures or "changes no number"))
        for one in errata(run.paper)
    )
    yield Grid(
        "What is wrong in the paper, and what it measures.", ("no.", "where", "what", "measures"), rows
    )


def _by_scene(run: Run) -> Iterator[Block]:
    tried = [one.examined.name for one in run.told if one.examined.printed is not None]
    rows = tuple(
        (
            Cell(finding.scene),
            Cell(QUANTITIES[finding.quantity].words),
            Cell(_number(finding.worst), finding.worst.name),
            Cell(finding.erratum),
        )
        for finding in run.findings
    )
    head = ("scene", "wrong quantity", "largest difference", "erratum")
    if rows:
        yield Grid("The paper's formulas as printed, against the mended ones.", head, rows)
    elif tried:
        yield Paragraph(f"The paper's printed formulas agree in {', '.join(tried)}.")
    for one in run.told:
        why = one.examined.unprinted
        if why is not None:
            yield Paragraph(f"The formulas as printed cannot solve {one.examined.name}: {why.message}")


def _number(worst: Comparison) -> str:
    # A quotient of nothing by nothing has no size.
    return f"{worst.difference:.1e} {worst.unit}" if math.isfinite(worst.difference) else "not a number"


SECTION = Section("errata", "Errata of the paper", 70, _blocks)
