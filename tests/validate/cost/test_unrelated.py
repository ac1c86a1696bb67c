"""The race at unrelated inputs: every way solves the same poses, and its accuracy is looked at."""

from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, solve_poses
from validate.cost import unrelated
from validate.cost.instants import study_instants
from validate.cost.row import Row
from validate.cost.scenes import StudyScene
from validate.cost.store import Header, Store
from validate.cost.tables import unrelated_tables
from validate.cost.unrelated import ALONE, MAP, NEAR, OTHERS, REPEATS_QUICK, Draw, measure_unrelated
from validate.cost.ways.inputs import laws_at
from validate.cost.ways.registry import WAYS

POSES = (300, 10)


def steady() -> Any:
    """A clock that goes on by 50 ms whenever it is read."""
    ticks = count(0, 50_000_000)
    return lambda: next(ticks)


def race(folder: Path, name: str = "bounce-and-steer", ways: Any = WAYS) -> dict[str, Row]:
    folder.mkdir(exist_ok=True)
    store = Store(folder / "rows", Header.here())
    study = StudyScene(name, Scene.load(name), "digest")
    rows = measure_unrelated(store, [study], ways, True, poses=POSES, clock=steady())
    return {row.way: row for row in rows}


@pytest.mark.parametrize("name", ["bounce-and-steer", "double-wishbone"])
def test_every_way_is_timed_and_is_as_near_as_asked(name: str, tmp_path: Path) -> None:
    rows = race(tmp_path, name)
    assert set(rows) == {MAP, ALONE, *OTHERS}
    for way, row in rows.items():
        assert row.status == "measured", row
        assert row.configurations == POSES[way in OTHERS]
        assert row.times["solve"].repeats == REPEATS_QUICK
        assert 0.0 < row.errors["position"].largest < NEAR
    assert "set-up" in rows[MAP].times
    (table,) = unrelated_tables(rows.values())
    assert {line[0].split(",")[0] for line in table.rows} == set(rows)


def test_a_scene_that_jumps_has_the_same_inputs_as_those_that_are_solved_together() -> None:
    scene = Scene.load("bounce-on-a-heaving-chassis")
    draw = Draw.of(scene, 50)
    jumping, instants = draw.as_scene(20)
    laws = laws_at(jumping, instants)
    for name, values in draw.inputs.items():
        np.testing.assert_array_equal(laws[name][:, 0], values[:20])
    assert not laws["heave"][:, 0].any()
    driven = laws_at(scene, study_instants(scene))["arm_angle"][:, 0]
    assert (
        driven.min() - 0.05 < draw.ranges["arm_angle"][0] < draw.ranges["arm_angle"][1] < driven.max() + 0.05
    )


def test_poses_that_are_wrong_or_not_proven_are_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def off(scene: Scene, inputs: Any, tolerance: float) -> Any:
        found = solve_poses(scene, inputs, tolerance)
        return replace(found, position={name: place + 1e-6 for name, place in found.position.items()})

    monkeypatch.setattr(unrelated, "solve_poses", off)
    row = race(tmp_path / "off", ways=())[ALONE]
    assert row.errors["position"].largest == pytest.approx(1e-6, rel=1e-3)

    def doubtful(scene: Scene, inputs: Any, tolerance: float) -> Any:
        found = solve_poses(scene, inputs, tolerance)
        return replace(found, bound=np.where(np.arange(len(found.bound)) == 250, 2e-9, found.bound))

    monkeypatch.setattr(unrelated, "solve_poses", doubtful)
    row = race(tmp_path / "doubtful", ways=())[ALONE]
    assert row.status == "failed"
    assert "proven to 2e-09 mm only" in row.reason


def test_a_way_that_fails_is_told_with_its_reason_and_the_others_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuses(*_: object) -> Any:
        raise ValueError("it does not want to")

    monkeypatch.setattr(unrelated, "kinematic_map", refuses)
    rows = race(tmp_path, ways=())
    assert (rows[MAP].status, rows[MAP].reason) == ("failed", "ValueError: it does not want to")
    assert rows[ALONE].status == "measured"
    (table,) = unrelated_tables(rows.values())
    assert any("it does not want to" in note for note in table.notes)


def test_inputs_without_a_reference_are_told_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def beyond(cls: Any, scene: Scene, poses: int) -> Draw:
        return Draw(scene, {}, {"arm_angle": np.full(poses, 0.01), "rack": np.zeros(poses)})

    monkeypatch.setattr(Draw, "of", classmethod(beyond))
    rows = race(tmp_path, ways=())
    assert all(row.status == "failed" and "no reference" in row.reason for row in rows.values())
