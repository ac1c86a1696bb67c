"""Designs solved together are the designs solved one by one."""

from dataclasses import replace

import numpy as np
import pytest

from pointcoord import AssemblyError, Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES
from pointcoord.simulation import chain_settings, pose_tolerance, prepare_task
from pointcoord.solve import chains_together, designs
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import Follow, SolvedDesigns, solve_designs, solve_plainly
from pointcoord.solve.status import TooRough
from pointcoord.solve.taylor import Chain, Segment, build_chain
from pointcoord.sweeping.solving import way_of_inputs

WISHBONE = Scene.load("double-wishbone")
# Of these heights of the lower ball joint, mm, the last two cannot be steered as far as the scene does.
HEIGHTS = (-20.0, 0.0, 130.0, 20.0, 150.0)


def moved(scene: Scene, height: float) -> Scene:
    x, y, z = scene.mechanism.points["lower_ball_joint"]
    points = {**scene.mechanism.points, "lower_ball_joint": (x, y, z + height)}
    return scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})


def together(scene: Scene, heights: tuple[float, ...]) -> tuple[Mechanism, SolvedDesigns]:
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    points["lower_ball_joint"] = points["lower_ball_joint"] + np.outer(heights, (0.0, 0.0, 1.0))
    part = scene.mechanism
    mechanism = build_mechanism(part.topology, points, {"up": part.up, "right": part.right})
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    start, stop = scene.time.start, scene.time.stop
    settings, allowed = chain_settings(scene, mechanism, 0), pose_tolerance(scene, SERIES, mechanism)
    return mechanism, solve_designs(mechanism, functions, start, stop, settings, allowed)


def alone(scene: Scene) -> tuple[Mechanism, Chain]:
    task = prepare_task(scene, SERIES)
    mechanism = task.readout.mechanism
    settings = chain_settings(scene, mechanism, 0)
    start, stop = scene.time.start, scene.time.stop
    return mechanism, build_chain(mechanism, task.functions, task.start, start, stop, settings)


def unknowns(mechanism: Mechanism, chain: Chain, instants: np.ndarray) -> np.ndarray:
    pieces = [segment.coefficients[..., : mechanism.map.unknowns] for segment in chain.segments]
    return evaluate(chain, pieces, instants, 0)[0]


def test_designs_that_stop_drop_out_and_the_others_are_solved_as_alone() -> None:
    mechanism, solved = together(WISHBONE, HEIGHTS)
    assert solved.chain is not None
    assert set(solved.failures) | set(solved.alive.tolist()) == set(range(len(HEIGHTS)))
    assert 4 in solved.failures
    assert {0, 1, 3} <= set(solved.alive.tolist())
    found = unknowns(mechanism, solved.chain, WISHBONE.instants)
    for place, number in enumerate(solved.alive.tolist()):
        scene = moved(WISHBONE, HEIGHTS[number])
        own, chain = alone(scene)
        # Each of the two is cut to a tenth of the scene's tolerance at most, the last two terms of a series
        # standing for what it leaves out.
        difference = float(mechanism.unit[number]) * np.abs(
            found[place] - unknowns(own, chain, scene.instants)
        )
        assert difference.max() <= 2.0 * 0.1 * scene.tolerance


def test_a_design_that_stops_says_what_it_says_alone() -> None:
    _, solved = together(WISHBONE, HEIGHTS)
    error = solved.failures[4].error()
    with pytest.raises(AssemblyError) as own:
        prepare_task(moved(WISHBONE, HEIGHTS[4]), SERIES)
    assert isinstance(error, AssemblyError)
    assert (error.problem, error.limits, error.reduce) == (
        own.value.problem,
        own.value.limits,
        own.value.reduce,
    )
    for name, value in own.value.reached.items():
        # Near a fold the steps end 1e-13 of the path before it; the fold is found from either side of that.
        assert error.reached[name] == pytest.approx(value, rel=1e-9, abs=1e-9)


def test_a_closed_drawing_is_kept_of_a_design_that_cannot_move() -> None:
    mechanism, solved = together(WISHBONE, HEIGHTS)
    assert np.isfinite(solved.closed).all()
    residual = np.abs(mechanism.map.residual(solved.closed)).max()
    assert residual < 1e-12


