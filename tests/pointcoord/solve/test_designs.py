"""Designs solved together are the designs solved one by one."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES
from pointcoord.simulation import chain_settings, pose_tolerance, prepare_task
from pointcoord.solve import box, taylor
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import SolvedDesigns, solve_designs
from pointcoord.solve.taylor import Chain, build_chain

WISHBONE = Scene.load("double-wishbone")


def moved(scene: Scene, height: float) -> Scene:
    x, y, z = scene.mechanism.points["lower_ball_joint"]
    points = {**scene.mechanism.points, "lower_ball_joint": (x, y, z + height)}
    return scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})


def drawn(scene: Scene, points: Mapping[str, np.ndarray]) -> Mechanism:
    places = {name: np.array(place) for name, place in scene.mechanism.points.items()} | dict(points)
    part = scene.mechanism
    return build_mechanism(part.topology, places, {"up": part.up, "right": part.right})


def solve(scene: Scene, mechanism: Mechanism, derivative: int = 0) -> SolvedDesigns:
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    settings = chain_settings(scene, mechanism, derivative)
    allowed = pose_tolerance(scene, SERIES, mechanism)
    return solve_designs(mechanism, functions, scene.time.start, scene.time.stop, settings, allowed)


def together(scene: Scene, heights: tuple[float, ...]) -> tuple[Mechanism, SolvedDesigns]:
    place = np.array(scene.mechanism.points["lower_ball_joint"])
    mechanism = drawn(scene, {"lower_ball_joint": place + np.outer(heights, (0.0, 0.0, 1.0))})
    return mechanism, solve(scene, mechanism)


def alone(scene: Scene) -> tuple[Mechanism, Chain]:
    task = prepare_task(scene, SERIES)
    mechanism = task.readout.mechanism
    settings = chain_settings(scene, mechanism, 0)
    start, stop = scene.time.start, scene.time.stop
    return mechanism, build_chain(mechanism, task.functions, task.start, start, stop, settings)


def unknowns(mechanism: Mechanism, chain: Chain, instants: np.ndarray, derivative: int = 0) -> np.ndarray:
    columns = [segment.coefficients[..., : mechanism.map.unknowns] for segment in chain.segments]
    first = chain.segments[0]
    if isinstance(first, box.Box):
        return np.asarray(first.powers(instants, derivative + 1)[derivative].T @ columns[0])
    return evaluate(chain, columns, instants, derivative)[derivative]


def found_of(mechanism: Mechanism, solved: SolvedDesigns, instants: np.ndarray) -> dict[int, np.ndarray]:
    """By design, what its chain gives."""
    return {
        number: place
        for each in solved.followed
        for number, place in zip(
            each.numbers.tolist(), unknowns(mechanism, each.chain, instants), strict=True
        )
    }


def assert_as_alone(mechanism: Mechanism, solved: SolvedDesigns, scenes: Mapping[int, Scene]) -> None:
    found = found_of(mechanism, solved, WISHBONE.instants)
    assert sorted(found) == sorted(scenes) == solved.solved.tolist()
    for number, scene in scenes.items():
        own, chain = alone(scene)
        wanted = unknowns(own, chain, scene.instants)
        # Each of the two is cut to a tenth of the scene's tolerance at most, the last two terms of a series
        # standing for what it leaves out.
        difference = float(mechanism.unit[number]) * np.abs(found[number] - wanted)
        assert difference.max() <= 2.0 * 0.1 * scene.tolerance


@pytest.mark.parametrize("name", ["bounce", "five-link"])
def test_designs_that_are_alike_share_one_chain(name: str) -> None:
    scene = Scene.load(name)
    moves = np.random.default_rng(4).uniform(-1.0, 1.0, (len(scene.mechanism.points), 12, 3))
    places = scene.mechanism.points.items()
    mechanism = drawn(
        scene, {point: np.array(place) + move for (point, place), move in zip(places, moves, strict=True)}
    )
    (followed,) = solve(scene, mechanism, 2).followed
    np.testing.assert_array_equal(followed.numbers, np.arange(12))


def test_a_design_that_asks_for_much_shorter_segments_goes_on_without_the_others() -> None:
    # The last of these nearly locks on the way, and asks for more segments than all others.
    heights = tuple(np.linspace(100.0, 150.0, 26).tolist())
    stopped = {heights[number] for number in together(WISHBONE, heights)[1].failures}
    edge = max(set(heights) - stopped)
    near = (*np.linspace(-20.0, 20.0, 9).tolist(), edge)
    mechanism, solved = together(WISHBONE, near)
    assert [each.numbers.tolist() for each in solved.followed] == [list(range(9)), [9]]
    few, many = (len(each.chain.segments) for each in solved.followed)
    assert few < many
    assert_as_alone(mechanism, solved, {n: moved(WISHBONE, height) for n, height in enumerate(near)})


@pytest.mark.parametrize("inputs", [2, 0])
def test_a_design_whose_end_is_not_confirmed_goes_on_without_the_others(
    inputs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(box, "INPUTS", inputs)
    right = taylor.on_branch

    def all_but_the_third(*arguments: Any) -> NDArray[np.bool_]:
        good = np.array(right(*arguments))
        if good.shape[:1] == (9,):
            good[2] = False
        return good

    monkeypatch.setattr(taylor, "on_branch", all_but_the_third)
    near = tuple(np.linspace(-20.0, 20.0, 9).tolist())
    mechanism, solved = together(WISHBONE, near)
    assert [each.numbers.tolist() for each in solved.followed] == [[0, 1, 3, 4, 5, 6, 7, 8], [2]]
    assert_as_alone(mechanism, solved, {n: moved(WISHBONE, height) for n, height in enumerate(near)})


def test_designs_whose_inputs_come_back_are_one_series_in_these() -> None:
    near = tuple(np.linspace(-20.0, 20.0, 9).tolist())
    (followed,) = together(WISHBONE, near)[1].followed
    assert [type(segment) for segment in followed.chain.segments] == [box.Box]
    # Of a box that the ways hardly fill, a chain of series in time is cheaper.
    once = WISHBONE.model_copy(update={"time": WISHBONE.time.model_copy(update={"stop": 0.2})})
    (followed,) = together(once, near)[1].followed
    assert [type(segment) for segment in followed.chain.segments] == [taylor.Segment]
