"""What effects cost: every choice is measured beside a copy of its own bytes."""

from itertools import count
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from pointcoord import Scene, simulate
from pointcoord.effects.registry import EFFECTS
from validate.cost import effects
from validate.cost.effects import ALL, CHOICES, POINT_STATES, RATES, SUMS, Reading, measure_effects
from validate.cost.row import NO_EFFECT, Row, Time
from validate.cost.scenes import StudyScene
from validate.cost.stopwatch import LEAST_REPEATS, Clock, Laps
from validate.cost.store import Header, Store
from validate.cost.tables import effects_tables


def study(name: str = "bounce", **changes: object) -> StudyScene:
    """A built-in scene, changed."""
    return StudyScene(name, Scene.load(name).model_copy(update=changes), f"digest {sorted(changes)}")


def steady() -> Clock:
    """A clock that goes on by 50 ms whenever it is read."""
    ticks = count(0, 50_000_000)
    return lambda: next(ticks)


def memory(path: Path) -> Store:
    """A store of its own."""
    return Store(path / "rows", Header.here())


def test_every_choice_is_read_and_copied_and_counts_what_it_computes(tmp_path: Path) -> None:
    rows = measure_effects(memory(tmp_path), [study()], True, instants=50, clock=steady())
    found = {row.setting: row for row in rows}
    assert list(found) == list(CHOICES)
    assert set(EFFECTS) < set(found)
    for row in rows:
        assert (row.part, row.status, row.configurations) == ("effects", "measured", 50)
        assert {phase: time.repeats for phase, time in row.times.items()} == {
            "read": LEAST_REPEATS,
            "copy": LEAST_REPEATS,
        }
    # Of the paper's car six points move and four are the chassis'.
    moving, points = 6, 10
    counts = {name: row.counts for name, row in found.items()}
    assert counts[NO_EFFECT] == counts[SUMS] == {"derivatives": 1, "sums": 3 * moving, "numbers": 3 * points}
    for angle in ("toe", "caster"):
        assert counts[angle] == {**counts[NO_EFFECT], "numbers": 3 * points + 1}
    assert counts["velocity"] == {"derivatives": 2, "sums": 6 * moving, "numbers": 6 * points}
    assert counts[RATES] == {"derivatives": 3, "sums": 9 * moving, "numbers": 9 * points}
    assert counts[ALL]["sums"] == counts[RATES]["sums"]
    assert CHOICES[RATES] == POINT_STATES == ("velocity", "acceleration")


def test_whatever_it_was_started_with_a_motion_is_read_by_one_thread(tmp_path: Path) -> None:
    seen: set[int] = set()
    ticks = steady()

    def clock() -> int:
        seen.update(pool["num_threads"] for pool in threadpool_info())
        return ticks()

    with threadpool_limits(limits=2):
        measure_effects(memory(tmp_path), [study()], True, instants=50, clock=clock)
    assert seen == {1}


@pytest.mark.parametrize("name", ["bounce", "bounce-on-a-heaving-chassis", "double-wishbone"])
def test_the_sums_alone_are_the_positions_that_reading_gives(name: str) -> None:
    scene = Scene.load(name)
    content = scene.model_dump(mode="json", exclude_none=True) | {"effects": []}
    for axis, far in enumerate((1e4, -3e3, 2e3)):
        for place in content["mechanism"]["points"].values():
            place[axis] += far
    motion = simulate(Scene.from_mapping(content))
    instants = np.linspace(scene.time.start, scene.time.stop, 5000)
    arrays = []
    for bare in (False, True):
        out, other = (np.zeros((motion.height, len(instants))) for _ in range(2))
        Reading(motion, instants, bare).job(out, other)(Laps())
        assert np.array_equal(out, other)
        arrays.append(out)
    assert np.array_equal(*arrays)


def test_what_is_held_is_not_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = measure_effects(memory(tmp_path), [study()], True, instants=20, clock=steady())
    monkeypatch.setattr(effects, "simulate", lambda _: pytest.fail("solved again"))
    assert measure_effects(memory(tmp_path), [study()], True, instants=20) == first


def test_a_scene_that_cannot_be_solved_says_why_in_each_row(tmp_path: Path) -> None:
    locked = study(inputs={"arm_angle": {"polynomial": [1.57, 1.0]}, "rack": {"constant": 0.0}})
    rows = measure_effects(memory(tmp_path), [locked], True, instants=20, clock=steady())
    assert [row.status for row in rows] == ["failed"] * len(CHOICES)
    assert all("'arm_angle' is" in row.reason for row in rows)
    (table,) = effects_tables(rows)
    assert not table.rows
    assert rows[0].reason in "".join(table.notes)


def test_a_table_gives_times_of_an_instant_and_ratios_in_one_run() -> None:
    def row(setting: str, read: float, copy: float) -> Row:
        times = {name: Time(t, 0.9 * t, 1.1 * t, 9) for name, t in (("read", read), ("copy", copy))}
        return Row(
            "effects", "car", "series", setting, configurations=1000, times=times, counts={"numbers": 3}
        )

    (table,) = effects_tables([row(NO_EFFECT, 2e-3, 1e-3), row("toe", 5e-3, 2e-3)])
    assert "1000 instants" in table.title
    assert [line[2:] for line in table.rows] == [
        ("2 us", "10 %", "2.00", "1.00"),
        ("5 us", "10 %", "2.50", "2.50"),
    ]
