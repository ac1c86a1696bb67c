"""What was measured is found again as it was, however a run ended, and never among what does not compare."""

import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from made_rows import WHERE

from pointcoord import Scene
from validate.cost.row import Row
from validate.cost.store import Store, StoreError, latest, measured_here, read_rows, scene_digest

HERE = Row("accuracy", "", "", **WHERE)
ROW = Row(
    part="accuracy",
    scene="steer",
    way="series",
    setting="1e-9 mm",
    value=1e-9,
    dense=True,
    poses=81,
    quantity="position",
    error=1.0 / 3.0,
    rms=1e-300,
    radius=5e-30,
    numbers=123,
    time=0.1,
    digest="abc",
    **WHERE,
)
FAILED = replace(ROW, way="printed", verdict="failed", reason='it said "no} {"', time=None, error=None)


def test_rows_come_back_as_they_were_with_every_digit_and_pandas_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    store = Store(path, HERE)
    assert not path.exists()
    store.write([ROW, FAILED])
    assert read_rows(path) == store.rows == Store(path, HERE).rows == [ROW, FAILED]
    assert pd.read_json(path, lines=True, precise_float=True).error.dropna().tolist() == [1.0 / 3.0]


def test_a_row_is_measured_again_where_anything_makes_it_another_run() -> None:
    store = Store(None, HERE)
    store.write([ROW])
    assert store.has(replace(ROW, quantity="velocity", time=3.0))
    words = {"part": "growth", "scene": "b", "digest": "d", "way": "w", "setting": "s"}
    others: dict[str, Any] = {**words, "against": "designs", "size": 3, "quick": True}
    for name, value in others.items():
        assert not store.has(replace(ROW, **{name: value})), name


def test_a_file_cut_anywhere_gives_what_was_whole_and_takes_more(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    Store(path, HERE).write([ROW, FAILED])
    whole = path.read_bytes()
    for cut in (*range(0, len(whole), 13), len(whole) - 2, len(whole) - 1, len(whole)):
        path.write_bytes(whole[:cut])
        again = Store(path, HERE)
        assert again.rows == [ROW, FAILED][: len(again.rows)]
        assert (len(again.rows) == 2) == (cut >= len(whole) - 1)
        more = replace(ROW, way="newton")
        again.write([more])
        assert read_rows(path)[-1] == more


@pytest.mark.parametrize("what", ["program", "machine", "python", "packages"])
def test_rows_that_do_not_compare_are_not_gone_on_with_but_can_be_read(tmp_path: Path, what: str) -> None:
    path = tmp_path / "rows"
    Store(path, HERE).write([ROW])
    before = path.read_bytes()
    with pytest.raises(StoreError, match="; here: another; give another file, or delete this one"):
        Store(path, replace(HERE, **{what: "another"}))
    assert path.read_bytes() == before
    assert read_rows(path) == [ROW]
    # Another command adds to the same file.
    Store(path, replace(HERE, command="another")).write([replace(ROW, way="newton")])


def broken(**changed: object) -> str:
    return json.dumps({**asdict(ROW), **changed})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("hello", "Invalid JSON"),
        ("\x89PNG", "Invalid JSON"),
        ("[1, 2]", "Input should be an object"),
        ("[" * 100_000, "Invalid JSON"),
        (
            '{"cost of accuracy": 1, "part": "accuracy", "scene": "", "way": ""}',
            "cost of accuracy: Unexpected",
        ),
        ('{"part": "accuracy", "scene": ""}', "way: Field required"),
        (broken(time="quick"), "time: Input should be a valid number, not 'quick'"),
        (broken(time=True), "time: Input should be a valid number, not True"),
        (broken(time=-1.0), "time: Input should be greater than or equal to 0, not -1.0"),
        (broken(error={"largest": 1.0}), "error: Input should be a valid number"),
        (broken(poses=1.5), "poses: Input should be a valid integer, not 1.5"),
        (broken(poses=None), "poses: Input should be a valid integer, not None"),
        (broken(dense=1), "dense: Input should be a valid boolean, not 1"),
        (broken(way=None), "way: Input should be a valid string, not None"),
        (
            broken(part="speed"),
            "part: Input should be 'accuracy', 'effects', 'growth', 'loading' or 'unrelated'",
        ),
        (broken(verdict="fine"), "verdict: Input should be 'measured', 'failed' or 'left out', not 'fine'"),
        (broken(time=1.0).replace('"time": 1.0', f'"time": {"9" * 5000}'), "number out of range"),
        (broken(poses=7).replace('"poses": 7', f'"poses": {"9" * 5000}'), "number out of range"),
        (broken(time=1.0).replace('"time": 1.0', '"time": 1e999'), "time: Input should be a finite number"),
        (broken(time=1.0).replace('"time": 1.0', '"time": NaN'), "time: Input should be a finite number"),
    ],
)
def test_a_line_that_is_no_row_is_told_with_its_number_and_why(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "rows"
    path.write_text(f"{json.dumps(asdict(ROW))}\n{text}\n", encoding="utf-8")
    for use in (lambda: Store(path, HERE), lambda: read_rows(path)):
        with pytest.raises(StoreError, match="line 2 is no row of what accuracy costs: ") as caught:
            use()
        assert words in str(caught.value)
        assert len(str(caught.value)) < 400
        assert str(caught.value).endswith("; give another file")


def test_of_a_scene_that_was_changed_the_last_rows_count_and_quick_ones_are_apart() -> None:
    old, new, quick = replace(ROW, digest="old"), replace(ROW, digest="new"), replace(ROW, quick=True)
    assert latest([old, quick, new], quick=False) == [new]
    assert latest([old, quick, new], quick=True) == [quick]


def test_this_process_says_where_it_is() -> None:
    here = measured_here("command")
    assert here == replace(measured_here("another"), command="command")
    assert here.program.startswith("pointcoord 0.")
    for package in ("numpy", "pin", "mujoco", "exudyn"):
        assert package in here.packages


def test_the_digest_of_a_scene_is_of_all_that_it_says_but_not_of_its_title() -> None:
    scene = Scene.load("steer")
    digests = {
        scene_digest(scene.model_copy(update=change))
        for change in (
            {},
            {"tolerance": 1e-8},
            {"effects": ()},
            {"time": {"start": 0.0, "stop": 0.4, "samples": 80}},
            {"inputs": {**scene.inputs, "rack": {"constant": 1.0}}},
            {"mechanism": scene.mechanism.model_copy(update={"side": "left", "closure": "drawn"})},
        )
    }
    assert len(digests) == 6
    assert scene_digest(scene.model_copy(update={"title": "mine"})) == scene_digest(scene)
