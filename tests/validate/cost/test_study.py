"""The study goes through its parts, keeps what it measured, and goes on where it was stopped."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.cost import growth
from validate.cost import study as studying
from validate.cost.race import Effort, race
from validate.cost.scenes import own_scene, study_instants, study_scene
from validate.cost.study import Study, measure, runners_of
from validate.cost.table import Row, Store, measured_here, read_rows
from validate.cost.way import Way
from validate.cost.ways.registry import ways_named

STEER = study_scene("steer", own_scene("steer"))
FEW = Effort(repeats=2, least=0.0)


def test_instants_are_special_to_no_way_and_one_lies_in_each_part_of_the_time() -> None:
    scene = own_scene("bounce")
    instants, time = study_instants(scene), scene.time
    assert np.floor(instants / time.stop * len(instants)).tolist() == list(range(len(instants)))
    special = [scene.instants, np.linspace(time.start, time.stop, 2 * len(instants) + 1)]
    for tolerance in (1e-3, 1e-9, 1e-13):
        solved: Any = simulate(scene.model_copy(update={"tolerance": tolerance})).solved
        special.append(np.array([segment.start for segment in solved.chain.segments]))
    assert np.abs(instants[:, None] - np.concatenate(special)).min() > 1e-9 * time.stop


def test_every_setting_is_raced_for_positions_alone_and_for_everything() -> None:
    ways = ways_named(["series", "absolute"])
    runners = runners_of(STEER, ways)
    count = {way.name: sum(one.row.way == way.name for one in runners) for way in ways}
    assert count == {"series": 24, "absolute": 2}
    bare = study_scene("bare", STEER.positions_only())
    assert len(runners_of(bare, ways)) == 13
    alone = next(one for one in runners if one.row.quantity == "position")
    assert alone.set_up()().numbers.keys() == {"position"}
    rows = race(runners_of(STEER, ways, quick=True), FEW)
    keys = [(row.way, row.setting, row.quantity) for row in rows]
    assert len(set(keys)) == len(keys)
    quantities = {row.quantity for row in rows if row.way == "series"}
    assert quantities == {"position", *dict.fromkeys(row.quantity for row in rows)}
    assert {"velocity", "acceleration", "angular_velocity", "angular_acceleration"} < quantities
    assert all(row.verdict == "measured" and row.poses == 24 for row in rows)


def test_a_way_that_is_not_installed_is_left_out_and_one_that_refuses_has_failed() -> None:
    def refuses(scene: Scene, value: float) -> Any:
        raise ValueError("it does not want to")

    ways = [Way("a", "", refuses, (1.0,), package="no_such_package"), Way("b", "", refuses, (1.0,))]
    rows = race(runners_of(STEER, ways), FEW)
    assert {(row.way, row.verdict, row.reason) for row in rows} == {
        ("a", "left out", "needs the package 'no_such_package', which is not installed"),
        ("b", "failed", "ValueError: it does not want to"),
    }


def test_what_is_kept_is_not_measured_again_and_more_is_added(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    raced: list[set[str]] = []

    def planted(runners: Any, *_: Any) -> list[Row]:
        raced.append({one.row.way for one in runners})
        return [replace(one.row, quantity="position", error=1e-9, time=1e-6) for one in runners]

    monkeypatch.setattr(studying, "race", planted)
    path, here = tmp_path / "rows", measured_here("test")
    study = Study(("accuracy",), (STEER,), ways_named(["absolute"]), quick=True)
    rows = measure(study, Store(path, here))
    before = path.read_bytes()
    assert (measure(study, Store(path, here)), path.read_bytes()) == (rows, before)
    assert {row.program for row in rows} == {here.program}
    more = measure(replace(study, ways=ways_named(["absolute", "newton"])), Store(path, here))
    assert more[: len(rows)] == rows
    assert raced == [{"absolute"}, {"newton"}]
    changed = study_scene("steer", STEER.positions_only())
    found = measure(replace(study, scenes=(changed,)), Store(path, here))
    assert not {row.key for row in found} & {row.key for row in rows}


def test_growth_goes_on_with_the_size_that_it_was_stopped_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[int | None] = []

    def planted(make: Any, least: int, row: Row, limits: Any) -> list[Row]:
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append(row.size)
        return [replace(row, quantity="position", time=1e-9, set_up=0.0)]

    monkeypatch.setattr(growth, "measure_apart", planted)
    study = Study(("growth",), (STEER,), ways_named(["series"]), quick=True)
    path = tmp_path / "rows"
    with pytest.raises(KeyboardInterrupt):
        measure(study, Store(path, measured_here()))
    assert len(read_rows(path)) == 3
    done[:] = [0] * 4
    rows = measure(study, Store(path, measured_here()))
    assert len(rows) == 8
    assert len(done) == 4 + 5
