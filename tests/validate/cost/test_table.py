"""What was measured is found again as it was, however a run ended, and never among what does not compare."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from made_rows import WHERE, study

from pointcoord import Scene
from validate.cost.scenes import StudyScene
from validate.cost.table import Row, Store, StoreError, frame, read_rows

HERE = Row("accuracy", "", "", **WHERE)
ROW = replace(study()[0], error=1.0 / 3.0, rms=1e-300, **WHERE)
FAILED = replace(ROW, way="printed", verdict="failed", reason='it said "no} {"', time=None, error=None)


def test_rows_come_back_as_they_were_with_every_digit_and_pandas_reads_them(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    store = Store(path, HERE)
    assert not path.exists()
    every = [ROW, FAILED, *(replace(row, **WHERE) for row in study()[1:])]
    store.write(every[:1])
    store.write(every[1:])
    assert read_rows(path) == store.rows == Store(path, HERE).rows == every
    pd.testing.assert_frame_equal(pd.read_parquet(path), frame(every))


def test_a_row_is_measured_again_where_anything_makes_it_another_run() -> None:
    store = Store(None, HERE)
    store.write([ROW])
    assert store.has(replace(ROW, quantity="velocity", time=3.0))
    words = {"part": "growth", "scene": "b", "digest": "d", "way": "w", "setting": "s"}
    others: dict[str, Any] = {**words, "against": "designs", "size": 3, "quick": True}
    for name, value in others.items():
        assert not store.has(replace(ROW, **{name: value})), name


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


WHOLE = frame([ROW]).to_parquet()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"hello", "Parquet"),
        (WHOLE[:-1], "Parquet"),
        (frame([ROW]).drop(columns="time").to_parquet(), "the columns time are missing or unknown"),
        (frame([ROW]).assign(scene=None).to_parquet(), "scene of row 0: Input should be a valid string"),
        (frame([ROW]).assign(verdict="fine").to_parquet(), "verdict of row 0: Input should be 'measured'"),
    ],
)
def test_a_file_that_is_no_such_table_is_refused_with_the_reason(
    tmp_path: Path, content: bytes, words: str
) -> None:
    path = tmp_path / "rows"
    path.write_bytes(content)
    for use in (lambda: Store(path, HERE), lambda: read_rows(path)):
        with pytest.raises(StoreError, match="is no Parquet file of what accuracy costs ") as caught:
            use()
        assert words in str(caught.value)
        assert str(caught.value).endswith("; give another file")
    assert path.read_bytes() == content


def test_the_digest_of_a_scene_is_of_all_that_it_says_but_not_of_its_title() -> None:
    scene = Scene.load("steer")
    changes: tuple[dict[str, Any], ...] = (
        {},
        {"tolerance": 1e-8},
        {"effects": ()},
        {"time": {"start": 0.0, "stop": 0.4, "samples": 80}},
        {"inputs": {**scene.inputs, "rack": {"constant": 1.0}}},
        {"mechanism": scene.mechanism.model_copy(update={"side": "left", "closure": "drawn"})},
    )
    digests = {StudyScene("", scene.model_copy(update=change)).digest for change in changes}
    assert len(digests) == 6
    assert StudyScene("", scene.model_copy(update={"title": "mine"})).digest in digests
