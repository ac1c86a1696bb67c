"""The table of a comparison shows what its columns say, whichever number is closest to its tolerance."""

from dataclasses import replace

import pytest

from pointcoord import Scene
from validate.comparison.compare import Outcome, compare
from validate.output.report import HEAD, heading, outcome_parts
from validate.output.table import Table
from validate.tables.units import degrees_of

NAME = "bounce-on-a-heaving-chassis"
HEAVING = compare(Scene.load(NAME), "pointcoord", "absolute", NAME)


def lines_of(outcome: Outcome) -> dict[str, list[str]]:
    """The table's cells by quantity."""
    (table,) = (part for part in outcome_parts(outcome) if isinstance(part, Table))
    assert table.head == HEAD
    return {quantity: [*cells] for quantity, *cells in table.texts}


def test_the_largest_difference_is_the_largest_and_the_share_is_of_the_worst() -> None:
    apart = 0
    for quantity, (where, difference, held, _, used, *_) in lines_of(HEAVING).items():
        rows = [row for row in HEAVING.rows if heading(row.quantity, row.name) == quantity]
        largest = max(rows, key=lambda row: row.difference)
        worst = max(rows, key=lambda row: row.share)
        factor, unit = degrees_of(largest.unit)
        assert difference == f"{factor * largest.difference:.1e} {unit}"
        assert where in ("", largest.name)
        assert float(held) == pytest.approx(factor * largest.tolerance, rel=0.06)
        assert used == f"{100.0 * worst.share:.0f}%"
        apart += largest is not worst
    assert apart  # The scene where the two are different numbers is the one to ask.


def test_a_fault_that_is_smaller_than_another_point_s_rounding_is_named() -> None:
    faults = {"wheel_centre": (1e-3, 0.5, "agrees"), "strut_top": (1e-6, 70.0, "disagrees")}
    rows = []
    for row in HEAVING.rows:
        if row.quantity == "position":
            difference, share, verdict = faults.get(row.name, (0.0, 0.0, "agrees"))
            rows.append(replace(row, difference=difference, share=share, verdict=verdict))
    where, difference, _, _, used, _, verdict = lines_of(replace(HEAVING, rows=tuple(rows)))["position"]
    assert (where, difference, used) == ("wheel_centre", "1.0e-03 mm", "70 times")
    assert verdict == "DISAGREES: strut_top"
