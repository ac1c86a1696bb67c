"""What the printed formulas get wrong is told by the row of each quantity that is furthest off."""

from dataclasses import replace

from pointcoord import Scene
from validate.comparison.compare import Comparison, Outcome, compare
from validate.comparison.findings import findings
from validate.paper.errata import erratum_of


def test_of_each_quantity_that_disagrees_the_row_furthest_off_is_told() -> None:
    outcome = compare(Scene.load("bounce"), "pointcoord", "absolute")
    differences = {
        ("acceleration", "wheel_centre"): 2.0,
        ("acceleration", "lower_ball_joint"): 5.0,
        ("acceleration", "tie_rod_outer"): 3.0,
        ("velocity", "wheel_centre"): 0.5,
        ("velocity", "tie_rod_outer"): 0.25,
    }

    def spoilt(row: Comparison) -> Comparison:
        off = differences.get((row.quantity, row.name))
        return row if off is None else replace(row, difference=off, share=1e9, verdict="disagrees")

    wrong: Outcome = replace(outcome, rows=tuple(spoilt(row) for row in outcome.rows))
    told = findings([outcome, wrong, replace(wrong, scene="again")])
    assert {(f.scene, f.quantity, f.worst.name, f.worst.difference) for f in told} == {
        (scene, quantity, name, differences[quantity, name])
        for scene in (outcome.scene, "again")
        for quantity, name in (("acceleration", "lower_ball_joint"), ("velocity", "wheel_centre"))
    }
    assert len(told) == 4
    for finding in told:
        assert finding.erratum == erratum_of(finding.quantity, ("acceleration", "velocity"))
