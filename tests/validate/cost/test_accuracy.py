"""The study measures what it says it does: on a fake clock, of ways whose errors and times are known."""

import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits
from toy_ways import FakeClock, Toy, reference_numbers

from pointcoord import Scene
from validate.cost.accuracy import FULL, QUICK, accuracy_rows, chosen_settings
from validate.cost.row import Row
from validate.cost.scenes import STUDY_SCENES, StudyScene, own_scene, own_scenes, study_scene
from validate.cost.stopwatch import LEAST_REPEATS
from validate.cost.store import Header, Key, Store
from validate.cost.way import LeftOut, Setting

HEADER = Header("p", "m", "python", {}, {})
STEER = study_scene("steer", own_scene("steer"))
HERE = Path(__file__).parent
SUPPORT = HERE.parents[1] / "support"
COSTS = {"set-up": 25_000_000, "solve": 30_000, "rates": 400_000, "output": 5_000}


def rows_of(*toys: Toy, store: Store | None = None, scene: StudyScene = STEER, count: int = 12) -> list[Row]:
    clock = toys[0].clock
    store = store or Store(None, HEADER)
    return list(accuracy_rows([scene], store, toys, configurations=count, clock=clock))


def test_each_phase_has_the_time_that_it_takes() -> None:
    [row] = rows_of(Toy("toy", costs=COSTS))
    expected = {"set-up": 25e-3, "solve": 12 * 3e-5, "rates": 4e-4, "output": 5e-6}
    for phase, seconds in expected.items():
        time = row.times[phase]
        assert (time.lower, time.median, time.upper) == pytest.approx((seconds,) * 3, rel=1e-12)
        assert time.repeats == FULL.repeats >= LEAST_REPEATS
    assert row.times["first"].median == pytest.approx(sum(expected.values()), rel=1e-12)
    assert row.times["first"].repeats == 1
    assert row.seconds("solve", "rates") == pytest.approx((12 * 3e-5 + 4e-4) / 12, rel=1e-12)
    assert row.counts == {"newton_steps": 36}
    assert QUICK.repeats >= LEAST_REPEATS


def test_whatever_it_was_started_with_a_way_runs_by_one_thread() -> None:
    with threadpool_limits(limits=2):
        before = {pool["num_threads"] for pool in threadpool_info()}
        seen: list[int] = []
        toy = Toy("toy", costs=COSTS)
        toy.before = lambda phase: seen.extend(pool["num_threads"] for pool in threadpool_info())
        rows_of(toy)
        assert {pool["num_threads"] for pool in threadpool_info()} == before
    assert set(seen) == {1}


def test_the_first_run_is_told_apart_from_the_others() -> None:
    toy = Toy("toy", costs=COSTS)
    toy.before = lambda phase: toy.clock.advance(10**9 if not toy.runs and phase == "set-up" else 0)
    [row] = rows_of(toy)
    assert row.times["first"].median > 1.0
    assert row.times["set-up"].upper == pytest.approx(25e-3)


