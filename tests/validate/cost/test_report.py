"""The report shows what the rows hold, in tables, pages, pictures and data; the same rows, the same bytes."""

import csv
import io
import xml.etree.ElementTree as ET

from made_rows import alike, measured, study

from validate.cost.looks import looks
from validate.cost.picture import headline
from validate.cost.report import NOTHING, Report
from validate.cost.table import Row
from validate.cost.ways.registry import WAYS
from validate.output.table import markdown

ROWS = tuple(study())
REPORT = Report("rows.parquet", "pointcoord cost --from-rows", False, ROWS)


def test_a_table_has_the_quickest_way_first_and_the_dialled_number() -> None:
    (table, *_) = [one for one in REPORT.tables() if one.caption.startswith("bounce")]
    first, second = table.rows[:2]
    assert first[:4] == ("series*", "4.49 us (1e-3)", "6.34 us (1e-6)", "8.95 us (1e-9)")
    assert second[0] == "mujoco"
    reached = {row[0]: row for row in table.rows}
    assert reached["printed"][1:4] == ("not reached",) * 3
    assert reached["scipy-root"][3:5] == ("not reached", "2.0e-08")
    assert "one solve serves any instant" in REPORT.text()


def test_the_csv_is_the_long_table_with_every_digit() -> None:
    lines = list(csv.DictReader(io.StringIO(REPORT.csv())))
    assert len(lines) == len(ROWS)
    for line, row in zip(lines, ROWS, strict=True):
        assert line["way"] == row.way
        assert float(line["time"] or 0.0) == (row.time or 0.0)
        assert line["size"] == ("" if row.size is None else str(row.size))


def test_a_folder_has_the_picture_and_all_tables() -> None:
    found = dict(REPORT.files())
    assert found.keys() == {"headline.svg", "report.md", "table.csv", "rows.json"}
    assert ET.fromstring(found["headline.svg"]).tag.endswith("svg")
    assert b"](headline.svg)" in found["report.md"]
    assert all(markdown(table.caption).encode() in found["report.md"] for table in REPORT.tables())


def test_an_error_of_exactly_nothing_has_a_place_and_is_told() -> None:
    rows = measured("a", "series", "", {"position": 0.0}, 1e-5) + measured("a", "map", "", alike(1e-9), 1e-5)
    page = headline(Report("", "", False, tuple(rows)).table)
    assert page is not None
    assert "exactly 0 at the lower edge" in page.axes[0].get_title(loc="left")
    assert min(float(min(line.get_ydata())) for line in page.axes[0].lines if line.get_zorder() == 3) == 1e-10


def test_nothing_measured_is_said_and_draws_nothing() -> None:
    nothing = Report("rows", "", False, (Row("accuracy", "a", "series", verdict="failed", reason="locked"),))
    assert NOTHING in nothing.text()
    assert "failed" in nothing.text()
    assert "locked" in nothing.text()
    assert nothing.headline() is None


def test_no_two_ways_share_a_line_or_a_mark_and_new_ones_have_looks_too() -> None:
    names = [way.name for way in WAYS]
    found = looks([*names, "mine", "yours"])
    assert len({(look.colour, look.dash) for look in found.values()}) == len(names) + 2
    assert len({look.marker for look in found.values()}) == len({look.symbol for look in found.values()})
    assert len({look.marker for look in found.values()}) == len(names) + 2
    assert looks(["mujoco"])["mujoco"] == found["mujoco"]
