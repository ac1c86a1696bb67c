"""What a user would write: its error follows its tolerance, and no failure of it passes for an answer."""

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, built_in_scenes
from validate.adjudication.reference_solution import reference_solution, told_by
from validate.cost.way import Setting
from validate.cost.ways import scipy_solvers
from validate.cost.ways.scipy_solvers import WAYS, ScipyWay, SolverStopped
from validate.formulations.protocol import Numbers, Solution

FINE = Setting("", 1e-12)


def short(name: str, samples: int = 21) -> Scene:
    scene = Scene.load(name)
    return scene.model_copy(update={"time": scene.time.model_copy(update={"samples": samples})})


def found(way: ScipyWay, scene: Scene, setting: Setting = FINE) -> Numbers:
    ready = way.prepare(scene, setting)
    return ready.output(ready.rates(ready.solve(scene.instants)))


def largest_error(numbers: Numbers, reference: Solution, scene: Scene, quantity: str) -> float:
    names = told_by(reference, scene)[quantity]
    return max(float(np.abs(numbers[quantity][n] - reference.numbers[quantity][n]).max()) for n in names)


@pytest.mark.parametrize("name", built_in_scenes())
def test_every_solver_gives_all_that_a_scene_asks_for_as_the_reference_does(name: str) -> None:
    scene = short(name, 11)
    reference = reference_solution(scene)
    for way in WAYS:
        numbers = found(way, scene)
        for quantity, names in told_by(reference, scene).items():
            assert set(names) <= set(numbers[quantity]), quantity
            size = max(float(np.abs(reference.numbers[quantity][n]).max()) for n in names)
            # A last step below 1e-12 of coordinates up to 1 leaves as much or less; these cars raise it by
            # some ten, and by another ten in what is twice differentiated.
            assert largest_error(numbers, reference, scene, quantity) < 1e-10 * size, (way.name, quantity)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_the_error_follows_the_tolerance(way: ScipyWay) -> None:
    scene = short("off-axis-strut", 51)
    reference = reference_solution(scene)
    errors = [
        largest_error(found(way, scene, Setting("", value)), reference, scene, "position")
        for value in (1e-2, 1e-6, 1e-12)
    ]
    assert errors[0] > 100.0 * errors[1] > 1e4 * errors[2], errors
    assert errors[0] > 1e-3
    assert errors[2] < 1e-9


def test_a_jacobian_saves_evaluations_of_the_equations() -> None:
    scene = short("bounce")
    counts = {}
    for way in WAYS:
        ready = way.prepare(scene, FINE)
        counts[way.name] = ready.counts(ready.solve(scene.instants))
    for solver in ("scipy-root", "least-squares"):
        without, told = counts[solver], counts[f"{solver}-jac"]
        assert without["residuals"] > 2 * told["residuals"]
        assert without["jacobians"] == 0 < told["jacobians"]
        assert told["residuals"] >= 21


def steered(speed: float) -> Scene:
    """The paper's car, its rack going at mm/s from the middle."""
    content = Scene.load("steer").model_dump(exclude_none=True)
    content["inputs"]["rack"] = {"polynomial": [0.0, speed]}
    content["time"] = {"start": 0.0, "stop": 2.0, "samples": 81}
    return Scene.from_mapping(content)


def test_differences_fail_where_a_coordinate_is_nearly_zero_and_the_jacobian_does_not() -> None:
    """MINPACK takes steps for its differences in proportion to a coordinate: here one comes to 1e-17."""
    scene = steered(100.0)  # at 0.6 s the rack's end is at y = 0
    before, beyond = scene.instants[:25], scene.instants[:26]
    ready = WAYS[0].prepare(scene, FINE)
    assert len(ready.solve(before).times) == 25
    with pytest.raises(SolverStopped, match="not making good progress"):
        ready.solve(beyond)
    assert len(WAYS[1].prepare(scene, FINE).solve(beyond).times) == 26


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_a_motion_through_a_fold_is_no_answer(way: ScipyWay) -> None:
    scene = steered(101.0)  # the tie rod ends at 130 mm
    ready = way.prepare(scene, Setting("", 1e-9))
    whole = scene.instants[scene.instants < 1.25]
    assert len(ready.output(ready.solve(whole))["position"]["wheel_centre"]) == len(whole)
    with pytest.raises(SolverStopped, match="at t = 1"):
        ready.solve(scene.instants)


def test_an_answer_on_another_side_than_is_drawn_is_refused() -> None:
    scene = short("off-axis-strut")
    ready = WAYS[1].prepare(scene, FINE)
    drawn = dict(ready.linkage.drawn)
    k, outer, inner = (drawn[n] for n in ("strut_top", "tie_rod_outer", "tie_rod_inner"))
    normal = np.cross(k, outer)
    drawn["tie_rod_inner"] = inner - 2.0 * (inner @ normal) / (normal @ normal) * normal
    planted = replace(ready, linkage=replace(ready.linkage, drawn=drawn))
    with pytest.raises(SolverStopped, match="another assembly"):
        planted.solve(scene.instants)


def answering(change: Callable[[Any], Any]) -> Callable[..., Any]:
    """The solver, whose answers are changed."""
    real = scipy_solvers.root

    def root(*arguments: Any, **options: Any) -> Any:
        return change(real(*arguments, **options))

    return root


def test_a_solver_that_fails_is_told_and_one_that_is_wrong_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = short("off-axis-strut")
    reference = reference_solution(scene)
    ready = WAYS[1].prepare(scene, FINE)

    def failed(found: Any) -> Any:
        return SimpleNamespace(success=False, message="gave\nup", x=found.x, fun=found.fun)

    def wrong(found: Any) -> Any:
        return SimpleNamespace(success=True, message="", x=found.x + 1e-7, fun=found.fun)

    def no_root(found: Any) -> Any:
        return SimpleNamespace(success=True, message="", x=found.x, fun=found.fun + 1e-3)

    with monkeypatch.context() as patch:
        patch.setattr(scipy_solvers, "root", answering(failed))
        with pytest.raises(SolverStopped, match="at t = 0 s: gave up"):
            ready.solve(scene.instants)
    with monkeypatch.context() as patch:
        patch.setattr(scipy_solvers, "root", answering(no_root))
        with pytest.raises(SolverStopped, match=r"at t = 0 s: the equations are left at 0\.001"):
            ready.solve(scene.instants)
    with monkeypatch.context() as patch:
        patch.setattr(scipy_solvers, "root", answering(wrong))
        numbers = ready.output(ready.rates(ready.solve(scene.instants)))
    # A ten-millionth of 1024 mm.
    assert largest_error(numbers, reference, scene, "position") > 5e-5


def test_a_scene_without_rates_gets_positions_only() -> None:
    scene = short("double-wishbone").model_copy(update={"effects": ("toe",)})
    ready = WAYS[1].prepare(scene, FINE)
    solved = ready.solve(scene.instants)
    assert ready.rates(solved) is solved
    assert set(ready.output(solved)) == {"position", "wheel"}
