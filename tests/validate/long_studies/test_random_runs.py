"""Random scenes through both models: every scene is counted once, and a planted fault is found."""

import re

import numpy as np
import pytest
from worked_out import worked_out

from pointcoord import Scene
from validate.adjudication.reference_solution import reference_solution
from validate.adjudication.verdicts import NO_OBSTACLE, judged, judged_alone, obstacle, unanswered
from validate.cars.random_cars import KINDS
from validate.cars.random_scenes import RandomScene, random_scene
from validate.cars.registry import VARIANTS
from validate.exit_status import ExitStatus
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.long_studies import random_runs as deep
from validate.long_studies.random_runs import RandomStudy
from validate.long_studies.study import Row
from validate.output.terminal import text_of


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


def test_every_scene_has_one_outcome_and_it_is_counted() -> None:
    study = RandomStudy(12)
    rows = worked_out(study)
    assert [row["number"] for row in rows] == list(range(12))
    data = study.findings(rows).data
    assert sum(counted["scenes"] for counted in data["outcomes"]) == data["scenes"] == 12
    kept = {row["number"] for row in rows if row["scene"] is not None}
    assert {one["number"] for one in data["written_down"]} == kept
    # Every scene is recorded, most of them by their number alone; work that is recorded was done by any run.
    seconds = [100.0, 20.0, *[0.0] * (len(rows) - 2)]
    timed = [row | {"seconds": spent} for row, spent in zip(rows, seconds, strict=True)]
    told = str(study.findings(timed).parts[-1])
    assert told.startswith(f"12 scenes recorded, {len(kept)} of them as a whole scene")
    assert told.endswith("; 120 s of work, of all runs and processes.")
    for row in rows:
        assert {"suspension", "kind", "outcome", "reason", "scene"} <= row.keys() - {None}
        assert set(row) == {*RandomStudy.columns, "part", "number", "seconds", "worker"}
        agreed = row["outcome"].startswith("agreed")
        shares = [row[name] for name in row if name.startswith("share_")]
        assert any(share is not None for share in shares) == agreed
    for one in data["written_down"]:
        assert Scene.from_mapping(one["scene"]) == random_scene(one["number"]).scene


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


def row(number: int, outcome: str, **more: float) -> Row:
    texts = {"suspension": VARIANTS[0].words, "kind": KINDS[0], "outcome": outcome}
    every = {"part": "scenes", "number": number, "seconds": 1.0, "worker": "here"}
    return {**dict.fromkeys(RandomStudy.columns), **every, **texts, **more}


def test_the_status_says_whether_any_disagreed() -> None:
    study = RandomStudy(2)
    agreed = [row(0, "agreed", share_position=0.25), row(1, "agreed", share_position=0.125)]
    findings = study.findings(agreed)
    assert findings.status == ExitStatus.AGREE
    assert re.search(r"^agreed +2 ", text_of(findings.parts), flags=re.M)
    assert findings.data["largest_shares"] == [{"quantity": "position", "share": 0.25, "scene": 0}]
    for outcome in (
        "disagreed in wheel: absolute wrong",
        "pointcoord fails: TypeError",
        "agreed, the reference: pointcoord and absolute wrong",
        "only absolute refuses, locked: answer wrong",
    ):
        wrong = study.findings([agreed[0], row(1, outcome)])
        assert wrong.status == ExitStatus.DISAGREE
        assert outcome in text_of(wrong.parts)
