"""What loading takes: every process is in a row, and one that fails says why."""

from dataclasses import replace
from pathlib import Path

import pytest

from validate.cost import loading
from validate.cost.loading import COLD, LOADED, LOADED_QUICK, Loading, measure_loading
from validate.cost.store import Header, Store

SLEEPS = Loading("sleeps", words=("-c", "import time; time.sleep(0.2)"))
NAMES_ITS_PACKAGE = Loading(
    "prints", words=("-c", "import validate; assert validate.__file__; print(0.25)"), statement=True
)
FAILS = Loading("fails", words=("-c", "raise SystemExit('no such scene')"))
NEEDS = Loading("needs", words=("-c", "pass"), needs="not_a_package")


def memory() -> Store:
    return Store(None, Header.here())


def test_a_process_is_timed_from_its_start_to_its_end_and_its_statement_by_itself() -> None:
    sleeps, prints, cold = measure_loading(memory(), True, loaded=[SLEEPS, NAMES_ITS_PACKAGE])
    assert sleeps.times["process"].lower >= 0.2
    assert sleeps.times["process"].repeats == 3
    assert set(sleeps.times) == {"process"}
    assert prints.times["import"].median == 0.25
    assert prints.times["process"].median > 0.0
    assert cold == COLD


def test_what_fails_and_what_cannot_be_had_are_rows_with_reasons() -> None:
    fails, needs, fine, cold = measure_loading(memory(), True, loaded=[FAILS, NEEDS, NAMES_ITS_PACKAGE])
    assert (fails.status, fails.reason) == ("failed", "ended with status 1: no such scene")
    assert (needs.status, needs.reason) == (
        "left out",
        "needs the package 'not_a_package', which is not installed",
    )
    assert not fails.times
    assert not needs.times
    assert fine.status == "measured"
    assert (cold.status, "cache" in cold.reason) == ("left out", True)


def test_rounds_hold_all_kinds_once_in_changing_order(monkeypatch: pytest.MonkeyPatch) -> None:
    run: list[str] = []
    monkeypatch.setattr(loading, "_run", lambda words: run.append(words[0]) or "")
    loaded = [Loading(name, words=(name,)) for name in "abcde"]
    measure_loading(memory(), loaded=loaded)
    rounds = [tuple(run[i : i + 5]) for i in range(0, len(run), 5)]
    assert len(rounds) == 1 + loading.REPEATS
    assert all(sorted(one) == list("abcde") for one in rounds)
    assert len(set(rounds)) > 1


def test_what_was_measured_is_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = measure_loading(Store(tmp_path / "rows", Header.here()), True, loaded=[NAMES_ITS_PACKAGE])
    monkeypatch.setattr(loading, "_run", lambda words: pytest.fail("run again"))
    again = measure_loading(Store(tmp_path / "rows", Header.here()), True, loaded=[NAMES_ITS_PACKAGE])
    assert again == first


def test_a_scene_is_loaded_in_this_process_and_the_package_in_others() -> None:
    words = [one.words for one in LOADED]
    assert ("-m", "pointcoord", "validate", "steer") in words
    assert ("-m", "pointcoord", "scenes") in words
    assert set(LOADED_QUICK) < set(LOADED)
    scene = next(one for one in LOADED if not one.words)
    found, _ = measure_loading(memory(), True, loaded=[scene])
    assert set(found.times) == {"load"}
    assert 0.0 < found.times["load"].median < 1.0


def test_the_package_is_imported_beside_numpy_in_the_same_rounds() -> None:
    imports = [one for one in LOADED if one.statement]
    assert [one.way for one in imports] == [
        "import numpy",
        "import pointcoord",
        "from pointcoord import Scene, simulate",
    ]
    told: list[int] = []
    found = measure_loading(
        memory(), True, lambda what, done, of: told.append(of - done), loaded=[replace(imports[0])]
    )
    assert 0.0 < found[0].times["import"].median < found[0].times["process"].median
    assert told == [4, 3, 2, 1]
