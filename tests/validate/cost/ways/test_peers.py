"""Other people's programs in the race: their error follows their tolerance, and a wrong one shows."""

import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pointcoord import Scene, SceneError, built_in_scenes
from validate.adjudication.reference_solution import reference_solution, told_by
from validate.cost.scenes import own_scene
from validate.cost.way import Setting
from validate.cost.ways.peers import WAYS, PeerWay, ReadyPeer
from validate.extras import MissingPackage
from validate.formulations.protocol import Numbers, Solution
from validate.peers import program
from validate.peers.linkage import PeerError

FINE = Setting("", 1e-12)
by_way = pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)


def short(name: str, samples: int = 21) -> Scene:
    scene = Scene.load(name)
    return scene.model_copy(update={"time": scene.time.model_copy(update={"samples": samples})})


def found(ready: ReadyPeer, scene: Scene) -> Numbers:
    return ready.output(ready.rates(ready.solve(scene.instants)))


def errors(numbers: Numbers, reference: Solution, scene: Scene) -> dict[str, float]:
    return {
        quantity: max(
            float(np.abs(numbers[quantity][n] - reference.numbers[quantity][n]).max()) for n in names
        )
        for quantity, names in told_by(reference, scene).items()
    }


@by_way
@pytest.mark.parametrize("name", built_in_scenes())
def test_a_program_gives_all_that_a_scene_asks_for_as_the_reference_does(name: str, way: PeerWay) -> None:
    scene = short(name)
    reference = reference_solution(scene)
    numbers = found(way.prepare(scene, FINE), scene)
    for quantity, error in errors(numbers, reference, scene).items():
        size = max(float(np.abs(array).max()) for array in reference.numbers[quantity].values())
        # 16 roundings, raised by some ten in a place and by another ten in what is twice differentiated.
        assert error < 1e-12 * size, quantity


@by_way
def test_the_error_and_the_work_follow_the_tolerance(way: PeerWay) -> None:
    scene = short("off-axis-strut", 51)
    reference = reference_solution(scene)
    error, steps = [], []
    for value in (1e-2, 1e-12):
        ready = way.prepare(scene, Setting("", value))
        solved = ready.solve(scene.instants)
        error.append(errors(ready.output(ready.rates(solved)), reference, scene)["position"])
        steps.append(ready.counts(solved)["newton_steps"])
    # At a hundredth the error is its square times how far the equations curve, in mm; the other is rounding.
    assert 1e-4 < error[0] < 10.0
    assert error[1] < 1e-11
    assert steps[0] < 0.8 * steps[1]


@by_way
def test_a_program_keeps_to_the_drawings_assembly_beside_a_toggle(
    way: PeerWay, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The arm comes to a ten-thousandth of its toggle, and Newton's first try jumps to the other assembly."""
    scene = own_scene("near-toggle")
    reference = reference_solution(scene)
    ready = way.prepare(scene, FINE)
    # Rounding is raised by some ten thousand there.
    assert errors(found(ready, scene), reference, scene)["position"] < 1e-8
    monkeypatch.setattr(program, "SHORTEST_STEP", 0.2)  # no second try
    with pytest.raises(PeerError, match=r"at t = .* s: Newton's method came to another assembly"):
        ready.solve(scene.instants)


@by_way
def test_a_program_starts_from_where_the_scene_does_at_any_instants(way: PeerWay) -> None:
    scene = short("bounce")
    ready = way.prepare(scene, FINE)
    late = np.array([1.9, 2.05, 2.6])
    some = ready.output(ready.solve(late))["position"]["wheel_centre"]
    whole = way.prepare(scene, FINE)
    every = whole.output(whole.solve(np.linspace(0.0, 2.6, 53)))["position"]["wheel_centre"]
    assert np.abs(some - every[[38, 41, 52]]).max() < 1e-11


@by_way
def test_a_wrong_number_of_a_program_shows_as_an_error(way: PeerWay) -> None:
    scene = short("double-wishbone")
    ready = way.prepare(scene, FINE)

    class Faulty:
        def __getattr__(self, name: str) -> Any:
            return getattr(ready.engine, name)

        def rates(self, *arguments: Any) -> Any:
            rates = ready.engine.rates(*arguments)
            return replace(rates, spin=rates.spin * (1.0 + 1e-6))

    seen = errors(found(replace(ready, engine=Faulty()), scene), reference_solution(scene), scene)
    assert seen["angular_velocity"] > 1e-8
    assert seen["angular_acceleration"] < 1e-10


@by_way
def test_what_cannot_be_followed_or_is_another_car_is_refused(way: PeerWay) -> None:
    content = Scene.load("steer").model_dump(exclude_none=True)
    content["inputs"]["rack"] = {"polynomial": [0.0, 500.0]}
    scene = Scene.from_mapping(content)
    ready = way.prepare(scene, FINE)
    with pytest.raises(PeerError, match="no pose is reached"):
        ready.solve(scene.instants)
    content = Scene.load("off-axis-strut").model_dump(exclude_none=True)
    content["mechanism"]["points"]["rack_centre"] = [150.0, -330.0, 335.0]
    with pytest.raises(SceneError, match="that is another car"):
        way.prepare(Scene.from_mapping(content), FINE)


@by_way
def test_a_program_that_is_not_there_is_named(way: PeerWay, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, way.package, None)
    monkeypatch.delitem(sys.modules, f"validate.peers.in_{way.name}", raising=False)
    with pytest.raises(MissingPackage, match=rf"'{way.package}', which is not installed.*\[peers\]"):
        way.prepare(Scene.load("bounce"), FINE)


def test_ways_and_their_settings_are_told_apart() -> None:
    for way in WAYS:
        values = [setting.value or 0.0 for setting in way.settings]
        assert values == sorted(values, reverse=True)
        assert len({setting.words for setting in way.settings}) == len(values)
        assert not way.dense
