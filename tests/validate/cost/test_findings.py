"""What the table says: no wrong number is quick, and overlapping times are a tie.

The report shows it in a table and a picture.
"""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import replace

import pytest
from made_rows import alike, measured, study

from validate.cost.findings import races, sentences
from validate.cost.looks import looks
from validate.cost.picture import headline
from validate.cost.report import Report
from validate.cost.table import Row, frame
from validate.cost.ways.registry import WAYS
from validate.output.table import text_of


def verdicts(rows: Sequence[Row], quantity: str = "position") -> dict[float, str]:
    found = races(frame(rows))
    return {one.accuracy: one.verdict for one in found[found.quantity == quantity].itertuples()}


def raced(
    series: float, other: float, errors: tuple[float, float] = (1e-12, 1e-12), spread: float = 0.02
) -> list[Row]:
    """Two ways with these times and errors."""
    ours = measured("a", "series", "", {"position": errors[0]}, series, spread=spread)
    return ours + measured("a", "relative", "", {"position": errors[1]}, other, spread=spread)


def test_the_quicker_one_wins_and_times_whose_quartiles_overlap_tie() -> None:
    assert set(verdicts(raced(1e-5, 2e-5)).values()) == {"ours"}
    assert set(verdicts(raced(2e-5, 1e-5)).values()) == {"other"}
    assert set(verdicts(raced(1.00e-5, 1.03e-5)).values()) == {"tie"}
    # Intervals that touch are no difference.
    assert set(verdicts(raced(1.0, 3.0, spread=0.5)).values()) == {"tie"}
    found = races(frame(raced(1e-5, 2e-5)))
    assert found.ratio.tolist() == pytest.approx([2.0] * 3)
    assert [one["way"] for one in found.reached[0]] == ["series", "relative"]


def test_a_wrong_number_is_never_quick() -> None:
    found = verdicts(raced(1e-9, 1e-3, errors=(1e-4, 1e-12)))
    assert found == {1e-3: "ours", 1e-6: "only others", 1e-9: "only others"}
    assert set(verdicts(raced(1e-9, 1e-3, errors=(1.0, 1.0))).values()) == {"nobody"}


def test_the_references_own_radius_counts_as_error() -> None:
    rows = [replace(row, radius=1e-9) for row in raced(1e-5, 2e-5, errors=(0.5e-9, 0.0))]
    assert verdicts(rows)[1e-9] == "only others"
    assert verdicts(rows)[1e-6] == "ours"


def test_three_sentences_say_who_is_quickest_what_digits_cost_and_where_others_win() -> None:
    quickest, digits, won = sentences(frame(study()))
    assert "methods take series 8.95 us to 14.3 us, mujoco 37 us" in quickest
    assert quickest.endswith("; not reached by scipy-root, printed.")
    assert "11 digits" in digits
    assert digits.endswith("series 3.5, newton 1.3.")
    assert "Of 30 races" in won
    assert "methods other than pointcoord's win 0" in won
    # Where another way is quicker it is named.
    assert "win 3 (relative)" in sentences(frame(raced(2e-5, 1e-5)))[-1]


ROWS = tuple(study())
REPORT = Report("rows.parquet", "pointcoord cost --from-rows", ROWS)


def test_the_table_has_the_quickest_way_first_and_what_is_not_reached() -> None:
    table, without = REPORT.tables
    assert table.head == ("method", "bounce", "double-wishbone")
    assert table.rows[0] == ("series*", "8.95 us", "14.3 us")
    reached = {way: of for way, *of in table.rows}
    assert reached["printed"] == ["not reached", "-"]
    assert reached["scipy-root"] == ["not reached"] * 2
    assert [row[0] for row in without.rows][-1] == "double-wishbone printed"
    assert "one solve serves any instant" in text_of(REPORT.parts())
    # A scene of which nothing is exact has its column.
    rows = (*ROWS, *measured("elsewhere", "newton", "coarse", alike(1.0), 1e-5))
    table, *_ = replace(REPORT, rows=rows).tables
    assert table.head[-1] == "elsewhere"
    assert {of[-1] for of in table.rows} == {"not reached", "-"}


def test_a_picture_has_a_place_for_an_error_of_exactly_nothing_and_of_no_rows_there_is_none() -> None:
    assert ET.fromstring(REPORT.headline() or "").tag.endswith("svg")
    assert Report("", "", ()).headline() is None
    rows = measured("a", "series", "", {"position": 0.0}, 1e-5) + measured("a", "map", "", alike(1e-9), 1e-5)
    page = headline(Report("", "", tuple(rows)).table)
    assert page is not None
    assert "exactly 0 at the lower edge" in page.axes[0].get_title(loc="left")
    assert min(float(min(line.get_ydata())) for line in page.axes[0].lines if line.get_zorder() == 3) == 1e-10


def test_no_two_ways_share_a_line_or_a_mark_and_new_ones_have_looks_too() -> None:
    names = [way.name for way in WAYS]
    found = looks([*names, "mine", "yours"])
    assert len({(look.colour, look.dash) for look in found.values()}) == len(names) + 2
    assert len({look.marker for look in found.values()}) == len({look.symbol for look in found.values()})
    assert len({look.marker for look in found.values()}) == len(names) + 2
    assert looks(["mujoco"])["mujoco"] == found["mujoco"]
