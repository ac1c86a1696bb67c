"""The table of a comparison shows what its columns say, whichever number is closest to its tolerance."""

from dataclasses import replace

import pytest

from pointcoord import Scene
from validate.comparison.compare import Outcome, compare
from validate.output.report import HEAD, heading, outcome_parts
from validate.output.table import Table
from validate.tables.units import degrees_of


@pytest.fixture(scope="module")
def heaving() -> Outcome:
    scene = "bounce-on-a-heaving-chassis"
    return compare(Scene.load(scene), "pointcoord", "absolute", scene)


def lines_of(outcome: Outcome) -> dict[str, list[str]]:
    """The table's cells by quantity."""
    (table,) = (part for part in outcome_parts(outcome) if isinstance(part, Table))
    assert table.head == HEAD
    return {quantity: [*cells] for quantity, *cells in table.texts}


def of_position(outcome: Outcome, **changes: tuple[float, float, str]) -> Outcome:
    """Other differences, shares and verdicts of some points, and no other quantity."""
    rows = []
    for row in outcome.rows:
        if row.quantity == "position":
            difference, share, verdict = changes.get(row.name, (0.0, 0.0, "agrees"))
            rows.append(replace(row, difference=difference, share=share, verdict=verdict))
    return replace(outcome, rows=tuple(rows))


def test_the_largest_difference_is_the_largest_and_the_share_is_of_the_worst(heaving: Outcome) -> None:
    lines = lines_of(heaving)
    apart = 0
    for quantity, (where, difference, held, _, used, *_) in lines.items():
        rows = [row for row in heaving.rows if heading(row.quantity, row.name) == quantity]
        largest = max(rows, key=lambda row: row.difference)
        worst = max(rows, key=lambda row: row.share)
        factor, unit = degrees_of(largest.unit)
        assert difference == f"{factor * largest.difference:.1e} {unit}"
        assert where in ("", largest.name)
        assert float(held) == pytest.approx(factor * largest.tolerance, rel=0.06)
        assert used == f"{100.0 * worst.share:.0f}%"
        apart += largest is not worst
    assert apart  # The scene where the two are different numbers is the one to ask.


def test_a_fault_that_is_smaller_than_another_point_s_rounding_is_named(heaving: Outcome) -> None:
    wrong = of_position(heaving, wheel_centre=(1e-3, 0.5, "agrees"), strut_top=(1e-6, 70.0, "disagrees"))
    where, difference, _, _, used, _, verdict = lines_of(wrong)["position"]
    assert (where, difference, used) == ("wheel_centre", "1.0e-03 mm", "70 times")
    assert verdict == "DISAGREES: strut_top"
