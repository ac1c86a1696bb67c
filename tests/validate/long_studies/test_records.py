"""Records of a study are whole whenever they are looked at, and of one study, program and settings."""

import json
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pandas
import pyarrow.dataset
import pytest
from program import ENVIRONMENT

from validate.cli import main
from validate.long_studies import maker
from validate.long_studies.bounds import BoundsStudy
from validate.long_studies.errors import RecordsError
from validate.long_studies.hard_runs import HardStudy
from validate.long_studies.maker import CODE, Maker
from validate.long_studies.random_runs import RandomStudy
from validate.long_studies.records import HEAD, Head, Records, adding_to, in_order, look
from validate.long_studies.study import Number, Row
from validate.output.files import OutputError

BOUNDS = Head.of(BoundsStudy(3, 0, seed=5))


def row(number: int, **more: object) -> Row:
    return {"part": "held", "number": number, "seconds": 0.5, "worker": "here", "error": 1e-300, **more}


def recorded(folder: Path, *numbers: Sequence[int], head: Head = BOUNDS) -> Records:
    """A folder with a file for each group of numbers."""
    with adding_to(folder, head) as there:
        for group in numbers:
            there.write(there.next_file(), [row(number) for number in group])
    return there


def test_what_is_added_is_there_and_what_was_there_stays_as_it_is(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0, 2])
    first = {file: file.read_bytes() for file in there.files()}
    recorded(tmp_path, [1])
    assert {file: file.read_bytes() for file in there.files() if file in first} == first
    assert len(there.files()) == 2
    assert there.recorded() == {Number("held", number) for number in range(3)}
    numbers = [Number("held", number) for number in (2, 1)]
    assert [one["number"] for one in in_order(there.rows(), numbers)] == [2, 1]


def test_numbers_come_back_to_the_last_bit_and_none_as_none(tmp_path: Path) -> None:
    values = [0.1 + 0.2, 5e-324, float("inf"), -0.0, 1.7976931348623157e308, None]
    with adding_to(tmp_path, BOUNDS) as there:
        there.write(there.next_file(), [row(i, bound=value) for i, value in enumerate(values)])
    assert [repr(one["bound"]) for one in there.rows()] == [repr(value) for value in values]


def test_others_read_the_folder_while_something_is_being_written(tmp_path: Path) -> None:
    with adding_to(tmp_path, BOUNDS) as there:
        there.write(there.next_file(), [row(0), row(1)])
        (tmp_path / ".pointcoord-1-ab.part").write_bytes(b"PAR1 half a file")
        assert pyarrow.dataset.dataset(str(tmp_path)).to_table().num_rows == 2
        assert list(pandas.read_parquet(tmp_path)["number"]) == [0, 1]
        assert look(tmp_path).recorded() == {Number("held", 0), Number("held", 1)}


def test_a_number_that_is_there_twice_counts_once(tmp_path: Path) -> None:
    assert [one["number"] for one in recorded(tmp_path, [0, 1], [1, 2]).rows()] == [0, 1, 2]


@pytest.mark.parametrize(
    ("other", "words"),
    [
        (Head.of(BoundsStudy(3, 0, seed=6)), "seed 5, here 6"),
        (Head.of(HardStudy()), "holds the study 'bounds', not 'hard'"),
        (Head.of(RandomStudy(3)), "holds the study 'bounds', not 'random'"),
        (
            replace(BOUNDS, maker=replace(BOUNDS.maker, program="pointcoord 9.0, code 0")),
            ", here pointcoord 9.0, code 0",
        ),
        (
            replace(BOUNDS, maker=replace(BOUNDS.maker, packages={**BOUNDS.maker.packages, "numpy": "1.0"})),
            ", here 1.0",
        ),
        (replace(BOUNDS, columns={"part": "string"}), "has other columns"),
    ],
)
def test_records_of_something_else_are_not_gone_on_with(tmp_path: Path, other: Head, words: str) -> None:
    recorded(tmp_path, [0])
    with pytest.raises(RecordsError, match="give another folder by --records") as caught:
        recorded(tmp_path, [1], head=other)
    assert words in str(caught.value)
    assert str(caught.value).startswith(f"--records {tmp_path}: ")


