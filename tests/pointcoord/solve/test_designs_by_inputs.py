"""Designs as functions of their inputs are the designs followed in time."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from swinging_designs import SWINGS, both, by_boxes, designs, in_time, laws, spread, swinging

from pointcoord import AssemblyError, Scene
from pointcoord.method import SERIES
from pointcoord.numerics.batch_last import mixed_series
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.simulation import TRUNCATION_SHARE, chain_settings, pose_tolerance
from pointcoord.solve import designs_by_inputs
from pointcoord.solve.designs import solve_designs
from pointcoord.solve.designs_by_inputs import rest_of_series
from pointcoord.solve.ends_together import Confirmed
from pointcoord.solve.paths_together import Columns
from pointcoord.solve.taylor import last_and_fall
from pointcoord.sweeping.solving import way_of_inputs
from pointcoord.time_functions import TimeFunction

# Offsets of the inner end of the tie rod, mm.
OUTBOARD = np.array([-25.0, -20.0, 5.0, 10.0, 12.0, 15.0, 18.0, 20.0, 25.0])


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


def test_a_design_that_locks_where_the_inputs_never_are_does_not_fail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    # The rack goes down as the arm goes up, so that two corners of their ranges are never visited. With
    # the two longest tie rods the car cannot be in one of these.
    scene = Scene.load("double-wishbone")
    arm = {"sine": {"amplitude": 0.25, "angular_frequency": 60.0, "offset": 1.25}}
    rack = {"sine": {"amplitude": -35.0, "angular_frequency": 60.0, "offset": -40.0}}
    scene = scene.model_copy(update={"inputs": {"arm_angle": arm, "rack": rack}})
    mechanism = designs(scene, {"tie_rod_inner.y": OUTBOARD})
    corner = {"arm_angle": {"polynomial": [1.51, -0.51]}, "rack": {"polynomial": [0.0, -75.0]}}
    time = {"start": 0.0, "stop": 1.0, "samples": 2}
    to_corner = scene.model_copy(update={"inputs": corner, "time": time})
    _, there = both(to_corner, mechanism)
    locked = sorted(there.failures)
    assert 0 < len(locked) < len(OUTBOARD)

    # They were met on the way: boxes reach to corners at which these designs are not confirmed.
    whole, good = designs_by_inputs.confirm, []

    def watched(
        columns: Columns, y: np.ndarray, begun: Eliminated, left_out: np.ndarray, tolerance: float
    ) -> Confirmed:
        found = whole(columns, y, begun, left_out, tolerance)
        good.append(found.good)
        return found

    monkeypatch.setattr(designs_by_inputs, "confirm", watched)
    solved, plain = both(scene, mechanism)
    assert not np.all(good, axis=0)[locked].any()
    assert len(solved.mapped)
    assert not np.intersect1d(solved.mapped, locked).size
    np.testing.assert_array_equal(solved.solved, np.arange(len(OUTBOARD)))
    np.testing.assert_array_equal(plain.alive, solved.solved)
    assert not solved.failures


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


@pytest.mark.parametrize("turn", [None, 0.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 6.0])
def test_terms_that_vanish_by_chance_do_not_make_what_is_left_out_small(turn: float | None) -> None:
    # A singular place at radius 1 / r and angle phi has terms |cos(k phi + delta)| r^k: every second, third,
    # ... one is missing where phi is that part of pi, and all may vanish by chance.
    rng = np.random.default_rng(3)
    k = np.arange(400.0)
    for _ in range(300):
        degree, r = int(rng.integers(8, 31)), rng.uniform(0.05, 0.7)
        phi = np.pi * (rng.uniform() if turn is None else turn)
        delta = rng.choice([0.0, 0.5 * np.pi, rng.uniform(0.0, np.pi)])
        cosines = np.abs(np.cos(k * phi + delta))
        sizes = np.where(cosines > 1e-13, cosines, 0.0) * r**k
        last, fall = last_and_fall(sizes[: degree + 1, None])
        claimed = rest_of_series(last, fall, degree, 1.0, 0.0)[:, 0]
        beyond = [float((factor * sizes)[degree + 1 :].sum()) for factor in (1.0, k, k * (k - 1.0))]
        # A series is cut at this share of what is claimed of it.
        assert (beyond <= claimed / TRUNCATION_SHARE).all()


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
