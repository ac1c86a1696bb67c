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
from pointcoord.simulation import TRUNCATION_SHARE, chain_settings, pose_tolerance
from pointcoord.solve import designs_by_inputs
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.dense_output import evaluate
from pointcoord.solve.designs import Follow, SolvedDesigns, solve_designs, solve_plainly
from pointcoord.solve.designs_by_inputs import Way, rest_of_series
from pointcoord.solve.ends_together import Confirmed
from pointcoord.solve.paths_together import Columns, columns_of
from pointcoord.solve.taylor import last_and_fall
from pointcoord.sweeping.solving import way_of_inputs
from pointcoord.time_functions import TimeFunction

# Laws that go over their ranges many times.
SWINGS = {
    "bounce": {"arm_angle": {"sine": {"amplitude": 0.45, "angular_frequency": 12.0, "offset": 1.3}}},
    "steer": {"rack": {"sine": {"amplitude": 20.0, "angular_frequency": 15.0, "offset": 22.0}}},
    "off-axis-strut": {},
    "double-wishbone": {},
}


# Offsets of the inner end of the tie rod, mm.
OUTBOARD = np.array([-25.0, -20.0, 5.0, 10.0, 12.0, 15.0, 18.0, 20.0, 25.0])


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


@pytest.mark.parametrize("fall", [1e-6, 0.01, 0.3, 0.9])
@pytest.mark.parametrize("degree", [8, 15, 30])
def test_the_rest_of_a_series_is_no_less_than_its_last_two_terms_nor_than_all_beyond(
    fall: float, degree: int
) -> None:
    k, speed, acceleration = np.arange(2000.0), 3.0, 0.5
    sizes = fall ** np.maximum(k - degree, -2.0)
    place, slope, bend = sizes, k * sizes, k * (k - 1.0) * sizes
    terms = np.stack([place, speed * slope, speed**2 * bend + acceleration * slope])
    last, beyond = terms[:, degree - 1 : degree + 1].sum(axis=-1), terms[:, degree + 1 :].sum(axis=-1)
    found = rest_of_series(np.array(1.0), np.array(fall), degree, speed, acceleration)
    # Of the rate of a rate the larger of each part counts.
    assert (found >= np.maximum(last, beyond) * (1.0 - 1e-12)).all()
    assert (found <= (last + beyond) * (1.0 + 1e-12)).all()


@pytest.mark.parametrize(
    ("speed", "acceleration"),
    # What is largest of the second rate: that of the input's acceleration, or of the square of its speed.
    [(1e-3, 1e-4), (1e-3, 5.0), (30.0, 1e-3), (30.0, 1e6)],
)
def test_last_degrees_are_held_to_the_size_of_each_rate(speed: float, acceleration: float) -> None:
    scene = Scene.load("bounce")
    mechanism = designs(scene, spread(3))
    course, y = course_of(scene, mechanism, speed, acceleration)
    here = course._expanded(y, 8)
    half = np.array([0.3])
    here.carry_on(course.known(np.array([0.8]), half, 8, mechanism), 8)
    n = mechanism.map.unknowns
    first, second = (np.abs(here.alone[0].y[k, :n]).max(axis=0) for k in (1, 2))
    v, a = speed / 0.3, acceleration / 0.3
    size = np.stack([np.ones(3), v * first, np.maximum(a * first, 2.0 * v**2 * second)])
    beyond = rest_of_series(*last_and_fall(here.sizes()), 8, v, a)
    for derivative in range(3):
        needed = (beyond / size)[: derivative + 1].max(axis=0)
        for share, fine in ((1.0 + 1e-9, True), (1.0 - 1e-9, False)):
            for member in range(3):
                settings = replace(course.settings, tolerance=share * needed[member], derivative=derivative)
                assert replace(course, settings=settings)._falls(here, half)[member] == fine


@pytest.mark.parametrize("fall", [0.1, 0.4, 0.6])
def test_the_degree_is_the_least_that_leaves_out_no_more_than_the_tolerance(fall: float) -> None:
    scene = Scene.load("bounce")
    course, _ = course_of(scene, designs(scene, spread(1)), 0.0, 0.0)
    course = replace(course, settings=replace(course.settings, tolerance=1e-9, derivative=0))
    order = course._needed(fall ** np.arange(9.0), (1,))
    left = [float(rest_of_series(np.array(fall**p), np.array(fall), p, 0.0, 0.0)[0]) for p in range(8, 31)]
    least = next((p for p, rest in enumerate(left, 8) if rest <= 1e-9), 31)
    assert order == least


def course_of(
    scene: Scene, mechanism: Mechanism, speed: float, acceleration: float
) -> tuple[designs_by_inputs._Course, np.ndarray]:
    """The boxes of designs of which only the arm moves, and their closed drawings, (size, members)."""
    closed, layout = close_drawing(mechanism).y, mechanism.layout
    driven = [layout.scalar(drive.coordinate) for drive in mechanism.topology.drives]
    columns = columns_of(mechanism.map, ((layout.zero, 0.0), (layout.one, 1.0)), driven, closed[0])
    assert columns is not None
    drives = tuple(drive for drive in mechanism.topology.drives if drive.input == "arm_angle")
    way = Way(
        ("arm_angle",),
        np.array([[0.5]]),
        np.array([[1.1]]),
        np.array([speed]),
        np.array([acceleration]),
        1.0,
    )
    settings = chain_settings(scene, mechanism, 2)
    course = designs_by_inputs._Course(columns, mechanism, drives, way, settings)
    return course, np.ascontiguousarray(closed.T)


@pytest.mark.parametrize("chunk", [8, 256])
def test_designs_of_a_later_chunk_that_need_a_higher_degree_are_followed_in_time(
    monkeypatch: pytest.MonkeyPatch, chunk: int
) -> None:
    monkeypatch.setattr(designs_by_inputs, "CHUNK", chunk)
    # The last design comes near the end of its range: its terms fall more slowly than those of all others.
    scene = Scene.load("double-wishbone")
    mechanism = designs(scene, {"lower_ball_joint.z": np.array([*np.linspace(-2.0, 2.0, 15), 100.0])})
    solved, plain = both(scene, mechanism)
    np.testing.assert_array_equal(solved.solved, plain.alive)
    assert len(solved.mapped) == 15


@pytest.mark.parametrize("amplitude", [1e-3, 1e-12, 1e-310])
def test_an_input_that_hardly_moves_is_one_of_those_that_move(amplitude: float) -> None:
    scene = swinging("steer")
    rack = {"sine": {"amplitude": amplitude, "angular_frequency": 15.0}}
    scene = scene.model_copy(update={"inputs": {**scene.inputs, "rack": rack}})
    mechanism = designs(scene, spread(9))
    solved, plain = both(scene, mechanism, 0)
    np.testing.assert_array_equal(solved.mapped, np.arange(9))
    difference = np.abs(by_boxes(scene, mechanism, solved) - in_time(scene, mechanism, plain))
    assert (mechanism.unit[:, None, None] * difference).max() <= 2.0 * 0.1 * scene.tolerance


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
