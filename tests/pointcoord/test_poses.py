"""Unrelated poses are each the pose that the drawing leads to, and their bounds hold."""

import numpy as np
import pytest

from pointcoord import AssemblyError, InputOutOfRange, Scene, UnknownName, simulate, solve_poses
from pointcoord.simulation import scene_mechanism
from pointcoord.solve import unrelated_poses
from pointcoord.solve.assembly import assemble

CARS = {"bounce": 1.6, "off-axis-strut": 1.6, "double-wishbone": 1.55}


@pytest.mark.parametrize("name", CARS)
def test_a_pose_is_the_assembled_one_within_both_bounds(name: str) -> None:
    scene = Scene.load(name)
    mechanism = scene_mechanism(scene)
    rng = np.random.default_rng(11)
    inputs = {"arm_angle": CARS[name] + rng.uniform(-0.15, 0.15, 400), "rack": rng.uniform(-25.0, 25.0, 400)}
    found = solve_poses(scene, inputs, tolerance=1e-9)
    assert not found.failures
    assert (found.bound <= 1e-9).all()
    some = slice(0, 400, 25)
    pose = assemble(mechanism, {name: value[some] for name, value in inputs.items()})
    for point in mechanism.topology.moving:
        own = mechanism.origin + mechanism.unit * pose.y[:, list(mechanism.layout.vector(point))]
        off = np.abs(found.position[point][some] - own).max(axis=-1)
        assert (off <= found.bound[some] + pose.bound).all()


