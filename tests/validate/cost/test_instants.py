"""The instants of the study are special to no way, and there is one in each part of a scene's time."""

import numpy as np
import pytest

from pointcoord import Scene, simulate
from pointcoord.results.ways import ByChain
from validate.cost.scenes import GOLDEN, MOST, MOST_QUICK, STUDY_SCENES, own_scene, study_instants


@pytest.mark.parametrize("count", [1, 2, 7, 131])
def test_one_instant_lies_in_each_of_as_many_equal_parts_of_the_time(count: int) -> None:
    scene = own_scene("bounce")
    places = study_instants(scene, count) / scene.time.stop * count
    assert np.floor(places).tolist() == list(range(count))


def test_their_places_in_their_parts_are_spread_evenly() -> None:
    scene = own_scene("bounce")
    offsets = np.sort(np.modf(study_instants(scene, 100) / scene.time.stop * 100)[0])
    # Two neighbours of N multiples of the golden ratio are at most phi^2 / N apart.
    assert np.diff(np.concatenate([[0.0], offsets, [1.0]])).max() < GOLDEN**2 / 100


@pytest.mark.parametrize("name", STUDY_SCENES)
def test_they_are_no_end_of_a_segment_of_any_chain_and_no_instant_of_the_scene(name: str) -> None:
    scene = own_scene(name)
    instants, duration = study_instants(scene), scene.time.stop - scene.time.start
    special = [scene.instants, np.linspace(scene.time.start, scene.time.stop, 2 * len(instants) + 1)]
    for tolerance in (1e-3, 1e-9, 1e-13):
        states = simulate(scene.model_copy(update={"tolerance": tolerance})).solved
        assert isinstance(states, ByChain)
        special.append(np.array([segment.start for segment in states.chain.segments]))
    nearest = np.abs(instants[:, None] - np.concatenate(special)).min()
    assert nearest > 1e-9 * duration


def test_there_are_as_many_as_the_scene_has_samples_within_limits_or_as_many_as_asked() -> None:
    scene = own_scene("bounce")
    assert len(study_instants(scene)) == scene.time.samples
    assert len(study_instants(scene, quick=True)) == MOST_QUICK
    assert len(study_instants(scene, 1234)) == 1234
    many = scene.model_copy(update={"time": {"start": 0.0, "stop": 2.6, "samples": 100_000}})
    assert len(study_instants(many)) == MOST


def test_a_scene_of_one_instant_has_that_one() -> None:
    content = Scene.load("bounce").model_dump(exclude_none=True)
    content["time"] = {"start": 0.5, "stop": 0.5, "samples": 1}
    assert study_instants(Scene.from_mapping(content)).tolist() == [0.5]
