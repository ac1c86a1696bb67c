"""Tables that other programs printed: both models give every number, and a wrong digit is found."""

import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest
from program import document

from validate.cli import main
from validate.measured.reading import read_columns
from validate.published import tables as room
from validate.published.tables import FOLDER, MODELS, RULES, compare_table

TABLES = {table.name: table for table in room.tables()}
HELD = [
    (name, column) for name, table in TABLES.items() for column in table.columns if column not in table.open
]


@pytest.fixture
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The room's files, to be spoilt."""
    target = tmp_path / "tables"
    shutil.copytree(FOLDER, target, ignore=shutil.ignore_patterns("*.py", "__pycache__"))
    monkeypatch.setattr(room, "FOLDER", target)
    return target


def planted(file: Path, name: str, by: float, row: int = 0) -> None:
    """Add to a printed number, in its last digits."""
    head, *lines = file.read_text().splitlines()
    place = [cell.partition(" [")[0] for cell in head.split(",")].index(name)
    cells = lines[row].split(",")
    decimals = len(cells[place].partition(".")[2])
    cells[place] = f"{float(cells[place]) + by:.{decimals}f}"
    lines[row] = ",".join(cells)
    file.write_text("\n".join([head, *lines]) + "\n")


@pytest.mark.parametrize(
    ("name", "column", "apart"),
    [
        ("lotus-bump", "damper ratio", 5.14e-4),
        ("lotus-roll-centre", "roll centre y", 0.917),
    ],
)
def test_a_column_whose_rule_is_not_known_decides_nothing_and_its_distance_is_told(
    name: str, column: str, apart: float
) -> None:
    found = compare_table(TABLES[name])
    (one,) = (c for c in found.columns if c.name == column)
    assert found.agreed
    assert one.verdict == "rule not known"
    assert [row.difference for row in one.rows] == pytest.approx([apart] * 2, rel=2e-3)
    assert any(column in note and one.open in note for note in found.outcomes[0].notes)


@pytest.mark.parametrize("part", [slice(0, None, 2), slice(1, None, 2)], ids=["even", "odd"])
@pytest.mark.parametrize("name", dict(HELD))
def test_both_models_give_every_column_to_its_last_digit_and_one_wrong_digit_makes_that_column_disagree(
    name: str, part: slice, copy: Path
) -> None:
    """Every second column is spoilt; the others agree."""
    columns = read_columns(str(copy / f"{name}.csv"))
    row = len(columns.rows) // 3
    spoilt = [column for table, column in HELD if table == name][part]
    for column in spoilt:
        accuracy = TABLES[name].accuracy.get(column)
        # One unit of the last digit; of numbers in full the first digit that their accuracy answers for.
        step = columns.steps[columns.names.index(column), row] if accuracy is None else 5.0 * accuracy
        planted(copy / f"{name}.csv", column, step, row)
    found = compare_table(TABLES[name])
    wrong = [one for one in found.columns if one.verdict == "disagrees"]
    assert [one.name for one in wrong] == spoilt
    for one in (one for column in wrong for one in column.rows):
        assert (one.verdict, one.instant) == ("disagrees", columns.values[0, row])
    assert all([one.second for one in column.rows] == list(MODELS) for column in found.columns)


def test_a_wrong_digit_ends_the_program_with_status_1_and_is_named_in_words_json_and_junit(
    copy: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    json_file, junit = tmp_path / "results.json", tmp_path / "junit.xml"
    words = ["validate", "--tables", "--json", str(json_file), "--junit", str(junit)]
    planted(copy / "lotus-bump-lengths.csv", "damper travel", 0.01)
    assert main(words) == 1
    said = capsys.readouterr().out
    assert f"{len(HELD) - 1} of {len(HELD)} printed columns agree" in said
    assert "disagrees: Lotus: lengths over bump, damper travel" in said
    (line,) = (line for line in said.splitlines() if "DISAGREES" in line)
    assert "bump -37.5 mm" in line
    scenes = document(json_file)["scenes"]
    rows = [row for one in scenes for pair in one["comparisons"] for row in pair["rows"]]
    wrong = {(row["scene"], row["name"]) for row in rows if row["verdict"] == "disagrees"}
    assert wrong == {("lotus-bump-lengths", "damper_travel")}
    cases = ElementTree.parse(junit).iter("testcase")
    assert [case.get("name") for case in cases if case.findall("failure")] == ["damper_travel"] * 2


def test_a_row_at_another_place_than_its_first_column_says_is_refused_in_a_line(
    copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    planted(copy / "lotus-bump.csv", "bump", 1.0, 3)
    assert main(["validate", "--tables"]) == 2
    error = capsys.readouterr().err
    assert "lotus-bump.csv: bump: is not in even steps" in error
    assert len(error.splitlines()) == 1


def test_every_column_has_a_meaning_and_every_table_a_source_and_a_licence() -> None:
    every = {number for table in TABLES.values() for number in table.columns.values()}
    assert set(RULES) <= every
    for name, table in TABLES.items():
        assert set(read_columns(str(FOLDER / f"{name}.csv")).names[1:]) == set(table.columns)
        assert set(table.open) | set(table.accuracy) <= set(table.columns)
        assert table.source
        assert table.licence
    assert {file.stem for file in FOLDER.glob("*.csv")} == set(TABLES)
    assert {column for table in TABLES.values() for column in table.open} == {
        *("damper ratio", "roll centre height to body", "roll centre height to ground"),
        *("ackermann", "roll centre height", "anti-dive", "roll centre y", "roll centre z"),
    }
