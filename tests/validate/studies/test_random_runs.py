"""The deep run: every scene is counted once, and a kill at any moment loses nothing."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import reference_solution
from validate.adjudication.verdicts import NO_OBSTACLE, judged, judged_alone, obstacle, unanswered
from validate.cars.random_cars import KINDS
from validate.cars.random_scenes import SEED, RandomScene, random_scene
from validate.cars.registry import VARIANTS
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.studies import random_runs as deep
from validate.studies.chunk_store import CHUNK, Chunk, Store, StoreError

ROOT = Path(__file__).parents[3]


def chunk(number: int, found: tuple[int, ...] = ()) -> Chunk:
    return Chunk(number, {"double wishbone/regular/agreed": CHUNK}, {"position": (0.25, 7)}, found, 1.0)


def test_a_number_names_one_scene() -> None:
    for number in range(40):
        assert random_scene(number).scene == random_scene(number).scene
    assert random_scene(1).scene != random_scene(2).scene


def test_the_scenes_cover_every_kind_input_side_and_orientation() -> None:
    cars = [random_scene(number) for number in range(400)]
    assert {car.kind for car in cars} == set(KINDS)
    assert {car.variant for car in cars} == set(VARIANTS)
    for car in cars:
        part = car.scene.mechanism
        assert (part.type, part.closure) == (car.variant.suspension, car.variant.closure)
    assert {car.scene.mechanism.side for car in cars} == {"left", "right"}
    parts = [part for car in cars for part in car.scene.inputs.values()]
    given = {k for part in parts for k, v in part.model_dump().items() if v is not None}
    assert given == {"constant", "polynomial", "sine", "table"}
    assert {("heave" in car.scene.inputs) for car in cars} == {True, False}
    assert sum(car.scene.mechanism.up == (0.0, 0.0, 1.0) for car in cars) in range(100, 300)
    sizes = [float(np.ptp(np.array(list(c.scene.mechanism.points.values())), axis=0).max()) for c in cars]
    assert min(sizes) < 10.0
    assert max(sizes) > 1e5


def test_a_scene_that_is_close_to_a_lock_is_close_to_singular() -> None:
    conditions = []
    for number in range(200):
        car = random_scene(number)
        if car.kind in ("toggle", "dead arm", "upper lock"):
            try:
                conditions.append(formulation("pointcoord").solve(car.scene).accuracy.condition.max())
            except Exception:
                continue
    assert max(conditions) > 1e5


def test_every_scene_has_one_outcome(tmp_path: Path) -> None:
    path = tmp_path / "store.jsonl"
    store = Store(path, SEED)
    done = deep.run_chunk(0, store, frozenset())
    assert sum(done.outcomes.values()) == CHUNK
    record = store.read()
    assert record.chunks == {0: replace(done, seconds=record.chunks[0].seconds)}
    assert sorted(record.findings) == list(done.found)
    before = path.read_bytes()
    deep.run_chunk(0, store, frozenset(record.findings))
    added = path.read_bytes()[len(before) :]
    assert b'"scene"' not in added, "a finding that is there is not written twice"
    assert store.read().outcomes() == record.outcomes(), "a chunk done twice counts once"


@pytest.mark.parametrize("model", ["pointcoord", "absolute"])
@pytest.mark.parametrize("quantity", ["position", "velocity", "acceleration", "angular_velocity"])
def test_the_model_with_a_planted_fault_is_the_one_found_wrong(model: str, quantity: str) -> None:
    scene = Scene.load("bounce-and-steer")
    time = scene.time.model_copy(update={"samples": 3})
    scene = scene.model_copy(update={"time": time, "effects": ("velocity", "acceleration", "knuckle_rates")})
    solutions = {name: formulation(name).solve(scene) for name in (deep.OURS, deep.OTHER)}
    faulty = dict(solutions[model].numbers[quantity])
    name = next(iter(faulty))
    faulty[name] = faulty[name] + 1e-3
    solutions[model] = solutions[model].with_numbers({quantity: faulty})
    assert judged(scene, solutions["pointcoord"], solutions["absolute"]) == f"{model} wrong"


def test_a_fault_that_both_models_share_is_found_by_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = deep._solved

    def shared(name: str, car: RandomScene) -> Solution:
        solution = honest(name, car)
        moved = solution.position["wheel_centre"] + 1e-3
        return solution.with_numbers({"position": {**solution.position, "wheel_centre": moved}})

    cars = (random_scene(number) for number in range(0, 200, deep.HELD))
    car = next(car for car in cars if deep.examine(car).outcome == "agreed, and with the reference")
    monkeypatch.setattr(deep, "_solved", shared)
    found = deep.examine(car)
    assert found.outcome == "agreed, the reference: pointcoord and absolute wrong"
    assert found.kept
    assert any(word in found.outcome for word in deep.FAULTY)


def test_an_answer_that_stands_alone_is_held_to_the_reference() -> None:
    scene = Scene.load("bounce").model_copy(update={"effects": ()})
    scene = scene.model_copy(update={"time": scene.time.model_copy(update={"samples": 3})})
    answer = formulation("absolute").solve(scene)
    assert judged_alone(scene, answer) == "answer right"
    moved = {name: place + 1e-6 for name, place in answer.position.items()}
    assert judged_alone(scene, answer.with_numbers({"position": moved})) == "answer wrong"
    reference: Solution = reference_solution(scene)
    assert reference.position["wheel_centre"] == pytest.approx(answer.position["wheel_centre"], abs=1e-10)
    assert obstacle(scene) == "no obstacle found"


def test_a_refused_scene_is_told_apart_from_one_that_need_not_be() -> None:
    scene = Scene.load("bounce")
    part = scene.inputs["arm_angle"]
    assert unanswered(scene) == NO_OBSTACLE

    def with_arm(law: tuple[float, ...]) -> Scene:
        held = part.model_copy(update={"polynomial": law})
        return scene.model_copy(update={"inputs": {**scene.inputs, "arm_angle": held}, "time": time})

    time = scene.time.model_copy(update={"samples": 3})
    assert unanswered(with_arm((0.05,))) == "an instant has no pose"
    # From 0.8 past the dead point and back, while the instants themselves have poses.
    stop = scene.time.stop
    over = 4.0 * 0.75 / (0.5 * stop) ** 2
    time = scene.time.model_copy(update={"samples": 2})
    assert unanswered(with_arm((0.8, -over * stop / 2, over / 2))) == "no pose between the instants"


def test_a_torn_line_is_ignored_and_its_chunk_is_done_again(tmp_path: Path) -> None:
    path = tmp_path / "store.jsonl"
    store = Store(path, SEED)
    store.chunk(chunk(0))
    whole = path.read_bytes()
    store.chunk(chunk(1, (CHUNK,)))
    line = path.read_bytes()[len(whole) :]
    for kept in range(1, len(line) - 1):
        path.write_bytes(whole + line[:kept])
        assert list(store.read().chunks) == [0]
        store.finding(2 * CHUNK, {"outcome": "agreed"})
        store.chunk(chunk(2, (2 * CHUNK,)))
        after = store.read()
        assert list(after.chunks) == [0, 2], "what follows a torn line is read"
        assert after.torn == (1 if line[:kept].strip() else 0)


def test_a_chunk_without_its_findings_is_not_done(tmp_path: Path) -> None:
    store = Store(tmp_path / "store.jsonl", SEED)
    store.chunk(chunk(3, (3 * CHUNK + 4,)))
    assert not store.read().chunks
    store.finding(3 * CHUNK + 4, {"outcome": "disagreed"})
    assert list(store.read().chunks) == [3]


@pytest.mark.parametrize("line", ['{"other": 1}', "[1]", "7"])
def test_a_file_of_something_else_is_refused(tmp_path: Path, line: str) -> None:
    path = tmp_path / "store.jsonl"
    path.write_text(line + "\n")
    with pytest.raises(StoreError, match=r"line 1 .* give another file"):
        Store(path, SEED).read()


def test_results_of_another_recipe_are_not_mixed_in(tmp_path: Path) -> None:
    path = tmp_path / "store.jsonl"
    Store(path, SEED + 1).chunk(chunk(0))
    with pytest.raises(StoreError, match="seed"):
        Store(path, SEED).read()


def test_results_of_another_method_are_not_mixed_in(tmp_path: Path) -> None:
    path = tmp_path / "store.jsonl"
    Store(path, SEED, "pointcoord-map").chunk(chunk(0))
    assert Store(path, SEED, "pointcoord-map").read().chunks
    with pytest.raises(StoreError, match=r"solved by pointcoord-map, not by pointcoord; give another file"):
        Store(path, SEED).read()


def test_scenes_can_be_solved_through_the_map_and_its_faults_are_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    car = next(c for c in map(random_scene, range(20)) if deep.examine(c).outcome.startswith("agreed"))
    assert deep.examine(car, "pointcoord-map").outcome.startswith("agreed")
    honest = deep._solved

    def off(name: str, car: RandomScene) -> Solution:
        solution = honest(name, car)
        if name != "pointcoord-map":
            return solution
        moved = solution.position["wheel_centre"] + 1e-3
        return solution.with_numbers({"position": {**solution.position, "wheel_centre": moved}})

    monkeypatch.setattr(deep, "_solved", off)
    found = deep.examine(car, "pointcoord-map")
    assert found.outcome == "disagreed in position: pointcoord-map wrong"
    assert deep.examine(car).outcome.startswith("agreed")


def test_the_status_says_whether_any_disagreed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "store.jsonl"
    Store(path, SEED).chunk(chunk(0))
    command = ["--count", str(CHUNK), "--store", str(path)]
    assert deep.main(command) == 0
    shown = capsys.readouterr().out
    assert f"agreed             {CHUNK}" in shown.replace("  mechanisms", "\n")
    assert "0.25" in shown
    Store(path, SEED).chunk(
        replace(chunk(0), outcomes={"macpherson, collinear/toggle/disagreed in wheel: absolute wrong": CHUNK})
    )
    assert deep.main(command) == 1
    path.write_text("{}\n")
    assert deep.main(command) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


@pytest.mark.parametrize("workers", [1, 2])
def test_nothing_is_lost_or_done_twice_when_a_run_is_killed(tmp_path: Path, workers: int) -> None:
    path = tmp_path / "store.jsonl"
    program = [
        sys.executable,
        "-m",
        "validate.studies.random_runs",
        "--count",
        str(2 * CHUNK),
        "--store",
        str(path),
    ]
    program += ["--workers", str(workers)]
    for _ in range(2):
        before = path.stat().st_size if path.exists() else 0
        run = subprocess.Popen(program, start_new_session=True, stdout=subprocess.DEVNULL, cwd=ROOT)
        # Killed as soon as something more is written down: in the middle of a chunk.
        while run.poll() is None and (not path.exists() or path.stat().st_size == before):
            time.sleep(0.005)
        if run.poll() is None:
            # The whole session, workers included, as when a machine goes down.
            os.killpg(run.pid, signal.SIGKILL)
        assert run.wait() in (-signal.SIGKILL, 0, 1)
    last = subprocess.run(program, check=False, stdout=subprocess.DEVNULL, cwd=ROOT)
    assert last.returncode in (0, 1)
    lines = [json.loads(text) for text in path.read_text().split("\n") if text.endswith("}")]
    assert sorted(line["chunk"] for line in lines if "chunk" in line) == [0, 1]
    written = [line["scene"] for line in lines if "scene" in line]
    assert len(written) == len(set(written))
    record = Store(path, SEED).read()
    assert sum(record.outcomes().values()) == 2 * CHUNK
    if workers == 1:
        again = deep.run_chunk(1, Store(tmp_path / "again.jsonl", SEED), frozenset())
        assert record.chunks[1].outcomes == again.outcomes
        assert record.chunks[1].found == again.found
