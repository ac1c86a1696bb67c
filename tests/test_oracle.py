"""The built-in scenes answer what was frozen, and a frozen number or verdict that is another one is named."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

ORACLE = Path(__file__).parent / "oracle"
FROZEN = ORACLE / "frozen"
QUICK = "scenes-quick"


def held(frozen: Path = FROZEN) -> tuple[int, list[str]]:
    """The exit status of the quickest part, and its lines."""
    command = [sys.executable, str(ORACLE / "compare.py"), QUICK, "--frozen", str(frozen)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert not done.stderr, done.stderr
    return done.returncode, done.stdout.splitlines()


@pytest.fixture
def frozen(tmp_path: Path) -> Path:
    for name in ("scenes.json", "scenes.parquet"):
        shutil.copy(FROZEN / name, tmp_path)
    return tmp_path


def test_the_built_in_scenes_answer_what_was_frozen() -> None:
    status, lines = held()
    assert status == 0, "\n".join(lines)
    assert lines[-1].startswith("0 differences in ")


def test_a_number_and_a_verdict_that_were_others_are_named(frozen: Path) -> None:
    numbers = pq.read_table(frozen / "scenes.parquet").to_pandas()
    car = (numbers["case"] == "steer") & (numbers["formulation"] == "absolute")
    place = car & (numbers["quantity"] == "position") & (numbers["name"] == "wheel_centre")
    numbers.loc[numbers.index[place][-1], "value"] += 1e-9
    pq.write_table(pa.Table.from_pandas(numbers, preserve_index=False), frozen / "scenes.parquet")
    facts = json.loads((frozen / "scenes.json").read_text())
    facts["bounce by absolute"]["exit status"] = 3
    (frozen / "scenes.json").write_text(json.dumps(facts))
    status, lines = held(frozen)
    assert status == 1
    verdict, number, *_ = lines
    assert verdict.startswith("scenes-quick | bounce by absolute | exit status | frozen 3 | now 0")
    assert number.startswith("scenes-quick | steer | absolute: position wheel_centre.z, instant number ")
    assert lines[-1].startswith("2 differences in ")