def test_a_run_that_recorded_nothing_holds_nobody_to_anything(tmp_path: Path) -> None:
    recorded(tmp_path)
    recorded(tmp_path, [0], head=Head.of(BoundsStudy(3, 0, seed=6)))
    assert look(tmp_path).head.settings == {"seed": 6}


def test_more_of_the_same_study_goes_on(tmp_path: Path) -> None:
    recorded(tmp_path, [0])
    recorded(tmp_path, [1], head=Head.of(BoundsStudy(50, 7, seed=5)))
    assert len(look(tmp_path).rows()) == 2


def test_one_run_at_a_time_adds_to_a_folder(tmp_path: Path) -> None:
    with adding_to(tmp_path, BOUNDS), pytest.raises(RecordsError, match="another run adds to them now"):
        recorded(tmp_path, [0])
    recorded(tmp_path, [0])


@pytest.mark.parametrize("head", ["[]", "{}", '{"format": 7}', "", '{"format": 1, "study": "bounds"}'])
def test_a_folder_that_does_not_say_what_it_is_is_refused(tmp_path: Path, head: str) -> None:
    (tmp_path / HEAD).write_text(head)
    with pytest.raises(RecordsError, match="give another folder"):
        recorded(tmp_path, [0])


def test_nothing_is_put_beside_other_peoples_files(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(RecordsError, match="something else than records"):
        recorded(tmp_path, [0])
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
    with pytest.raises(RecordsError, match="is a file"):
        recorded(tmp_path / "thesis.txt", [0])
    with pytest.raises(OutputError, match="cannot be written"):
        recorded(tmp_path / "thesis.txt" / "below", [0])


def test_a_broken_file_is_named_with_what_to_do(tmp_path: Path) -> None:
    there = recorded(tmp_path, [0], [1])
    whole = there.files()[0].read_bytes()
    for broken in (whole[: len(whole) // 2], b"", b"number\n1\n"):
        there.files()[0].write_bytes(broken)
        with pytest.raises(RecordsError, match=r"000000.parquet cannot be read .* delete this file"):
            there.recorded()


def test_all_code_that_rows_follow_from_is_in_their_digest() -> None:
    program = (
        "import sys\n"
        "from validate.long_studies import bounds, hard_runs, random_runs, study\n"
        "hard = hard_runs.HardStudy(('at-rest',))\n"
        "for one in (bounds.BoundsStudy(1, 1), hard, random_runs.RandomStudy(1)):\n"
        "    one.examine(one.numbers[0])\n"
        "print(*(n for n in sys.modules if n.partition('.')[0] in ('pointcoord', 'absolute', 'validate')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env=ENVIRONMENT, check=True
    )
    digested = {place.replace("/", ".") for place in CODE}
    rooms = {".".join(name.split(".")[: 1 + name.startswith("validate.")]) for name in done.stdout.split()}
    words = {f"validate.{room}" for room in ("exit_status", "extras", "output", "plain_text", "running")}
    # Loaded with the names of all formulations, but no study asks it anything.
    assert rooms - digested == {"validate", *words, "validate.peers"}


def test_another_line_of_code_is_another_maker(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maker, "code_digest", lambda places: "0")
    Maker.here.cache_clear()
    try:
        assert Maker.here().differences(BOUNDS.maker)
    finally:
        Maker.here.cache_clear()


def test_the_findings_of_records_are_said_without_working_anything_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    more = {"suspension": "double wishbone", "distance": 0.5, "refusal": "no bound"}
    with adding_to(tmp_path, BOUNDS) as there:
        there.write(there.next_file(), [row(number, **more) for number in range(3)])
    words = ["study", "bounds", "--from-records", "--records", str(tmp_path)]
    assert main([*words, "--json", "-"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert (data["kind"], data["seed"]) == ("bounds", 5)
    assert data["refusals"] == [{"reason": "no bound", "poses": 3}]
    assert main(words) == 0
    assert "refused: 3" in capsys.readouterr().out
    assert main(["study", "random", *words[2:]]) == 2
    assert "holds the study 'bounds', not 'random'" in capsys.readouterr().err
