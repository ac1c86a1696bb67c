"""Every way gives what a scene asks for, as exactly as it is set; no failure of one passes for an answer."""

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import PointcoordError, Scene
from validate.cost.errors import errors_of, truth_of
from validate.cost.scenes import own_scene, study_instants
from validate.cost.way import Way
from validate.cost.ways import scipy_solvers
from validate.cost.ways.registry import WAYS, ways_named
from validate.errors import NoAnswer
from validate.formulations.protocol import Numbers, Solution

# What solves each instant, each as finely as it can be set.
EXACT = [way.name for way in WAYS if way.name not in ("map", "series")]
PEERS = ("mujoco", "exudyn")


def way(name: str) -> Way:
    return ways_named([name])[0]


def answer(name: str, scene: Scene, instants: Any, value: float | None = None) -> Numbers:
    found = way(name)
    return found.prepare(scene, found.values[-1] if value is None else value)(instants)


@cache
def truth(name: str, effects: tuple[str, ...], count: int) -> tuple[Scene, Any, Solution]:
    """A scene of the study, asking for these effects, its instants, and what is right there."""
    scene = own_scene(name)
    scene = scene.model_copy(update={"effects": effects}) if effects else scene
    instants = study_instants(scene, count)
    return scene, instants, truth_of(scene, instants)


def errors(
    who: str, name: str, value: float | None = None, effects: tuple[str, ...] = (), count: int = 9
) -> dict[str, float]:
    """The largest by quantity; nothing that the scene asks for is missing."""
    scene, instants, right = truth(name, effects, count)
    found = errors_of(answer(who, scene, instants, value), right)
    return {quantity: columns["error"] for quantity, columns in found.items()}


@pytest.mark.parametrize("name", ["off-axis-strut", "five-link"])
@pytest.mark.parametrize("who", EXACT)
def test_what_solves_each_instant_is_off_by_its_rounding_in_every_quantity(who: str, name: str) -> None:
    # Coordinates of up to 1024 mm; a last step of 1e-12 of them leaves as much, and these cars raise it by
    # some ten and in what is twice differentiated by another ten. Others square the last step.
    limit = 1e-8 if who.startswith(("scipy", "least")) else 1e-10
    value = None if who == "absolute" else 1e-12
    for quantity, error in errors(who, name, value).items():
        assert error < limit, quantity


@pytest.mark.parametrize("who", ["relative", "scipy-root", "scipy-root-jac", "least-squares", *PEERS])
def test_the_error_follows_the_setting(who: str) -> None:
    found = [errors(who, "off-axis-strut", value)["position"] for value in (1e-2, 1e-12)]
    assert 1e-6 < found[0] < 100.0
    assert found[1] < 1e-4 * found[0]


@pytest.mark.parametrize("who", [one.name for one in WAYS])
@pytest.mark.parametrize("effects", [("wheel_angles",), ("velocity",), ("knuckle_rates", "toe")])
def test_a_way_gives_what_a_scene_asks_for_and_no_rates_beside(who: str, effects: tuple[str, ...]) -> None:
    found = errors(who, "bounce", None, effects, 3)
    assert all(error < 1e-7 for error in found.values())
    scene, instants, _ = truth("bounce", effects, 3)
    given = answer(who, scene, instants)
    # The tree and the programs tell of all rates or of none.
    assert "velocity" in found or not effects or "velocity" not in given


def steered(speed: float) -> Scene:
    """The paper's car, its rack going at mm/s from the middle."""
    time = {"start": 0.0, "stop": 2.0, "samples": 81}
    return scene_with("steer", laws={"rack": {"polynomial": [0.0, speed]}}, time=time)


@pytest.mark.parametrize("who", EXACT)
def test_a_motion_through_a_fold_is_no_answer(who: str) -> None:
    scene = steered(101.0)  # the tie rod ends at 130 mm
    solve = way(who).prepare(scene, 1e-9)
    whole = scene.instants[scene.instants < 1.2]
    # Differences for a Jacobian fail where a coordinate is nearly zero, as at the middle of the rack.
    assert len(solve(whole)["position"]["wheel_centre"]) == len(whole)
    with pytest.raises(Exception, match=r"t = 1\.|instant") as caught:
        solve(scene.instants)
    assert "Error" in type(caught.value).__name__ or isinstance(caught.value, NoAnswer | PointcoordError)


def answering(change: Callable[[Any], Any]) -> Callable[..., Any]:
    """SciPy's solver, whose answers are changed."""
    real = scipy_solvers.root
    return lambda *arguments, **options: change(real(*arguments, **options))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda it: SimpleNamespace(**{**it, "success": False, "message": "gave\nup"}), "fails: gave up"),
        (lambda it: SimpleNamespace(**{**it, "fun": it.fun + 1e-3}), r"ends with a residual of 0\.001"),
    ],
)
def test_a_solver_of_scipy_that_fails_is_told(
    change: Any, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scipy_solvers, "root", answering(change))
    scene = own_scene("off-axis-strut")
    with pytest.raises(NoAnswer, match=rf"scipy\.optimize\.root at t = 0\.0\d+ s {words}"):
        answer("scipy-root-jac", scene, scene.instants)


def test_an_answer_of_scipy_on_another_side_than_is_drawn_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    scene = own_scene("off-axis-strut")
    real, seen = np.linalg.slogdet, []

    def turned(matrices: Any) -> Any:
        signs, logs = real(matrices)
        seen.append(len(signs))
        return np.where(np.arange(len(signs)) == 7, -signs, signs), logs

    monkeypatch.setattr(np.linalg, "slogdet", turned)
    with pytest.raises(NoAnswer, match="converges to another assembly mode"):
        answer("scipy-root-jac", scene, scene.instants)
    assert seen
