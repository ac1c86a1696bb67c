"""The arithmetic of the study of cost, on rows whose truth is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from made_rows import alike, dialled, error, grown, measured, study, time

from validate.cost.findings import (
    Race,
    a_configuration,
    crossing,
    crossovers,
    dials,
    findings,
    growths,
    law_of_the_large,
    line,
    power_law,
    races,
    reach,
)
from validate.cost.row import Row


def race(rows: list[Row], quantity: str = "position", accuracy: float = 1e-6) -> Race:
    (one,) = (r for r in races(rows) if (r.quantity, r.accuracy) == (quantity, accuracy))
    return one


def position(way: str, largest: float, solve: float, setting: str = "", **more: float) -> Row:
    return measured("bounce", way, setting, {"position": largest}, solve, output=0.0, **more)


def test_the_cheapest_setting_that_is_accurate_enough_is_taken_and_not_the_coarsest_or_the_quickest() -> None:
    rows = [
        position("series", 1e-2, 1e-6, "coarse"),
        position("series", 1e-7, 9e-6, "enough"),
        position("series", 1e-9, 5e-6, "finer and cheaper"),
        position("series", 1e-12, 2e-5, "finest"),
    ]
    found = reach(rows, "position", 1e-6)
    assert found.setting == "finer and cheaper"
    assert found.time is not None
    assert found.time.median == pytest.approx(5e-6, rel=1e-12)
    assert found.floor == 1e-12
    assert reach(rows, "position", 1e-13).time is None
    assert reach(rows, "position", 1e-13).floor == 1e-12


def test_an_error_as_large_as_the_accuracy_reaches_it_and_the_references_radius_counts() -> None:
    exact = position("newton", 1e-6, 1e-5)
    at = replace(exact, errors={"position": error(1e-6, radius=0.0)})
    beside = replace(exact, errors={"position": error(1e-6, radius=1e-9)})
    assert reach([at], "position", 1e-6).time is not None
    assert reach([beside], "position", 1e-6).time is None


@pytest.mark.parametrize("largest", [2.5, math.nan, math.inf])
def test_a_wrong_number_never_shows_as_quick(largest: float) -> None:
    rows = [position("series", 1e-9, 1e-5), position("printed", largest, 1e-9)]
    one = race(rows)
    assert [r.way for r in one.reached] == ["series"]
    assert [r.way for r in one.missed] == ["printed"]
    assert one.verdict == "only ours"


def test_a_failure_an_omission_and_a_row_without_a_time_are_in_no_race() -> None:
    rows = [
        position("series", 1e-9, 1e-5),
        replace(position("exudyn", 1e-9, 1e-9), status="failed", reason="diverged"),
        replace(position("printed", 1e-9, 1e-9), status="left out", reason="of a strut"),
        replace(position("mujoco", 1e-9, 1e-9), times={}),
        replace(position("relative", 1e-9, 1e-9), configurations=0),
        replace(position("absolute", 1e-9, 1e-9), errors={}, not_given={"position": "it has none"}),
    ]
    one = race(rows)
    assert [r.way for r in one.reached] == ["series"]
    assert {r.way: r.reason for r in one.missed} == {
        "exudyn": "failed: diverged",
        "printed": "left out: of a strut",
        "mujoco": "",
        "relative": "",
        "absolute": "not given: it has none",
    }


def test_rates_cost_their_own_phase_and_positions_do_not() -> None:
    row = measured("bounce", "newton", "", alike(1e-9), solve=5e-6, rates=3e-6, output=1e-6, set_up=1.0)
    for quantity, seconds in (("position", 6e-6), ("acceleration", 9e-6)):
        found = reach([row], quantity, 1e-6)
        assert found.time is not None
        assert found.time.median == pytest.approx(seconds, rel=1e-12)


def test_times_whose_quartiles_overlap_are_a_tie() -> None:
    ours = position("newton", 1e-9, 1.00e-5, spread=0.02)
    near, far = (position("mujoco", 1e-9, seconds, spread=0.02) for seconds in (1.03e-5, 1.05e-5))
    assert race([ours, near]).verdict == "tie"
    assert race([ours, far]).verdict == "ours"
    assert race([position("mujoco", 1e-9, 0.95e-5), ours]).verdict == "other"
    assert race([ours]).verdict == "only ours"
    assert race([far]).verdict == "only others"
    assert race([position("newton", 1.0, 1e-5)]).verdict == "nobody"


def test_the_ratio_is_that_of_the_quickest_of_both_sides() -> None:
    rows = [
        position("series", 1e-9, 4e-6),
        position("newton", 1e-9, 8e-6),
        position("mujoco", 1e-9, 3e-6),
        position("scipy-root", 1e-9, 9e-6),
    ]
    one = race(rows)
    assert one.verdict == "other"
    assert one.ratio == pytest.approx(0.75, rel=1e-12)


@pytest.mark.parametrize("exponent", [-0.25, 0.0, 1.0, 2.9])
def test_the_exponent_of_a_power_law_comes_back(exponent: float) -> None:
    sizes = [10.0, 30.0, 100.0, 300.0]
    fit = power_law(sizes, [7e-3 * size**exponent for size in sizes])
    assert fit is not None
    # Rounding of four logarithms of size 6.
    assert fit.exponent == pytest.approx(exponent, abs=1e-13)
    assert fit.error is not None
    assert fit.error < 1e-13
    assert fit.at(50.0) == pytest.approx(7e-3 * 50.0**exponent, rel=1e-12)


def test_the_standard_error_of_an_exponent_is_that_of_simple_regression() -> None:
    """x = 0, 1, 2, 3 and y = x + (1, -1, -1, 1) r: residuals orthogonal to 1 and x, so S = 4 r^2 / 2 / 5."""
    r = 0.1
    sizes = np.exp([0.0, 1.0, 2.0, 3.0])
    values = np.exp(np.array([0.0, 1.0, 2.0, 3.0]) + r * np.array([1.0, -1.0, -1.0, 1.0]))
    fit = power_law(list(sizes), list(values))
    assert fit is not None
    assert fit.exponent == pytest.approx(1.0, abs=1e-12)
    assert fit.error == pytest.approx(math.sqrt(4 * r**2 / 2 / 5), rel=1e-9)


def test_points_that_make_no_law_have_none() -> None:
    assert power_law([], []) is None
    assert power_law([10.0], [1.0]) is None
    assert power_law([10.0, 10.0], [1.0, 2.0]) is None
    assert power_law([10.0, 20.0, 30.0], [0.0, math.nan, 1.0]) is None
    two = power_law([10.0, 100.0], [1.0, 10.0])
    assert two is not None
    assert two.exponent == pytest.approx(1.0)
    assert two.error is None
    assert law_of_the_large([]) is None


def test_growth_is_fitted_where_fixed_costs_are_left_behind() -> None:
    sizes = [10**k for k in range(2, 8)]
    (found,) = growths(grown("bounce", "series", "", "instants", sizes, fixed=1e-2, each=1e-7, set_up=10.0))
    assert found.fit is not None
    assert (found.fit.smallest, found.fit.largest, found.fit.points) == (1e5, 1e7, 3)
    # At 1e5 the fixed part still doubles the time: log10 2 / 2 less, if there were no point between.
    assert 1.0 - math.log10(2.0) / 2.0 < found.fit.exponent < 1.0
    assert found.points[0] == (100.0, pytest.approx(1e-2 + 1e-5))


def test_the_set_up_of_every_design_counts_and_that_of_a_chain_does_too() -> None:
    for against in ("designs", "unknowns"):
        (found,) = growths(grown("bounce", "series", "", against, [1, 10, 100], 0.0, 1e-3, set_up=0.5))
        assert found.points[0][1] == pytest.approx(0.501)


def test_memory_grows_apart_from_time_and_failures_stop_a_growth_with_their_reason() -> None:
    rows = grown("chain", "relative", "", "unknowns", [15, 150, 1500], 0.0, 1e-8, 2.9, bytes_each=1e4)
    rows[2] = replace(rows[2], status="failed", reason="out of memory", times={}, peak_bytes=None)
    of_time, memory = growths(rows)
    assert (of_time.of, memory.of) == ("time", "memory")
    assert len(of_time.points) == len(memory.points) == 2
    assert of_time.stopped == ((1500.0, "failed: out of memory"),)
    (nothing,) = growths(rows[2:])
    assert nothing.points == ()
    assert nothing.fit is None


def test_a_line_gives_back_its_fixed_part_and_the_part_of_each_instant() -> None:
    fixed, each, misses = line([(n, 3e-3 + 2e-6 * n) for n in (10.0, 1e3, 1e5)])
    assert fixed == pytest.approx(3e-3, rel=1e-9)
    assert each == pytest.approx(2e-6, rel=1e-9)
    assert misses < 1e-9
    # Times that fall, and times that grow faster than a line: neither part becomes negative.
    for times in ([(10.0, 2.0), (1e3, 1.0)], [(10.0, 1.0), (100.0, 100.0)]):
        parts = line(times)
        assert min(parts[:2]) >= 0.0
        assert parts[2] > 0.25


SIZES = [100, 1000, 10000]


def race_of_growth(**ours: float) -> list[Row]:
    """Ours takes 1 ms and 1 us an instant, the other 11 us an instant: they cross at 100."""
    return [
        *grown(
            "bounce", "series", "1e-9 mm", "instants", SIZES, 1e-3, 1e-6, dense=True, largest=1e-10, **ours
        ),
        *grown("bounce", "mujoco", "", "instants", SIZES, 0.0, 1.1e-5, largest=1e-12),
    ]


def test_two_lines_cross_where_fixed_parts_and_slopes_say() -> None:
    found = {(c.quantity, c.accuracy, c.with_set_up): c for c in crossovers(race_of_growth(set_up=4e-3))}
    assert len(found) == 2 * 3 * 2
    one = found["position", 1e-9, False]
    assert one.instants == pytest.approx(100.0, rel=1e-9)
    assert (one.below, one.above, one.measured) == ("mujoco", "series", 1e4)
    counted = found["position", 1e-9, True]
    assert counted.instants == pytest.approx(500.0, rel=1e-9)


def test_a_way_that_is_quicker_at_every_count_has_no_crossover() -> None:
    rows = race_of_growth()
    (one, *_) = crossovers(rows)
    quick = replace(one.ours, fixed=0.0, each=1e-6)
    assert crossing(quick, one.other, False) == (None, "series", "series")
    slow = replace(one.ours, fixed=1e-3, each=2e-5)
    assert crossing(slow, one.other, False) == (None, "mujoco", "mujoco")
    # The same slope: the fixed part decides for ever.
    assert crossing(replace(one.ours, each=one.other.each), one.other, False) == (None, "mujoco", "mujoco")


def test_a_growth_that_is_not_accurate_enough_or_not_straight_tells_no_crossover() -> None:
    rows = race_of_growth()
    wrong = [replace(r, errors={"position": error(1e-4)}) if r.way == "mujoco" else r for r in rows]
    assert {c.accuracy for c in crossovers(wrong)} == {1e-3}
    bent = [
        *rows[:3],
        *grown("bounce", "mujoco", "", "instants", SIZES, 0.0, 1e-6, 2.0, largest=1e-12),
    ]
    assert crossovers(bent) == []
    assert crossovers([*rows[:3], *rows[3:5]]) == []  # two sizes fit any line


def test_the_errors_of_the_same_scene_way_and_setting_vouch_for_a_growth_without_any() -> None:
    rows = [replace(row, errors={}) for row in race_of_growth()]
    assert crossovers(rows) == []
    known = [
        measured("bounce", "series", "1e-9 mm", alike(1e-10), 1e-6),
        measured("bounce", "mujoco", "", {"position": 1e-5}, 1e-6),
    ]
    assert {(c.quantity, c.accuracy) for c in crossovers([*rows, *known])} == {("position", 1e-3)}


def test_the_slope_of_a_dial_comes_back_and_a_flat_one_does_not_turn() -> None:
    steep, flat = dials(
        [
            *dialled("bounce", "series", 4e-6, 0.05, 0.0, output=0.0),
            *dialled("bounce", "newton", 6e-5, 0.0, 0.0, output=0.0),
        ]
    )
    assert steep.fit.exponent == pytest.approx(-0.05, abs=1e-12)
    assert steep.a_digit == pytest.approx(10.0**0.05, rel=1e-10)
    assert steep.settings == ("1e-02 mm", "1e-13 mm")
    assert steep.turns
    assert not flat.turns


def test_a_dial_whose_ends_are_apart_by_less_than_their_quartiles_does_not_turn() -> None:
    (one,) = dials(dialled("bounce", "series", 4e-6, 0.001, 0.0, output=0.0, spread=0.05))
    assert one.fit.exponent == pytest.approx(-0.001, abs=1e-12)
    assert not one.turns


def test_a_time_that_is_not_there_is_none_and_not_nothing() -> None:
    row = position("series", 1e-9, 1e-5)
    assert a_configuration(row, ("solve", "missing")) is None
    assert a_configuration(replace(row, times={"solve": time(math.nan)}), ("solve",)) is None
    assert a_configuration(replace(row, status="failed"), ("solve",)) is None


def test_the_whole_study_has_a_race_for_every_scene_quantity_and_accuracy() -> None:
    found = findings(study())
    assert len(found.races) == 2 * 5 * 3
    assert {g.against for g in found.growths} == {"instants", "designs", "unknowns"}
    rates = [g for g in found.growths if g.against == "unknowns" and g.of == "time"]
    assert [round(g.fit.exponent, 6) for g in rates if g.fit] == [1.1, 2.9]
    assert findings([]).races == ()
