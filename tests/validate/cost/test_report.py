"""The report of made rows: everything that was measured, failed or left out is in it, and nothing else."""

import csv
import io
import json
import math
import re
from dataclasses import replace

import pytest
from made_rows import HEADER, alike, dialled, error, measured, study

from validate.cost.findings import findings
from validate.cost.report import NOTHING, Report
from validate.cost.row import Row
from validate.cost.tables import csv_text, full_tables, short_tables
from validate.output.terminal import text_of

ROWS = tuple(study())


def report(rows: tuple[Row, ...] = ROWS) -> Report:
    return Report("rows.jsonl", HEADER, "pointcoord cost", False, rows)


def test_machine_versions_threads_and_command_are_at_the_top_of_every_report() -> None:
    one = report()
    for text in (one.text(), one.markdown().replace("\\", "")):
        head = text.partition("Races:")[0]
        for words in (
            HEADER.machine,
            HEADER.program,
            "numpy 2.0.0",
            "OMP_NUM_THREADS 1",
            "pointcoord cost",
            "rows.jsonl",
        ):
            assert words in head


def test_sentences_come_before_tables() -> None:
    for text in (report().text(), report().markdown()):
        assert text.index("Races:") < text.index("time of a configuration to reach")


def test_a_terminal_of_120_columns_holds_the_text() -> None:
    long = dialled("bounce", "least-squares-jac", 1e-3, 0.1, 1e-13)
    long = [replace(row, setting=f"xtol, ftol, gtol {row.setting}") for row in long]
    assert max(len(line) for line in report((*ROWS, *long)).text().splitlines()) <= 120


def test_failures_and_omissions_stand_with_their_reasons_and_are_in_no_mean() -> None:
    for text in (report().text(), report().markdown()):
        assert "exudyn: failed: no convergence at 1.25 s" in text
        assert "printed: left out: the paper's formulas are of a strut" in text
        assert "mujoco, scipy-root" not in text  # they give positions and are asked for nothing else
        assert "1500 unknowns: left out: would take an hour" in text
    states = [row["status"] for row in csv.DictReader(io.StringIO(csv_text(ROWS)))]
    assert (states.count("failed"), states.count("left out")) == (2, 2)


def test_a_quantity_that_is_not_given_and_a_row_measured_otherwise_have_their_reasons() -> None:
    rows = (
        replace(
            measured("bounce", "mujoco", "", {"position": 1e-12}, 1e-5), not_given={"velocity": "it has none"}
        ),
        replace(measured("bounce", "scipy-root", "", alike(1e-9), 1e-5), reason="at 8 of the 200 instants"),
    )
    text = report(rows).text()
    assert "mujoco: velocity not given: it has none" in text
    assert "scipy-root: at 8 of the 200 instants" in text


def test_errors_that_are_exactly_0_or_no_number_look_like_what_they_are() -> None:
    row = measured("bounce", "absolute", "", alike(1e-13), 1e-5)
    row = replace(row, errors={"position": error(0.0), "velocity": error(math.nan)})
    text = report((row,)).text()
    assert re.search(r"^absolute +0 +not a number ", text, flags=re.M)


def test_fewer_numbers_than_others_give_are_told() -> None:
    whole = measured("bounce", "newton", "", {"position": 1e-12}, 1e-5)
    part = replace(measured("bounce", "mujoco", "", {}, 1e-5), errors={"position": error(1e-12, numbers=300)})
    assert "position over fewer than 900 numbers: mujoco 300" in report((whole, part)).text()


def test_the_csv_gives_back_every_number_to_the_last_bit() -> None:
    lines = list(csv.DictReader(io.StringIO(csv_text(ROWS))))
    assert len(lines) == len(ROWS)
    for line, row in zip(lines, ROWS, strict=True):
        assert (line["part"], line["scene"], line["way"], line["setting"]) == (
            row.part,
            row.scene,
            row.way,
            row.setting,
        )
        for quantity, found in row.errors.items():
            assert float(line[f"{quantity}_largest"]) == found.largest
            assert float(line[f"{quantity}_rms"]) == found.rms
        for phase, time in row.times.items():
            assert (float(line[f"{phase}_median_s"]), float(line[f"{phase}_lower_s"])) == (
                time.median,
                time.lower,
            )
        seconds = row.seconds("solve")
        assert line["solve_s_per_configuration"] == ("" if seconds is None else repr(seconds))


def test_every_measured_setting_is_in_the_full_tables_and_the_short_ones_say_how_many_are_not() -> None:
    found = findings(ROWS)
    full = "\n".join(table.markdown() for table in full_tables(ROWS, found))
    for row in ROWS:
        if row.part == "accuracy" and row.status == "measured":
            assert f"{row.way}{'*' if row.dense else ''} {row.setting}".strip() in full
    assert "24 further settings" in "\n".join(text_of(table.parts()) for table in short_tables(ROWS, found))


def test_the_way_to_an_accuracy_is_its_cheapest_setting_in_the_table_and_what_is_not_reached_says_so() -> (
    None
):
    (table, *_) = short_tables(ROWS, findings(ROWS))
    lines = {line[0]: line for line in table.rows}
    assert lines["series*"][3] == "9.05 us (1e-9)"
    assert lines["scipy-root"][3] == "not reached"
    assert lines["printed"][1:] == ("not reached", "not reached", "not reached", "2.5e+00")
    assert [line[0] for line in table.rows][:2] == ["series*", "mujoco"]


def test_growth_and_loading_are_in_the_report() -> None:
    text = report().text()
    assert re.search(r"relative +time +2.900 \+- 0.000 +15 to 500 +500", text)
    assert re.search(r"series 1e-09 mm +time +0.99\d \+- ", text)
    assert re.search(r"import pointcoord +import +150 ms", text)


def test_the_same_rows_make_the_same_bytes() -> None:
    one, two = report(), report()
    assert one.text() == two.text()
    assert dict(one.files()) == dict(two.files())


def test_a_folder_has_a_picture_of_every_scene_and_growth_in_both_forms_and_the_page_shows_them() -> None:
    files = dict(report().files())
    names = {"headline", "error-time-bounce", "error-time-double-wishbone", "growth-instants-bounce"}
    names |= {"growth-designs-bounce", "growth-unknowns-chain"}
    assert {name for name in files if name.endswith((".svg", ".png"))} == {
        f"{name}.{ending}" for name in names for ending in ("svg", "png")
    }
    page = files["report.md"].decode()
    assert set(re.findall(r"\]\((\S+\.svg)\)", page)) == {f"{name}.svg" for name in names}
    assert files["headline.svg"].startswith(b"<?xml")
    assert b"<dc:date>" not in files["headline.svg"]
    assert files["headline.png"].startswith(b"\x89PNG")
    assert len(json.loads(files["rows.json"])["rows"]) == len(ROWS)


def test_scenes_whose_names_make_the_same_file_have_a_file_each() -> None:
    rows = tuple(measured(name, "series", "", alike(1e-12), 1e-5) for name in ("a/b.toml", "c/b.toml"))
    assert {"error-time-b.svg", "error-time-b-2.svg"} <= dict(report(rows).files()).keys()


@pytest.mark.parametrize(
    "rows", [(), (Row("accuracy", "bounce", "series", status="failed", reason="locked"),)]
)
def test_a_report_of_nothing_says_so(rows: tuple[Row, ...]) -> None:
    one = report(rows)
    assert NOTHING in one.text()
    files = dict(one.files())
    assert not [name for name in files if name.endswith(".svg")]
