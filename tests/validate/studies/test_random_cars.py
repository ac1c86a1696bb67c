"""Random scenes through both models: every scene is counted once, and a planted fault is found."""

import re

import pytest
from changed_scenes import scene_with
from counted_study import worked_out

from pointcoord import Scene
from validate.cars.base_cars import variants
from validate.cars.random_scenes import KINDS, random_scene
from validate.exit_status import ExitStatus
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.output.table import text_of
from validate.studies import random_cars as deep
from validate.studies.random_cars import NO_OBSTACLE, NONE_WRONG, judged, obstacle, random_cars, unanswered
from validate.studies.study import Row


def test_every_scene_has_one_outcome_and_it_is_counted() -> None:
    study = random_cars(6)
    rows = worked_out(study)
    assert [row["number"] for row in rows] == list(range(6))
    data = study.summary(rows).data
    assert sum(counted["scenes"] for counted in data["outcomes"]) == data["scenes"] == 6
    kept = {row["number"] for row in rows if row.get("scene") is not None}
    assert {one["number"] for one in data["written_down"]} == kept
    # Work that is recorded was done by any run.
    told = str(study.summary([row | {"seconds": 20.0} for row in rows]).parts[-1])
    assert told.startswith(f"6 scenes recorded, {len(kept)} of them with the whole scene")
    assert told.endswith("; 120 s of work in all runs and processes.")
    for row in rows:
        assert set(row) <= {*study.columns, "part", "number", "seconds", "worker"}
        assert bool(row.get("shares")) == row["outcome"].startswith("agreed")
    for one in data["written_down"]:
        assert Scene.from_mapping(one["scene"]) == random_scene(one["number"]).scene


def test_the_model_with_a_planted_fault_is_the_one_found_wrong_beside_the_other_and_alone() -> None:
    scene = scene_with("bounce-and-steer", samples=3, effects=("velocity", "acceleration", "knuckle_rates"))
    right = {name: formulation(name).solve(scene) for name in (deep.OURS, deep.OTHER)}
    for model, quantity in (
        ("pointcoord", "position"),
        ("absolute", "acceleration"),
        ("absolute", "angular_velocity"),
    ):
        name, *_ = numbers = right[model].numbers[quantity]
        wrong = right[model].with_numbers({quantity: {**numbers, name: numbers[name] + 1e-3}})
        assert judged(scene, *(right | {model: wrong}).values()) == f"{model} wrong"
        assert judged(scene, wrong) == f"{model} wrong"
        assert judged(scene, right[model]) == NONE_WRONG
    assert obstacle(scene) == "no obstacle found"


def test_a_fault_that_both_models_share_is_found_by_the_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = deep.solved

    def shared(name: str, scene: Scene) -> Solution:
        solution = honest(name, scene)
        assert isinstance(solution, Solution)
        moved = solution.position["wheel_centre"] + 1e-3
        return solution.with_numbers({"position": {**solution.position, "wheel_centre": moved}})

    cars = (random_scene(number) for number in range(0, 200, deep.HELD))
    car = next(car for car in cars if deep.examined(car)["outcome"] == "agreed, and with the reference")
    monkeypatch.setattr(deep, "solved", shared)
    found = deep.examined(car)
    assert found["outcome"] == "agreed, the reference: pointcoord and absolute wrong"
    assert found["scene"] is not None
    assert any(word in found["outcome"] for word in deep.FAULTY)


def test_a_refused_scene_is_told_apart_from_one_that_need_not_be() -> None:
    def with_arm(*law: float, samples: int = 3) -> Scene:
        return scene_with("bounce", samples=samples, laws={"arm_angle": {"polynomial": law}})

    assert unanswered(scene_with("bounce", samples=3)) == NO_OBSTACLE
    assert unanswered(with_arm(0.05)) == "an instant has no pose"
    # From 0.8 past the dead point and back, while the instants themselves have poses.
    stop = Scene.load("bounce").time.stop
    over = 4.0 * 0.75 / (0.5 * stop) ** 2
    back = with_arm(0.8, -over * stop / 2, over / 2, samples=2)
    assert unanswered(back) == "no pose between the instants"


def row(number: int, outcome: str, **more: str) -> Row:
    texts = {"suspension": variants()[0].words, "kind": KINDS[0], "outcome": outcome}
    every = {"part": "scenes", "number": number, "seconds": 1.0, "worker": "here"}
    return {**every, **texts, **more}


def test_the_status_says_whether_any_disagreed() -> None:
    study = random_cars(2)
    agreed = [row(k, "agreed", shares=f'{{"position": {share}}}') for k, share in enumerate((0.25, 0.125))]
    findings = study.summary(agreed)
    assert findings.status == ExitStatus.AGREE
    assert re.search(r"^agreed +2 ", text_of(findings.parts), flags=re.M)
    assert findings.data["largest_shares"] == [{"quantity": "position", "share": 0.25, "scene": 0}]
    for outcome in (
        "disagreed in wheel: absolute wrong",
        "pointcoord fails: TypeError",
        "agreed, the reference: pointcoord and absolute wrong",
        "only absolute refuses, locked: pointcoord wrong",
    ):
        wrong = study.summary([agreed[0], row(1, outcome)])
        assert wrong.status == ExitStatus.DISAGREE
        assert outcome in text_of(wrong.parts)