@pytest.mark.parametrize("name", CARS)
def test_poses_from_boxes_are_those_from_paths_of_their_own(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, rng = Scene.load(name), np.random.default_rng(12)
    inputs = {"arm_angle": CARS[name] + rng.uniform(-0.05, 0.05, 3000), "rack": rng.uniform(-5.0, 5.0, 3000)}
    from_boxes = solve_poses(scene, inputs, tolerance=1e-9)
    left: list[int] = []

    def no_boxes(_: object, rest: np.ndarray) -> np.ndarray:
        return rest

    by_paths = unrelated_poses._Solver.by_paths

    def counted(solver: unrelated_poses._Solver, rest: np.ndarray) -> np.ndarray:
        left.append(len(rest))
        return by_paths(solver, rest)

    monkeypatch.setattr(unrelated_poses._Solver, "by_paths", counted)
    solve_poses(scene, inputs, tolerance=1e-9)
    # They lie so close together that one step from a box's series does for all of them.
    assert left[0] == 0
    monkeypatch.setattr(unrelated_poses._Solver, "by_boxes", no_boxes)
    from_paths = solve_poses(scene, inputs, tolerance=1e-9)
    assert left[1] == 3000
    allowed = from_boxes.bound + from_paths.bound
    for point in scene_mechanism(scene).topology.moving:
        off = np.abs(from_boxes.position[point] - from_paths.position[point]).max(axis=-1)
        assert (off <= allowed).all()
    assert (from_boxes.bound <= 1e-9).all()


@pytest.mark.parametrize("name", CARS)
def test_carried_and_chassis_points_are_those_of_the_motion(name: str) -> None:
    scene = Scene.load(name)
    motion, mechanism = simulate(scene), scene_mechanism(scene)
    inputs = {
        n: scene.functions[n].series(scene.instants, 0)[..., 0] for n in mechanism.topology.required_inputs
    }
    found = solve_poses(scene, inputs, tolerance=1e-9)
    for point, place in motion.position.items():
        assert (
            np.abs(found.position[point] - place).max() <= 2.0 * scene.tolerance + found.carried_bound.max()
        )


def test_a_pose_that_cannot_be_says_why_and_has_no_number() -> None:
    scene = Scene.load("bounce")
    angles = np.array([[1.6, 0.05], [1.5, 3.1]])
    found = solve_poses(scene, {"arm_angle": angles, "rack": 0.0})
    np.testing.assert_array_equal(found.solved, [[True, False], [True, False]])
    assert set(found.failures) == {1, 3}
    with pytest.raises(AssemblyError) as alone:
        assemble(scene_mechanism(scene), {"arm_angle": np.array(0.05), "rack": np.array(0.0)})
    assert str(found.failures[1]) == str(alone.value)
    assert np.isnan(found.position["wheel_centre"][0, 1]).all()
    assert np.isfinite(found.position["wheel_centre"][:, 0]).all()


def test_heave_moves_every_point_alike() -> None:
    scene = Scene.load("bounce")
    still = solve_poses(scene, {"arm_angle": 1.6, "rack": 3.0})
    lifted = solve_poses(scene, {"arm_angle": 1.6, "rack": 3.0, "heave": 40.0})
    for name, place in still.position.items():
        np.testing.assert_allclose(lifted.position[name] - place, (0.0, 0.0, 40.0), rtol=0, atol=1e-12)


def test_inputs_without_meaning_are_refused() -> None:
    scene = Scene.load("bounce")
    with pytest.raises(UnknownName):
        solve_poses(scene, {"arm_angle": 1.6})
    with pytest.raises(UnknownName):
        solve_poses(scene, {"arm_angle": 1.6, "rack": 0.0, "rak": 0.0})
    with pytest.raises(InputOutOfRange):
        solve_poses(scene, {"arm_angle": 1.6, "rack": np.nan})
    with pytest.raises(InputOutOfRange):
        solve_poses(scene, {"arm_angle": 88.0, "rack": 0.0})
    for tolerance in (np.nan, np.inf, 0.0, -1e-9):
        with pytest.raises(InputOutOfRange, match="tolerance"):
            solve_poses(scene, {"arm_angle": 1.6, "rack": 0.0}, tolerance)


@pytest.mark.parametrize("name", CARS)
def test_the_bound_of_a_step_holds_where_it_starts_far_off_and_is_not_far_from_the_error(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From a parabola a step leaves some 1e-6 mm: enough to be seen beside rounding."""
    scene, rng = Scene.load(name), np.random.default_rng(13)
    inputs = {"arm_angle": CARS[name] + rng.uniform(-0.1, 0.1, 3000), "rack": rng.uniform(-10.0, 10.0, 3000)}
    finest = solve_poses(scene, inputs, tolerance=1e-9)
    monkeypatch.setattr(unrelated_poses, "ORDERS", {2: 2})
    coarse = solve_poses(scene, inputs, tolerance=1e-2)
    assert coarse.bound.max() > 1e-6
    moving = scene_mechanism(scene).topology.moving
    off = np.max([np.abs(coarse.position[p] - finest.position[p]).max(axis=-1) for p in moving], axis=0)
    assert (off <= coarse.bound + finest.bound).all()
    far = coarse.bound > 1e-7
    assert (off[far] / coarse.bound[far]).max() > 0.03


def test_a_box_does_not_hold_what_lies_beside_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its series and its proof end where it ends: such a pose goes along a path of its own."""
    scene, rng = Scene.load("bounce"), np.random.default_rng(14)
    inputs = {"arm_angle": 1.6 + rng.uniform(-0.05, 0.05, 3000), "rack": rng.uniform(-5.0, 5.0, 3000)}
    right = solve_poses(scene, inputs, tolerance=1e-9)
    in_order = unrelated_poses._Solver._in_order

    def moved(solver: unrelated_poses._Solver, low: np.ndarray, half: np.ndarray) -> object:
        order, code = in_order(solver, low, half)
        return np.concatenate([order[1000:], order[:1000]]), code

    monkeypatch.setattr(unrelated_poses._Solver, "_in_order", moved)
    elsewhere = solve_poses(scene, inputs, tolerance=1e-9)
    assert not elsewhere.failures
    for point in scene_mechanism(scene).topology.moving:
        off = np.abs(elsewhere.position[point] - right.position[point]).max(axis=-1)
        assert (off <= elsewhere.bound + right.bound).all()


@pytest.mark.parametrize("count", [1, 2, 3])
def test_series_along_the_directions_tell_every_monomial(count: int) -> None:
    for degree in range(1, unrelated_poses._order(count) + 1):
        monomials = unrelated_poses._monomials(count, degree)
        table = np.array(
            [[np.prod(v[list(m)]) for m in monomials] for v in unrelated_poses._directions(count)]
        )
        # What solving for them takes from the digits is far less than the series need.
        assert np.linalg.cond(table) < 1e5


def test_poses_are_put_into_the_smallest_boxes_that_they_lie_in() -> None:
    parts, low, half = 2**unrelated_poses.DIVISIONS, np.array([-1.0, 3.0]), np.array([0.5, 20.0])
    solver, rng = object.__new__(unrelated_poses._Solver), np.random.default_rng(15)
    inside = low[:, None] + 2.0 * half[:, None] * rng.uniform(size=(2, 500))
    # The corners belong to the boxes that they are corners of.
    asked = np.concatenate([inside, low[:, None], (low + 2.0 * half)[:, None]], axis=-1)
    object.__setattr__(solver, "asked", asked)
    order, code = solver._in_order(low, half)
    assert (np.diff(code) >= 0).all()
    np.testing.assert_array_equal(np.sort(order), np.arange(502))
    for axis in (0, 1):
        bits = range(unrelated_poses.DIVISIONS)
        place = np.sum([(code >> 2 * bit + axis & 1) << bit for bit in bits], axis=0)
        width = 2.0 * half[axis] / parts
        begins, value = low[axis] + place * width, asked[axis, order]
        assert (begins - 1e-12 <= value).all()
        assert (value <= begins + width + 1e-12).all()
