"""Records of a study are whole whenever they are looked at, and of one study, program and settings."""

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from validate.cli import main
from validate.errors import UsageError
from validate.output.files import OutputError
from validate.studies import store
from validate.studies.bounds import bounds
from validate.studies.claims import claims
from validate.studies.store import Store, adding_to
from validate.studies.study import Row, Study, Task

BOUNDS = bounds(3, 0, seed=5)


def row(number: int, **more: object) -> Row:
    return {"part": "held", "number": number, "seconds": 0.5, "worker": "here", "error": 1e-300, **more}


def recorded(folder: Path, *numbers: Sequence[int], study: Study = BOUNDS) -> Store:
    """A folder with a file for each group of numbers."""
    there = adding_to(folder, study)
    for group in numbers:
        there.write(there.next_file(), [row(number) for number in group])
    return there


def test_what_is_added_is_there_and_what_was_there_stays_as_it_is(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0, 2])
    first = {file: file.read_bytes() for file in there.files()}
    # More of the same study goes on.
    recorded(tmp_path, [1, 2], study=bounds(50, 7, seed=5))
    assert {file: file.read_bytes() for file in there.files() if file in first} == first
    assert there.tasks() == {Task("held", number) for number in range(3)}
    # In the order that is asked for, and one that is there twice counts once.
    assert [one["number"] for one in there.rows([Task("held", 2), Task("held", 1)])] == [2, 1]
    assert [one["number"] for one in there.rows()] == [0, 1, 2]


def test_numbers_come_back_to_the_last_bit_and_none_as_none(tmp_path: Path) -> None:
    values = [0.1 + 0.2, 5e-324, float("inf"), -0.0, 1.7976931348623157e308, None]
    there = adding_to(tmp_path, BOUNDS)
    there.write(there.next_file(), [row(i, bound=value) for i, value in enumerate(values)])
    assert [repr(one["bound"]) for one in there.rows()] == [repr(value) for value in values]


@pytest.mark.parametrize(
    ("other", "words"),
    [(bounds(3, 0, seed=6), "seed 5, here 6"), (claims(1), "holds the study 'bounds', not 'claims'")],
)
def test_records_of_something_else_are_not_gone_on_with(tmp_path: Path, other: Study, words: str) -> None:
    recorded(tmp_path, [0])
    with pytest.raises(UsageError, match="give another folder by --records") as caught:
        recorded(tmp_path, [1], study=other)
    assert words in str(caught.value)


@pytest.mark.parametrize("changed", ["pointcoord", "numpy"])
def test_records_of_another_program_are_not_gone_on_with(
    tmp_path: Path, changed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    mine = dict(recorded(tmp_path, [0]).made_by)
    monkeypatch.setattr(store, "made_by", lambda: {**mine, changed: "9.0"})
    with pytest.raises(UsageError, match=rf"{changed} .*, here 9\.0"):
        recorded(tmp_path, [1])


def test_nothing_is_put_beside_other_peoples_files(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(UsageError, match="something else than records"):
        recorded(tmp_path, [0])
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
    with pytest.raises(UsageError, match="is a file"):
        recorded(tmp_path / "thesis.txt", [0])
    with pytest.raises(OutputError, match="cannot be written"):
        recorded(tmp_path / "thesis.txt" / "below", [0])


def test_a_broken_file_is_named_with_what_to_do(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0], [1])
    whole = there.files()[0].read_bytes()
    for broken in (whole[: len(whole) // 2], b"", b"number\n1\n"):
        there.files()[0].write_bytes(broken)
        with pytest.raises(UsageError, match=r"\.parquet cannot be read .* delete this file"):
            there.tasks()


def test_the_findings_of_records_are_said_without_working_anything_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refused = {"suspension": "double wishbone", "distance": 0.5, "refusal": "no bound"}
    there = adding_to(tmp_path, replace(BOUNDS, tasks=()))
    there.write(there.next_file(), [row(number, **refused) for number in range(3)])
    words = ["study", "bounds", "--from-records", "--records", str(tmp_path)]
    assert main([*words, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["kind"], data["seed"]) == ("bounds", 5)
    assert data["refusals"] == [{"reason": "no bound", "poses": 3}]
    assert main(words) == 0
    assert "refused: 3" in capsys.readouterr().out
    assert main(["study", "random", *words[2:]]) == 2
    assert "holds the study 'bounds', not 'random'" in capsys.readouterr().err
