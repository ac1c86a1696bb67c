"""`pointcoord cost` as its users meet it: options, files, interruptions and endings."""

import csv
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from made_rows import kept, measured, study
from program import document

from validate.cli import main
from validate.cost import study as studying
from validate.cost.report import NOTHING
from validate.cost.scenes import STUDY_SCENES
from validate.cost.study import Study
from validate.cost.table import Row, read_rows
from validate.cost.ways.registry import WAYS, ways_named

ROWS = study()


@pytest.fixture
def store(tmp_path: Path) -> str:
    """A file of rows, measured elsewhere."""
    return kept(tmp_path / "rows.parquet", ROWS)


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Puts another in the place of what measures."""

    def plant(measure: Callable[..., Any]) -> None:
        monkeypatch.setattr(studying, "measure", measure)

    return plant


def told(capsys: pytest.CaptureFixture[str]) -> tuple[str, list[str]]:
    out, err = capsys.readouterr()
    return out, [line for line in err.splitlines() if not line.startswith("pointcoord: note: ")]


def test_a_report_from_rows_measures_nothing_and_ends_with_0(
    store: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], fake: Callable[..., None]
) -> None:
    def never(*_: object, **__: object) -> None:
        raise AssertionError("measured")

    fake(never)
    before, lines, target = Path(store).read_bytes(), tmp_path / "rows.csv", tmp_path / "x.json"
    words = ["cost", "--from-rows", "--rows", store, "--csv", str(lines), "--json", str(target)]
    assert main(words) == 0
    out, err = told(capsys)
    assert err == []
    data = document(target)
    assert (data["kind"], data["complete"], data["verdict"]) == ("cost", True, "nothing compared")
    assert len(data["rows"]) == len(ROWS)
    assert data["measured_by"]["machine"] == "a made machine, 2 cores"
    assert {race["verdict"] for race in data["races"]} == {"ours"}
    assert out.index("To solve a pose to 1e-9 mm") < out.index("Time of a pose to 1e-9 mm of position")
    assert "a made machine" in out
    assert store in out
    assert Path(store).read_bytes() == before
    with lines.open(encoding="utf-8", newline="") as stream:
        written = list(csv.DictReader(stream))
    assert [float(one["time"] or 0.0) for one in written] == [row.time or 0.0 for row in ROWS]


def planted(*rows: Row, end: BaseException | None = None) -> Callable[..., Iterator[list[Row]]]:
    """A measurement that gives the rows of a scene, and then ends as told."""

    def measure(study: Study, progress: Any) -> Iterator[list[Row]]:
        yield list(rows)
        if end is not None:
            raise end

    return measure


(ONE,) = measured("bounce", "series", "1e-9 mm", {"position": 1e-10}, 1e-5)


def test_ctrl_c_keeps_and_names_what_was_measured(
    tmp_path: Path, fake: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    fake(planted(ONE, end=KeyboardInterrupt()))
    path, target = tmp_path / "rows.parquet", tmp_path / "x.json"
    assert main(["cost", "--rows", str(path), "--json", str(target)]) == 130
    _, (line,) = told(capsys)
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
    words: str, scenes: tuple[str, ...], tmp_path: Path, fake: Callable[..., None]
) -> None:
    asked: list[Study] = []
    fake(lambda study, progress: asked.append(study) or [[ONE]])
    assert main(["cost", *words.split(), "--rows", str(tmp_path / "rows.parquet"), "--quiet"]) == 0
    (study,) = asked
    assert tuple(study.scenes) == scenes
    assert study.quick == ("--quick" in words)
    assert study.ways == (ways_named(["series"]) if "--ways" in words else WAYS)


def test_nothing_that_could_be_measured_ends_with_3_and_the_reasons(
    tmp_path: Path, fake: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    fake(planted(Row("bounce", "series", verdict="failed", reason="locked at 2 s")))
    assert main(["cost", "--rows", str(tmp_path / "rows.parquet")]) == 3
    out, err = told(capsys)
    assert "locked at 2 s" in out
    assert NOTHING in out
    assert "nothing could be measured" in err[0]
    assert [path.name for path in tmp_path.iterdir()] == ["rows.parquet"], "there is nothing to draw"


def test_a_run_leaves_the_picture_beside_its_rows_and_names_it(
    tmp_path: Path,
    fake: Callable[..., None],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fake(planted(ONE))
    path = tmp_path / "mine.parquet"
    assert main(["cost", "--quick", "--rows", str(path)]) == 0
    assert f"the picture: {tmp_path / 'mine.svg'}" in capsys.readouterr().out
    assert (tmp_path / "mine.svg").read_text().startswith("<?xml")
    (tmp_path / "mine.svg").unlink()
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for name in ("validate.cost.picture", "validate.output.figure"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    assert main(["cost", "--quick", "--rows", str(path)]) == 0
    assert "pip install 'pointcoord[plot]'" in capsys.readouterr().err
    assert not (tmp_path / "mine.svg").exists()
