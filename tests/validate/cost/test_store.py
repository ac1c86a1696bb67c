"""What was measured is found again as it was, however a run ended, and never among what does not compare."""

from dataclasses import replace
from pathlib import Path

import pytest

from pointcoord import Scene
from validate.cost.row import QuantityError, Row, Time
from validate.cost.store import Begun, Header, Key, Store, StoreError, read_rows, scene_digest

HEADER = Header("p 1", "m", "CPython 3", {"numpy": "2.0"}, {"OMP_NUM_THREADS": "1"}, "pointcoord cost")
KEY = Key("accuracy", "steer", "abc", "series", "1e-9 mm")
ROW = Row(
    part="accuracy",
    scene="steer",
    way="series",
    setting="1e-9 mm",
    value=1e-9,
    configurations=81,
    dense=True,
    errors={"position": QuantityError(1.0 / 3.0, 1e-300, 5e-30, 123)},
    not_given={"wheel": "why"},
    times={"solve": Time(0.1, 0.09, 0.2, 7)},
    counts={"factorisations": 3},
)
GROWTH = Row("growth", "steer", "newton", against="instants", size=1000, peak_bytes=12_345, configurations=1)
FAILED = Row("accuracy", "steer", "printed", status="failed", reason='it said "no"')


def test_rows_come_back_as_they_were_with_every_digit(tmp_path: Path) -> None:
    store = Store(tmp_path / "rows", HEADER)
    keys = [KEY, replace(KEY, part="growth", against="instants", size=1000), replace(KEY, way="printed")]
    for key, row in zip(keys, (ROW, GROWTH, FAILED), strict=True):
        store.write(key, row)
    again = Store(tmp_path / "rows", replace(HEADER, command="another"))
    assert again.rows() == store.rows() == (ROW, GROWTH, FAILED)
    assert again.rows("growth") == (GROWTH,)
    assert again.header.command == "pointcoord cost"
    assert read_rows(tmp_path / "rows")[1] == tuple(zip(keys, (ROW, GROWTH, FAILED), strict=True))


def test_a_row_is_found_by_everything_that_makes_it_another_measurement() -> None:
    store = Store(None, HEADER)
    store.write(KEY, ROW)
    assert store.row(KEY) == ROW
    others = {"part": "growth", "scene": "b", "digest": "d", "way": "w", "setting": "s"}
    more = {"against": "designs", "size": 3, "quick": True, "configurations": 10}
    for name, value in {**others, **more}.items():
        assert store.row(replace(KEY, **{name: value})) is None, name
    assert store.rows(quick=True) == ()


def test_what_is_begun_comes_back_with_its_samples(tmp_path: Path) -> None:
    store = Store(tmp_path / "rows", HEADER)
    store.begin(KEY, Begun(ROW, 12, 3))
    store.sample(KEY, 0, {"solve": 0.1})
    store.sample(KEY, 4, {"solve": 1.0 / 3.0, "rates": 0.0})
    again = Store(tmp_path / "rows", HEADER)
    assert again.begun(KEY) == Begun(ROW, 12, 3)
    assert again.samples(KEY) == {0: {"solve": 0.1}, 4: {"solve": 1.0 / 3.0, "rates": 0.0}}
    assert again.rows() == ()


def test_a_file_cut_anywhere_gives_what_was_whole_and_takes_more(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    store = Store(path, HEADER)
    store.begin(KEY, Begun(ROW, 12, 3))
    store.sample(KEY, 0, {"solve": 0.1})
    store.write(KEY, ROW)
    whole = path.read_bytes()
    for cut in (*range(0, len(whole), 13), len(whole) - 1, len(whole)):
        path.write_bytes(whole[:cut])
        again = Store(path, HEADER)
        assert again.rows() in ((), (ROW,))
        assert (again.rows() == (ROW,)) == (cut >= len(whole) - 1)
        again.write(replace(KEY, way="newton"), FAILED)
        assert FAILED in Store(path, HEADER).rows()


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (replace(HEADER, program="p 2"), "program: p 1; here: p 2"),
        (replace(HEADER, machine="n"), "machine: m; here: n"),
        (replace(HEADER, python="PyPy 3"), "python: CPython 3; here: PyPy 3"),
        (replace(HEADER, packages={"numpy": "2.1"}), "numpy: 2.0; here: 2.1"),
        (replace(HEADER, threads={"OMP_NUM_THREADS": "2"}), "OMP_NUM_THREADS: 1; here: 2"),
        (replace(HEADER, threads={}), "OMP_NUM_THREADS: 1; here: not known"),
    ],
)
def test_rows_that_do_not_compare_are_not_gone_on_with_but_can_be_read(
    tmp_path: Path, other: Header, words: str
) -> None:
    path = tmp_path / "rows"
    Store(path, HEADER).write(KEY, ROW)
    before = path.read_bytes()
    with pytest.raises(StoreError) as caught:
        Store(path, other)
    assert words in str(caught.value)
    assert "give another file, or delete this one" in str(caught.value)
    assert path.read_bytes() == before
    assert read_rows(path)[0] == HEADER


@pytest.mark.parametrize(
    "text", ["hello\n", "[1, 2]\n", '{"chunk": 1}\n', "\x89PNG\n", '{"row": {}, "key": 3}\n']
)
def test_a_file_of_something_else_is_refused_and_left_alone(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rows"
    path.write_text(text, encoding="utf-8")
    for use in (lambda: Store(path, HEADER), lambda: read_rows(path)):
        with pytest.raises(StoreError, match=r"line 1 is no row of what accuracy costs; give another file"):
            use()
    assert path.read_text(encoding="utf-8") == text


def test_a_line_of_something_else_among_rows_is_told_with_its_number(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    Store(path, HEADER).write(KEY, ROW)
    with path.open("a", encoding="utf-8") as file:
        file.write('{"key": {"part": "accuracy"}}\n')
    with pytest.raises(StoreError, match="line 5 is no row"):
        Store(path, HEADER)


def test_another_form_of_the_file_is_told(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    Store(path, HEADER)
    path.write_text(path.read_text(encoding="utf-8").replace(": 1,", ": 2,", 1), encoding="utf-8")
    with pytest.raises(StoreError, match="form 2 of such files, this program knows the form 1"):
        Store(path, HEADER)


def test_nothing_to_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match="holds no rows; measure them first"):
        read_rows(tmp_path / "none")


def test_this_process_says_where_it_is() -> None:
    here = Header.here("command")
    assert here.differences(Header.here("another command")) == []
    assert here.program.startswith("pointcoord 0.")
    assert {"numpy", "pin", "mujoco", "exudyn"} <= set(here.packages)
    assert here.threads == {"every part": "1"}


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
