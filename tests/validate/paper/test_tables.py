"""The printed tables beside what the paper's own equations give."""

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


def test_each_wrong_printed_quantity_stands_beside_its_erratum_with_the_row_furthest_off() -> None:
    """All others, such as positions and velocities, are right as printed."""
    outcomes = [compare(Scene.load(n), "pointcoord", "printed", n) for n in ("bounce", "steer")]
    found = {(one.scene, one.quantity): one for one in findings(outcomes)}
    for scene, quantities, words in (
        ("bounce", ("acceleration", "angular_acceleration"), "factor 2"),
        ("steer", ("angular_velocity", "angular_acceleration"), "0/0"),
    ):
        for quantity in quantities:
            one = found.pop((scene, quantity))
            rows = [row for each in outcomes if each.scene == scene for row in each.disagreements]
            assert one.worst.difference == max(row.difference for row in rows if row.quantity == quantity)
            assert words in one.erratum
    assert not found
    assert erratum_of("velocity", ["velocity"]) == "no known erratum: look into it"
