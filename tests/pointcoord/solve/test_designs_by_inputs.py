"""Designs as functions of their inputs are the designs followed in time."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest

from pointcoord import AssemblyError, Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import SERIES
from pointcoord.numerics.batch_last import mixed_series
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.simulation import chain_settings, pose_tolerance
from pointcoord.solve import designs_by_inputs
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import Follow, SolvedDesigns, solve_designs, solve_plainly
from pointcoord.solve.ends_together import Confirmed
from pointcoord.solve.paths_together import Columns
from pointcoord.sweeping.solving import way_of_inputs
from pointcoord.time_functions import TimeFunction

# Laws that go over their ranges many times.
SWINGS = {
    "bounce": {"arm_angle": {"sine": {"amplitude": 0.45, "angular_frequency": 12.0, "offset": 1.3}}},
    "steer": {"rack": {"sine": {"amplitude": 20.0, "angular_frequency": 15.0, "offset": 22.0}}},
    "off-axis-strut": {},
    "double-wishbone": {},
}


def swinging(name: str) -> Scene:
    scene = Scene.load(name)
    return scene.model_copy(update={"inputs": {**scene.inputs, **SWINGS[name]}})


def designs(scene: Scene, offsets: dict[str, np.ndarray]) -> Mechanism:
    points = {name: np.array(place) for name, place in scene.mechanism.points.items()}
    for name, each in offsets.items():
        point, axis = name.split(".")
        points[point] = points[point] + np.outer(each, np.eye(3)["xyz".index(axis)])
    part = scene.mechanism
    return build_mechanism(part.topology, points, {"up": part.up, "right": part.right})


def laws(scene: Scene) -> dict[str, TimeFunction]:
    return {name: scene.functions[name] for name in scene.mechanism.topology.required_inputs}


def both(scene: Scene, mechanism: Mechanism, derivative: int = 2) -> tuple[SolvedDesigns, SolvedDesigns]:
    """By inputs, and plainly in time."""
    functions, time = laws(scene), scene.time
    settings = chain_settings(scene, mechanism, derivative)
    allowed, way = pose_tolerance(scene, SERIES, mechanism), way_of_inputs(scene, functions)
    solved = solve_designs(mechanism, functions, time.start, time.stop, settings, allowed, way)
    follow = Follow(functions, time.start, time.stop, settings, allowed)
    return solved, solve_plainly(mechanism, follow)


def by_boxes(scene: Scene, mechanism: Mechanism, solved: SolvedDesigns) -> np.ndarray:
    """Unknowns at the scene's instants, (designs, N, unknowns)."""
    assert solved.boxes is not None
    series = [laws(scene)[name].series(scene.instants, 0)[..., 0] for name in solved.boxes.names]
    return solved.boxes.at(np.stack(series, axis=-1), mechanism.map.unknowns)


def in_time(scene: Scene, mechanism: Mechanism, solved: SolvedDesigns) -> np.ndarray:
    assert solved.chain is not None
    pieces = [segment.coefficients[..., : mechanism.map.unknowns] for segment in solved.chain.segments]
    return np.asarray(evaluate(solved.chain, pieces, scene.instants, 0)[0])


