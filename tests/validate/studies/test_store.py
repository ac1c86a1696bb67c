"""Records of a study are whole whenever they are looked at, and of one study, program and settings."""

from collections.abc import Sequence
from pathlib import Path

import pytest

from validate.errors import NotFinished, UsageError
from validate.studies import store
from validate.studies.bounds import bounds
from validate.studies.claims import claims
from validate.studies.store import Store, records
from validate.studies.study import Row, Study, Task, made_by

BOUNDS = bounds(3, seed=5)


def row(number: int, **more: object) -> Row:
    return {"part": "held", "number": number, "seconds": 0.5, "worker": "here", "error": 1e-300, **more}


def recorded(folder: Path, *numbers: Sequence[int], study: Study = BOUNDS) -> Store:
    """A folder with a file for each group of numbers."""
    there = records(folder, study)
    for group in numbers:
        there.write([row(number) for number in group])
    return there


def test_what_is_added_is_there_and_what_was_there_stays_as_it_is(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0, 2])
    first = {file: file.read_bytes() for file in there.files()}
    # More of the same study goes on.
    recorded(tmp_path, [1, 2], study=bounds(50, seed=5))
    assert {file: file.read_bytes() for file in there.files() if file in first} == first
    # One that is there twice counts once.
    rows = there.rows()
    assert rows.keys() == {Task("held", number) for number in range(3)}
    assert {len(of) for of in rows.values()} == {1}


def test_numbers_come_back_to_the_last_bit_and_none_as_none(tmp_path: Path) -> None:
    values = [0.1 + 0.2, 5e-324, float("inf"), -0.0, 1.7976931348623157e308, None]
    there = records(tmp_path, BOUNDS)
    there.write([row(i, bound=value) for i, value in enumerate(values)])
    assert [repr(one["bound"]) for (one,) in there.rows().values()] == [repr(value) for value in values]


def test_records_of_something_else_are_not_gone_on_with(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    recorded(tmp_path, [0])
    mine = dict(made_by())
    for other, changed, words in (
        (bounds(3, seed=6), "", "seed 5, here 6"),
        (claims(1), "", "study bounds, here claims"),
        (BOUNDS, "pointcoord", ", here 9.0"),
        (BOUNDS, "numpy", ", here 9.0"),
    ):
        monkeypatch.setattr(store, "made_by", lambda name=changed: {**mine, name: "9.0"} if name else mine)
        with pytest.raises(UsageError, match="give another folder with --records") as caught:
            recorded(tmp_path, [1], study=other)
        assert words in str(caught.value)
        assert changed in str(caught.value)


def test_nothing_is_put_beside_other_peoples_files(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="files that are no records"):
        recorded(tmp_path, [0])
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
    with pytest.raises(UsageError, match="is a file"):
        recorded(tmp_path / "thesis.txt", [0])
    with pytest.raises(NotFinished, match="cannot be written"):
        recorded(tmp_path / "thesis.txt" / "below", [0])


def test_a_broken_file_is_named_with_what_to_do(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0], [1])
    whole = there.files()[0].read_bytes()
    for broken in (whole[: len(whole) // 2], b"", b"number\n1\n"):
        there.files()[0].write_bytes(broken)
        with pytest.raises(UsageError, match=r"\.parquet cannot be read .* delete this file"):
            there.rows()