def test_no_designs_are_no_error_and_none_that_moves_leaves_no_chain() -> None:
    _, solved = together(WISHBONE, (150.0, 150.0))
    assert solved.chain is None
    assert solved.start is None
    assert not len(solved.alive)
    assert set(solved.failures) == {0, 1}


MANY = tuple(np.linspace(-20.0, 150.0, 24).tolist())


def test_designs_as_columns_are_those_of_the_plain_form() -> None:
    mechanism, solved = together(WISHBONE, MANY)
    assert solved.chain is not None
    functions = {name: WISHBONE.functions[name] for name in mechanism.topology.required_inputs}
    settings, allowed = chain_settings(WISHBONE, mechanism, 0), pose_tolerance(WISHBONE, SERIES, mechanism)
    start, stop = WISHBONE.time.start, WISHBONE.time.stop
    plain = solve_plainly(mechanism, Follow(functions, start, stop, settings, allowed))
    assert plain.chain is not None
    np.testing.assert_array_equal(solved.alive, plain.alive)
    assert 0 < len(solved.failures) < len(MANY)
    assert set(solved.failures) == set(plain.failures)
    for number, status in solved.failures.items():
        mine, theirs = status.error(), plain.failures[number].error()
        assert isinstance(mine, AssemblyError)
        assert isinstance(theirs, AssemblyError)
        assert (mine.problem, mine.limits, mine.reduce) == (theirs.problem, theirs.limits, theirs.reduce)
    np.testing.assert_allclose(solved.closed, plain.closed, rtol=0, atol=1e-13)
    found = unknowns(mechanism.taken(solved.alive), solved.chain, WISHBONE.instants)
    wanted = unknowns(mechanism.taken(plain.alive), plain.chain, WISHBONE.instants)
    difference = mechanism.unit[solved.alive, None, None] * np.abs(found - wanted)
    assert difference.max() <= 2.0 * 0.1 * WISHBONE.tolerance


def test_designs_as_columns_take_no_plain_form_where_all_goes_well(monkeypatch: pytest.MonkeyPatch) -> None:
    def plainly(*_: object) -> SolvedDesigns:
        raise AssertionError("solved plainly")

    monkeypatch.setattr(designs, "solve_plainly", plainly)
    monkeypatch.setattr(Follow, "begun", plainly)
    for name in ("bounce", "steer", "off-axis-strut", "double-wishbone"):
        scene = Scene.load(name)
        points = {
            point: np.array(place) + np.random.default_rng(4).uniform(-1.0, 1.0, (12, 3))
            for point, place in scene.mechanism.points.items()
        }
        part = scene.mechanism
        mechanism = build_mechanism(part.topology, points, {"up": part.up, "right": part.right})
        functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
        settings, allowed = chain_settings(scene, mechanism, 2), pose_tolerance(scene, SERIES, mechanism)
        start, stop = scene.time.start, scene.time.stop
        solved = solve_designs(mechanism, functions, start, stop, settings, allowed)
        assert len(solved.alive) == 12


def test_a_design_that_asks_for_shorter_segments_is_solved_or_dropped_for_its_own_reason() -> None:
    # The last of these nearly locks on the way, and asks for more segments than all others.
    edge = max(set(np.linspace(100.0, 150.0, 26).tolist()) - failing())
    mechanism, solved = together(WISHBONE, (*np.linspace(-20.0, 20.0, 9).tolist(), edge))
    assert solved.chain is not None
    np.testing.assert_array_equal(solved.alive, np.arange(10))
    own, chain = alone(moved(WISHBONE, edge))
    found = unknowns(mechanism, solved.chain, WISHBONE.instants)[9]
    difference = float(mechanism.unit[9]) * np.abs(found - unknowns(own, chain, WISHBONE.instants))
    assert difference.max() <= 2.0 * 0.1 * WISHBONE.tolerance