def spread(many: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(6)
    names = ("lower_ball_joint.z", "tie_rod_outer.x", "wheel_centre.y")
    return {name: rng.uniform(-4.0, 4.0, many) for name in names}


@pytest.mark.parametrize("name", SWINGS)
def test_designs_by_their_inputs_are_those_of_the_plain_form(name: str) -> None:
    scene = swinging(name)
    mechanism = designs(scene, spread(12))
    solved, plain = both(scene, mechanism)
    np.testing.assert_array_equal(solved.mapped, np.arange(12))
    difference = np.abs(by_boxes(scene, mechanism, solved) - in_time(scene, mechanism, plain))
    # Each of the two is cut to a tenth of the scene's tolerance at most.
    assert (mechanism.unit[:, None, None] * difference).max() <= 2.0 * 0.1 * scene.tolerance


def test_a_wide_range_is_cut_into_boxes_of_one_assembly() -> None:
    scene = swinging("bounce")
    solved, _ = both(scene, designs(scene, spread(12)))
    assert solved.boxes is not None
    assert len(solved.boxes.boxes) > 1
    n = designs(scene, spread(1)).map.unknowns
    # Just inside of each box, and just outside of it, designs are in the same place.
    ends = np.array([box.centre + sign * box.half for box in solved.boxes.boxes for sign in (-1.0, 1.0)])
    inner = ends[(ends > ends.min()) & (ends < ends.max())][:, None]
    step = 1e-9
    before, after = (solved.boxes.at(inner + side, n) for side in (-step, step))
    assert len(inner)
    # No coordinate turns by more than a few sizes of the car for each radian.
    assert np.abs(after - before).max() <= 10.0 * 2.0 * step


def test_designs_that_stop_are_told_of_as_in_the_plain_form_and_others_are_mapped() -> None:
    scene = Scene.load("double-wishbone")
    # With the last of these heights the car cannot begin, and with the one before it stops on the way.
    heights = np.concatenate([np.linspace(-5.0, 5.0, 22), [125.0, 150.0]])
    mechanism = designs(scene, {"lower_ball_joint.z": heights})
    solved, plain = both(scene, mechanism)
    assert set(solved.failures) == set(plain.failures)
    assert 0 < len(solved.failures) < 24
    assert len(solved.mapped) >= 12
    np.testing.assert_array_equal(solved.solved, plain.alive)
    assert not np.intersect1d(solved.mapped, solved.alive).size
    for number, status in solved.failures.items():
        mine, theirs = status.error(), plain.failures[number].error()
        assert isinstance(mine, AssemblyError)
        assert isinstance(theirs, AssemblyError)
        assert (mine.problem, mine.limits, mine.reduce) == (theirs.problem, theirs.limits, theirs.reduce)
        if theirs.instant is not None:
            assert mine.instant == pytest.approx(theirs.instant, abs=1e-9)
    wanted = in_time(scene, mechanism, plain)[np.isin(plain.alive, solved.mapped)]
    difference = np.abs(by_boxes(scene, mechanism.taken(solved.mapped), solved) - wanted)
    assert (mechanism.unit[solved.mapped, None, None] * difference).max() <= 2.0 * 0.1 * scene.tolerance


def test_a_design_that_locks_where_the_inputs_never_are_does_not_fail() -> None:
    # Arm and rack go together, so that the corners of their ranges are never visited; with the last of these
    # heights the car cannot be in one of them.
    scene = Scene.load("double-wishbone")
    together = {
        "arm_angle": {"polynomial": [1.35, 0.16]},
        "rack": {"polynomial": [-60.0, 60.0]},
    }
    scene = scene.model_copy(update={"inputs": together})
    heights = np.linspace(-5.0, 120.0, 16)
    mechanism = designs(scene, {"lower_ball_joint.z": heights})
    solved, plain = both(scene, mechanism)
    np.testing.assert_array_equal(solved.solved, plain.alive)
    assert set(solved.failures) == set(plain.failures)


def test_a_way_that_passes_once_takes_no_more_than_one_box() -> None:
    scene = Scene.load("bounce")
    mechanism = designs(scene, spread(9))
    solved, plain = both(scene, mechanism)
    assert solved.boxes is None
    np.testing.assert_array_equal(solved.alive, plain.alive)


def test_three_inputs_or_none_that_move_are_followed_in_time() -> None:
    scene = Scene.load("steer")
    mechanism = designs(scene, spread(9))
    functions, time = laws(scene), scene.time
    settings = chain_settings(scene, mechanism, 0)
    allowed, way = pose_tolerance(scene, SERIES, mechanism), way_of_inputs(scene, functions)
    assert way is not None
    many = replace(way, names=("arm_angle", "rack", "another"))
    for where in (None, many):
        solved = solve_designs(mechanism, functions, time.start, time.stop, settings, allowed, where)
        np.testing.assert_array_equal(solved.alive, np.arange(9))
        assert solved.boxes is None
    still = {name: {"constant": float(law.series(0.0, 0)[0])} for name, law in functions.items()}
    assert way_of_inputs(scene.model_copy(update={"inputs": still}), laws_of(scene, still)) is None


def laws_of(scene: Scene, inputs: dict[str, dict[str, float]]) -> dict[str, TimeFunction]:
    return laws(scene.model_copy(update={"inputs": inputs}))


def test_a_lost_term_keeps_boxes_from_being_confirmed(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = mixed_series._add_squares

    def lost(d: np.ndarray, i: int, j: int, out: np.ndarray) -> None:
        whole(d, i, j, out)
        if (i, j) == (2, 1):
            out *= 1.0 + 1e-6

    monkeypatch.setattr(mixed_series, "_add_squares", lost)
    scene = Scene.load("double-wishbone")
    solved, plain = both(scene, designs(scene, spread(9)))
    assert not len(solved.mapped)
    np.testing.assert_array_equal(solved.solved, plain.alive)


def test_another_assembly_at_a_corner_keeps_boxes_from_being_confirmed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole, calls = designs_by_inputs.confirm, count(1)

    def moved(
        columns: Columns, y: np.ndarray, begun: Eliminated, left_out: np.ndarray, tolerance: float
    ) -> Confirmed:
        found = whole(columns, y, begun, left_out, tolerance)
        place = found.y.copy()
        place[0] += 1e-6 * next(calls)
        return replace(found, y=place)

    monkeypatch.setattr(designs_by_inputs, "confirm", moved)
    scene = swinging("bounce")
    solved, plain = both(scene, designs(scene, spread(9)))
    assert not len(solved.mapped)
    np.testing.assert_array_equal(solved.solved, plain.alive)