def test_a_quick_way_runs_until_a_sample_lasts_and_a_collector_never_does() -> None:
    toy = Toy("toy", costs={"solve": 1_000_000 // 12})
    rows_of(toy)
    # The first, the one that warms up, and nine samples of 20 ms of a way that takes 1 ms and a rounding.
    assert len(toy.runs) == 2 + FULL.repeats * 21
    assert not any(toy.collecting)


def test_ways_take_turns_in_another_order_each_round() -> None:
    log: list[str] = []
    clock = FakeClock()
    toys = [Toy(name, clock, {"solve": 10**8}) for name in ("a", "b", "c", "d", "e")]
    for toy in toys:
        toy.before = lambda phase, name=toy.name: log.append(name) if phase == "solve" else None
    rows_of(*toys)
    raced = log[2 * len(toys) :]
    rounds = [tuple(raced[i : i + 5]) for i in range(0, len(raced), 5)]
    assert len(rounds) == FULL.repeats
    assert all(sorted(order) == ["a", "b", "c", "d", "e"] for order in rounds)
    assert len(set(rounds)) > FULL.repeats // 2


def test_a_way_that_returns_a_wrong_number_has_that_error_and_is_not_just_fast() -> None:
    clock = FakeClock()

    def wrong(numbers: dict[str, dict[str, np.ndarray]]) -> None:
        numbers["position"]["wheel_centre"][7, 1] += 0.5

    right, lying = rows_of(Toy("right", clock, COSTS), Toy("lying", clock, {"solve": 100_000}, spoil=wrong))
    assert right.errors["position"].largest < 1e-13
    assert lying.errors["position"].largest == pytest.approx(0.5)
    assert lying.status == "measured"
    assert lying.errors["velocity"] == right.errors["velocity"]


def test_a_way_that_answers_for_other_instants_has_the_error_of_that() -> None:
    late = Toy("late")

    def shifted(numbers: dict[str, dict[str, np.ndarray]]) -> None:
        for arrays in numbers.values():
            for name in arrays:
                arrays[name] = np.roll(arrays[name], 1, axis=0)

    late.spoil = shifted
    [row] = rows_of(late)
    assert row.errors["position"].largest > 1.0


def failing(phase: str, error: Exception, run: int) -> Toy:
    """A toy that raises in a phase of one of its runs."""
    toy = Toy("toy", costs={"set-up": 10**8})
    seen: Counter[str] = Counter()

    def before(now: str) -> None:
        seen[now] += 1
        if now == phase and seen[now] == run:
            raise error

    toy.before = before
    return toy


@pytest.mark.parametrize("phase", ["set-up", "solve", "rates", "output"])
@pytest.mark.parametrize("run", [1, 2, 5])
def test_a_way_that_breaks_down_in_any_run_has_a_failed_row_with_its_reason(phase: str, run: int) -> None:
    clock = FakeClock()
    toy, other = failing(phase, ZeroDivisionError("by\nnothing"), run), Toy("other", clock)
    toy.clock = clock
    row, fine = rows_of(toy, other)
    assert (row.status, row.reason) == ("failed", "ZeroDivisionError: by nothing")
    assert (row.times, row.errors) == ({}, {})
    assert fine.status == "measured"


def test_what_does_not_apply_is_left_out_and_what_is_no_number_has_failed() -> None:
    def spoiled(numbers: dict[str, dict[str, np.ndarray]]) -> None:
        numbers["acceleration"]["wheel_centre"][3] = np.nan

    [row] = rows_of(failing("set-up", LeftOut("not for struts"), 1))
    assert (row.status, row.reason) == ("left out", "not for struts")
    [row] = rows_of(Toy("toy", package="no_such_package"))
    assert row.status == "left out"
    assert "'no_such_package'" in row.reason
    [row] = rows_of(failing("solve", ImportError("needs the package 'x'"), 1))
    assert (row.status, row.reason) == ("left out", "needs the package 'x'")
    [row] = rows_of(Toy("toy", spoil=spoiled))
    assert row.status == "failed"
    assert "acceleration of wheel_centre is nan at 1 of 12 instants" in row.reason
    assert row.seconds("solve") is None


def test_a_quantity_that_is_not_given_is_said() -> None:
    [row] = rows_of(Toy("toy", spoil=lambda numbers: numbers.pop("angular_velocity")))
    assert row.status == "measured"
    assert set(row.not_given) == {"angular_velocity"}


def test_a_slow_way_gets_fewer_instants_and_says_so_but_a_dense_one_all() -> None:
    slow, dense = (Toy("slow", costs={"solve": 10**8}, dense=dense) for dense in (False, True))
    [row] = rows_of(slow, count=96)  # 9.6 s a run; 2 s are allowed
    assert row.configurations == 20 == len(range(0, 96, 5))
    assert "at 20 of the 96 instants, since all of them take 9.6 s" in row.reason
    assert row.times["solve"].median == pytest.approx(2.0)
    assert row.errors["position"].numbers == 20 * 18  # of the six points that move
    assert "first" not in row.times
    [row] = rows_of(dense, count=96)
    assert (row.configurations, row.reason) == (96, "")


def test_a_scene_without_a_pose_fails_with_the_reason_of_the_reference() -> None:
    scene = own_scene("steer")
    far = study_scene(
        "far", scene.model_copy(update={"inputs": {**scene.inputs, "rack": {"constant": 200.0}}})
    )
    [row] = rows_of(Toy("toy"), scene=far)
    assert row.status == "failed"
    assert row.reason.startswith("there is no reference to hold it to: ")


def test_a_row_that_is_there_is_not_measured_again_and_others_are_added(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    first = Toy("a", settings=(Setting("1", 1.0), Setting("2", 2.0)), costs=COSTS)
    rows = rows_of(first, store=Store(path, HEADER))
    again = Toy("a", settings=first.settings)
    other = Toy("b", again.clock)
    assert rows_of(again, other, store=Store(path, HEADER))[:2] == rows
    assert again.runs == []
    assert other.runs
    assert [row.setting for row in rows] == ["1", "2"]
    changed = replace(STEER, digest="another")
    rows_of(again, store=Store(path, HEADER), scene=changed)
    assert again.runs


PROGRAM = """
import sys
from pathlib import Path
sys.path[:0] = sys.argv[2:]
from test_accuracy import raced_ways, STEER, HEADER
from validate.cost.accuracy import accuracy_rows
from validate.cost.store import Store
accuracy_rows([STEER], Store(Path(sys.argv[1]), HEADER), raced_ways(), configurations=4)
"""


def raced_ways() -> list[Toy]:
    """Ways that take real time, 20 ms a run, which is as long as a sample lasts at least."""

    def wait(phase: str) -> None:
        if phase == "solve":
            time.sleep(0.02)

    return [Toy(name, before=wait) for name in ("a", "b", "c")]


def test_a_killed_run_goes_on_and_repeats_nothing_that_was_recorded(tmp_path: Path) -> None:
    path = tmp_path / "rows"
    command = [sys.executable, "-c", PROGRAM, str(path), str(HERE), str(SUPPORT)]
    process = subprocess.Popen(command)
    try:
        while process.poll() is None and (not path.exists() or path.read_text().count('"round"') < 8):
            time.sleep(0.01)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()
    assert process.returncode == -signal.SIGKILL
    before = Store(path, HEADER)
    assert before.rows() == ()
    kept = path.read_bytes()
    toys = raced_ways()
    rows = accuracy_rows([STEER], Store(path, HEADER), toys, configurations=4)
    assert path.read_bytes().startswith(kept)
    assert [row.way for row in rows] == ["a", "b", "c"]
    for toy in toys:
        done = before.samples(Key("accuracy", "steer", STEER.digest, toy.name, configurations=4))
        # One run to warm up in this process; samples of one run each, since one takes 20 ms.
        assert len(toy.runs) == 1 + FULL.repeats - len(done)
    text = path.read_text(encoding="utf-8")
    assert text.count('"begun"') == 3
    assert text.count('"round"') == 3 * FULL.repeats
    assert all(row.times["solve"].repeats == FULL.repeats for row in rows)


def test_progress_counts_to_its_end_whatever_becomes_of_a_way(tmp_path: Path) -> None:
    told: list[tuple[str, int, int]] = []
    toys = [Toy("a", costs=COSTS), failing("rates", ValueError("no"), 6), Toy("c", package="no_such_package")]
    toys[1].name, toys[1].clock = "b", toys[0].clock
    path = tmp_path / "rows"
    for _ in range(2):
        accuracy_rows(
            [STEER],
            Store(path, HEADER),
            toys,
            configurations=4,
            progress=lambda *what: told.append(what),
            clock=toys[0].clock,
        )
    done = [number for _, number, _ in told]
    assert done == sorted(done)
    assert {of for _, _, of in told} == {3 * (FULL.repeats + 1)}
    assert max(done) < 3 * (FULL.repeats + 1)
    assert any(words == "steer: a, repeat 3" for words, _, _ in told)


def test_a_quick_study_takes_the_first_and_the_last_setting_and_some_between() -> None:
    settings = tuple(Setting(str(n), float(n)) for n in range(12))
    assert [s.words for s in chosen_settings(settings, 3)] in (["0", "5", "11"], ["0", "6", "11"])
    assert chosen_settings(settings[:2], 3) == settings[:2]
    assert chosen_settings(settings, None) == settings


def test_a_users_scene_is_measured_with_all_rates_if_it_asks_for_any_and_else_as_it_is() -> None:
    asks = {
        ("velocity",): ("velocity", "acceleration", "knuckle_rates"),
        ("toe", "knuckle_rates"): ("velocity", "acceleration", "knuckle_rates", "toe"),
        ("toe",): ("toe",),
        (): (),
    }
    for effects, measured in asks.items():
        scene = Scene.load("off-axis-strut").model_copy(update={"effects": effects})
        assert study_scene("mine", scene).scene.effects == measured


def test_the_study_has_its_own_scenes_and_one_is_near_a_toggle() -> None:
    assert tuple(scene.name for scene in own_scenes()) == STUDY_SCENES
    assert {scene.name for scene in own_scenes(quick=True)} < set(STUDY_SCENES)
    near = own_scene("near-toggle")
    least = float(near.functions["arm_angle"].series(np.array([1.0]), 0)[0, 0])
    # The toggle of the paper's car at S = 0 is at 32.228 deg; the scene goes within a hundredth of a degree.
    assert 32.228 < np.degrees(least) < 32.238
    numbers = reference_numbers(near, np.array([0.99999, 1.00001, 1.5]))
    assert np.isfinite(numbers["position"]["wheel_centre"]).all()
