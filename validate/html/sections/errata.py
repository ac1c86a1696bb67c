"""What the paper's formulas as printed get wrong, each with its erratum and by how much."""

from __future__ import annotations

import math
from collections.abc import Sequence

from pointcoord.effects.registry import QUANTITIES
from validate.comparison.compare import Comparison
from validate.html.run import Run
from validate.html.section import Block, Cell, Grid, Paragraph, Section


def _blocks(run: Run) -> Sequence[Block]:
    tried = [one.examined.name for one in run.told if one.examined.printed is not None]
    refused = [
        Paragraph(
            f"The formulas as printed cannot solve {one.examined.name}: {one.examined.unprinted.message}"
        )
        for one in run.told
        if one.examined.unprinted is not None
    ]
    if not tried:
        return refused
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
    if not rows:
        return [Paragraph(f"The paper's printed formulas agree in {', '.join(tried)}."), *refused]
    return [Grid("The paper's formulas as printed, against the mended ones.", head, rows), *refused]


def _number(worst: Comparison) -> str:
    # A quotient of nothing by nothing has no size.
    return f"{worst.difference:.1e} {worst.unit}" if math.isfinite(worst.difference) else "not a number"


SECTION = Section("errata", "Errata of the paper", 70, _blocks)
