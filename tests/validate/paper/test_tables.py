"""The printed tables beside what the paper's own equations give."""

from dataclasses import replace

import numpy as np

from pointcoord import Scene
from validate.closed_drawing import closed_drawing
from validate.comparison.compare import compare
from validate.comparison.findings import findings
from validate.paper.errata import ERRATA, erratum_of
from validate.paper.tables import TABLE_2, TABLE_3, compare_with_paper, root_mean_square

ROWS = compare_with_paper()


def test_every_printed_row_stands_at_its_printed_input() -> None:
    """The inputs are printed to 0.01 degrees (two rows to 0.1) and 0.01 mm: half of that, or one digit."""
    assert [row.printed for row in ROWS] == [*TABLE_2, *TABLE_3]
    for row in ROWS:
        assert abs(row.input - row.printed.input) <= (0.05 if row.printed.input > 100 else 0.0101)


def test_the_tables_are_ten_millimetres_off_and_for_one_reason() -> None:
    """The reading of the paper found 10.3 mm r.m.s. per coordinate, mostly a constant in y."""
    assert abs(root_mean_square(ROWS) - 10.3) < 0.05
    gaps = np.array([np.subtract(row.wheel_centre, row.printed.wheel_centre) for row in ROWS])
    assert np.abs(gaps.mean(axis=0)).argmax() == 1
    assert gaps[:, 1].std() < 0.3 * gaps[:, 1].mean()


def test_table_2_reproduces_the_knuckle_rates_but_for_a_sign() -> None:
    """Printed to one or two digits: 0.1 rad/s and 0.15 rad/s^2, but for a slipped sign of omega_x."""
    slipped = [row for row in ROWS if row.printed.table == 2 and row.omega_gap > 0.1]
    assert [row.printed.time for row in slipped] == [0.6]
    mended = np.abs(np.subtract(slipped[0].omega, (-0.2, -0.04, -0.1))).max()  # as the rows around it
    assert mended < 0.1
    assert all(row.alpha_gap < 0.15 for row in ROWS if row.printed.table == 2)


def test_table_3_prints_noise_where_the_knuckle_turns_smoothly() -> None:
    """With theta held the knuckle turns about the line 5-4, from 1.46 rad/s on, and never jumps."""
    printed = [np.linalg.norm(row.omega) for row in TABLE_3]
    assert max(printed) / min(printed) > 40.0


def test_the_errata_measure_what_is_said_of_them() -> None:
    table_1, law, _, _, _, _, noise, *_ = (one.measures for one in ERRATA)
    moved = closed_drawing(Scene.load("bounce")).closing
    assert moved is not None
    assert table_1.endswith(f"closing them moves {moved.point} by {moved.largest:.1f} mm")
    times, printed = np.array([(row.time, row.input) for row in TABLE_3]).T
    as_printed = 150.0 * times + 2.5 * times**2
    off = [np.abs(one - printed).max() for one in (as_printed, [row.input for row in ROWS[len(TABLE_2) :]])]
    assert law == f"up to {off[0]:.2f} mm from the column; the law with 0.025 up to {off[1]:.3f} mm"
    omegas = [(row.printed.omega, row.omega) for row in ROWS if row.printed.table == 3]
    theirs, own = np.linalg.norm(omegas, axis=2).T
    computed = f"computed from {own.min():.2f} to {own.max():.2f} rad/s"
    assert noise == f"printed |omega| between {theirs.min():.2f} and {theirs.max():.2f} rad/s; {computed}"


def test_each_wrong_printed_quantity_stands_beside_its_erratum() -> None:
    found = findings([compare(Scene.load(n), "pointcoord", "printed", n) for n in ("bounce", "steer")])
    causes = {(f.scene, f.quantity): f.erratum for f in found}
    assert "factor 2" in causes["bounce", "acceleration"]
    assert "factor 2" in causes["bounce", "angular_acceleration"]
    assert "0/0" in causes["steer", "angular_velocity"]
    assert "0/0" in causes["steer", "angular_acceleration"]
    assert len(found) == 4


def test_of_each_quantity_that_disagrees_the_row_furthest_off_is_told() -> None:
    outcome = compare(Scene.load("bounce"), "pointcoord", "absolute")
    off = {
        ("acceleration", "wheel_centre"): 2.0,
        ("acceleration", "lower_ball_joint"): 5.0,
        ("velocity", "wheel_centre"): 0.5,
        ("velocity", "tie_rod_outer"): 0.25,
    }
    wrong = [
        replace(row, difference=off[row.quantity, row.name], share=1e9, verdict="disagrees")
        for row in outcome.rows
        if (row.quantity, row.name) in off
    ]
    told = findings(
        [outcome, replace(outcome, rows=tuple(wrong)), replace(outcome, rows=(wrong[0],), scene="again")]
    )
    assert {(f.scene, f.quantity): (f.worst.name, f.worst.difference) for f in told} == {
        (outcome.scene, "acceleration"): ("lower_ball_joint", 5.0),
        (outcome.scene, "velocity"): ("wheel_centre", 0.5),
        ("again", wrong[0].quantity): (wrong[0].name, wrong[0].difference),
    }
    for finding in told[:2]:
        assert finding.erratum == erratum_of(finding.quantity, ("acceleration", "velocity"))
