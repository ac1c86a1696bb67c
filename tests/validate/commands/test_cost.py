"""`pointcoord cost` as its users meet it: options, files, interruptions and endings."""

import csv
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from made_rows import kept, measured, study
from program import complaints, document

from validate.cli import main
from validate.cost import study as studying
from validate.cost.report import NOTHING
from validate.cost.scenes import STUDY_SCENES
from validate.cost.study import Study
from validate.cost.table import Row, read_rows
from validate.cost.ways.registry import WAYS, ways_named

(ONE,) = measured("bounce", "series", "1e-9 mm", {"position": 1e-10}, 1e-5)
Plant = Callable[..., list[Study]]


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> Plant:
    """Has a study measure given rows, and then end with an error; returns the studies that were run."""

    def plant(*rows: Row, end: BaseException | None = None) -> list[Study]:
        asked: list[Study] = []

        def measure(study: Study, progress: Any) -> Iterator[list[Row]]:
            asked.append(study)
            yield list(rows)
            if end is not None:
                raise end

        monkeypatch.setattr(studying, "measure", measure)
        return asked

    return plant


def test_a_report_from_rows_measures_nothing_and_ends_with_0(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], planted: Plant
) -> None:
    rows, store, asked = study(), kept(tmp_path / "rows.parquet", study()), planted()
    before, lines, target = Path(store).read_bytes(), tmp_path / "rows.csv", tmp_path / "x.json"
    words = ["cost", "--from-rows", "--rows", store, "--csv", str(lines), "--json", str(target)]
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert complaints(err) == asked == []
    data = document(target)
    assert (data["kind"], data["complete"], data["verdict"]) == ("cost", True, "nothing compared")
    assert len(data["rows"]) == len(rows)
    assert data["measured_by"]["machine"] == "a made machine, 2 cores"
    assert {race["verdict"] for race in data["races"]} == {"ours"}
    assert out.index("To solve a pose to 1e-9 mm") < out.index("Time of a pose to 1e-9 mm of position")
    assert "a made machine" in out
    assert store in out
    assert Path(store).read_bytes() == before
    with lines.open(encoding="utf-8", newline="") as stream:
        written = list(csv.DictReader(stream))
    assert [float(one["time"] or 0.0) for one in written] == [row.time or 0.0 for row in rows]


def test_ctrl_c_keeps_and_names_what_was_measured(
    tmp_path: Path, planted: Plant, capsys: pytest.CaptureFixture[str]
) -> None:
    planted(ONE, end=KeyboardInterrupt())
    path, target = tmp_path / "rows.parquet", tmp_path / "x.json"
    assert main(["cost", "--rows", str(path), "--json", str(target)]) == 130
    (line,) = complaints(capsys.readouterr().err)
    assert f"{path} holds 1 row" in line
    assert f"{target} holds 1 row" in line
    assert read_rows(str(path)) == [ONE]
    data = document(target)
    assert (data["complete"], data["exit_status"], len(data["rows"])) == (False, 130, 1)


@pytest.mark.parametrize(
    ("words", "scenes"),
    [
        ("", STUDY_SCENES),
        ("--quick", ("bounce-and-steer",)),
        ("steer near-toggle steer --ways series", ("steer", "near-toggle")),
    ],
)
def test_what_is_measured_is_what_the_options_say(
    words: str, scenes: tuple[str, ...], tmp_path: Path, planted: Plant
) -> None:
    asked = planted(ONE)
    assert main(["cost", *words.split(), "--rows", str(tmp_path / "rows.parquet"), "--quiet"]) == 0
    (one,) = asked
    assert tuple(one.scenes) == scenes
    assert one.quick == ("--quick" in words)
    assert one.ways == (ways_named(["series"]) if "--ways" in words else WAYS)


def test_a_run_leaves_the_picture_beside_its_rows_if_there_is_something_to_draw_and_something_to_draw_with(
    tmp_path: Path, planted: Plant, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path, picture = tmp_path / "mine.parquet", tmp_path / "mine.svg"
    words = ["cost", "--quick", "--rows", str(path)]
    planted(Row("bounce", "series", verdict="failed", reason="locked at 2 s"))
    assert main(words) == 3
    out, err = capsys.readouterr()
    assert "locked at 2 s" in out
    assert NOTHING in out
    assert "nothing could be measured" in complaints(err)[0]
    assert [*tmp_path.iterdir()] == [path]
    planted(ONE)
    assert main(words) == 0
    assert f"the picture: {picture}" in capsys.readouterr().out
    assert picture.read_text().startswith("<?xml")
    picture.unlink()
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in ("validate.cost.picture", "validate.output.figure"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    assert main(words) == 0
    assert "pip install 'pointcoord[plot]'" in capsys.readouterr().err
    assert not picture.exists()