def test_designs_that_all_lock_at_one_instant_are_told_of() -> None:
    # They differ in what is carried only, so that none of them stands out.
    scene = Scene.load("bounce")
    time = scene.time.model_copy(update={"start": 0.0, "stop": 1.5})
    scene = scene.model_copy(
        update={"inputs": {**scene.inputs, "arm_angle": {"polynomial": [1.5, 1.0]}}, "time": time}
    )
    points = {name: np.array(place) + np.zeros((9, 3)) for name, place in scene.mechanism.points.items()}
    points["wheel_centre"] = points["wheel_centre"] + np.outer(np.arange(9.0), (0.0, 0.0, 1.0))
    part = scene.mechanism
    mechanism = build_mechanism(part.topology, points, {"up": part.up, "right": part.right})
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    settings, allowed = chain_settings(scene, mechanism, 0), pose_tolerance(scene, SERIES, mechanism)
    solved = solve_designs(mechanism, functions, 0.0, 1.5, settings, allowed)
    assert set(solved.failures) == set(range(9))
    for status in solved.failures.values():
        error = status.error()
        assert isinstance(error, AssemblyError)
        assert error.reached["arm_angle"] == pytest.approx(np.deg2rad(152.013), abs=1e-5)


def test_designs_that_only_go_on_in_parts_are_one_chain_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, sizes = Follow.together, []

    def in_parts(follow: Follow, mechanism: Mechanism) -> object:
        sizes.append(len(mechanism.drawn))
        ended = whole(follow, mechanism)
        return replace(ended, status=TooRough("rack", 0.0, False)) if len(sizes) == 1 else ended

    monkeypatch.setattr(Follow, "together", in_parts)
    mechanism, solved = together(WISHBONE, (-20.0, 0.0, 20.0))
    assert sizes == [3, 1, 2, 3]
    np.testing.assert_array_equal(solved.alive, np.arange(3))
    assert solved.chain is not None
    assert unknowns(mechanism, solved.chain, WISHBONE.instants[:2]).shape == (3, 2, mechanism.map.unknowns)


def test_designs_at_one_instant_are_no_functions_of_their_inputs() -> None:
    scene = WISHBONE.model_copy(update={"time": WISHBONE.time.model_copy(update={"stop": 0.0, "samples": 1})})
    mechanism, _ = together(WISHBONE, MANY[:9])
    functions = {name: scene.functions[name] for name in mechanism.topology.required_inputs}
    settings, allowed = chain_settings(scene, mechanism, 2), pose_tolerance(scene, SERIES, mechanism)
    way = way_of_inputs(WISHBONE, functions)
    solved = solve_designs(mechanism, functions, 0.0, 0.0, settings, allowed, way)
    assert solved.boxes is None
    np.testing.assert_array_equal(solved.alive, np.arange(9))


def test_an_end_with_a_first_step_beyond_the_tolerance_is_not_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole, plainly = chains_together.confirm, []

    def missed(*given: object) -> object:
        found = whole(*given)
        return replace(found, first_step=found.first_step + 1e-3)

    def counted(mechanism: Mechanism, follow: Follow) -> SolvedDesigns:
        plainly.append(len(mechanism.drawn))
        return solve_plainly(mechanism, follow)

    monkeypatch.setattr(chains_together, "confirm", missed)
    monkeypatch.setattr(designs, "solve_plainly", counted)
    _, solved = together(WISHBONE, MANY[:9])
    assert plainly == [9]
    np.testing.assert_array_equal(solved.alive, np.arange(9))


def test_a_segment_is_cut_by_the_sizes_of_its_own_terms(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, seen = chains_together._Step.segment, []

    def looked(step: chains_together._Step, stop: float) -> Segment:
        terms = step.series.y[: step.series.count, : step.course.columns.map.unknowns]
        np.testing.assert_array_equal(step.sizes, np.abs(terms).max(axis=1), strict=True)
        seen.append(stop)
        return whole(step, stop)

    monkeypatch.setattr(chains_together._Step, "segment", looked)
    _, solved = together(WISHBONE, MANY[:9])
    assert solved.chain is not None
    assert len(seen) == len(solved.chain.segments)


@pytest.mark.parametrize("last", [(1.0, 1e-3), (1e-3, 1.0)])
def test_a_member_stands_out_by_the_larger_of_its_last_two_terms(last: tuple[float, float]) -> None:
    # Every other term is missing where a car is symmetric.
    step = object.__new__(chains_together._Step)
    step.sizes, step.stays = np.full((9, 5), 1e-3), np.zeros(5, dtype=bool)
    step.sizes[-2:, 3] = np.array(last)
    np.testing.assert_array_equal(step._standing_out(), [False, False, False, True, False])


def failing() -> set[float]:
    heights = tuple(np.linspace(100.0, 150.0, 26).tolist())
    return {heights[number] for number in together(WISHBONE, heights)[1].failures}
