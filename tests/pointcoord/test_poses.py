"""Unrelated poses are each the pose that the drawing leads to, and their bounds hold."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import AssemblyError, InputOutOfRange, Scene, UnknownName, poses, solve_poses
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import assemble
from validate.formulations.reference_solution import reference_instant


def test_poses_beside_a_lock_are_on_patches_or_on_paths_and_the_rest_say_why(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The arm of the strut locks at 32 and at 152 degrees."""
    scene, rng = Scene.load("bounce"), np.random.default_rng(16)
    inputs = {"arm_angle": rng.uniform(0.4, 2.8, 400), "rack": rng.uniform(-5.0, 5.0, 400)}
    found = solve_poses(scene, inputs, tolerance=1e-9)
    monkeypatch.setattr(poses, "FEW", 401)
    wanted = solve_poses(scene, inputs, tolerance=1e-9)
    assert 0 < len(found.failures) < 200
    assert found.failures.keys() == wanted.failures.keys()
    solved = found.solved
    off = np.abs(found.position["wheel_centre"] - wanted.position["wheel_centre"])[solved].max(axis=-1)
    assert (off <= (found.carried_bound + wanted.carried_bound)[solved]).all()


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


@pytest.mark.parametrize("count", [3, 400])
def test_a_bound_has_the_rounding_of_a_far_origin(count: int) -> None:
    """A car that is drawn 2^24 mm away, where its hardpoints are the same to the last digit."""
    scene, far = Scene.load("double-wishbone"), 2.0**24
    points = {name: (x + far, y, z) for name, (x, y, z) in scene.mechanism.points.items()}
    moved = scene.model_copy(update={"mechanism": scene.mechanism.model_copy(update={"points": points})})
    rng = np.random.default_rng(17)
    inputs = {"arm_angle": rng.uniform(1.45, 1.6, count), "rack": rng.uniform(-20.0, 20.0, count)}
    here, there = (solve_poses(one, inputs, tolerance=1e-9) for one in (scene, moved))
    off = np.zeros(count)
    for point in scene_mechanism(scene).topology.moving:
        # The first difference is exact.
        apart = there.position[point] - (far, 0.0, 0.0) - here.position[point]
        off = np.maximum(off, np.abs(apart).max(axis=-1))
    assert (off <= here.bound + there.bound).all()
    assert off.max() > 10.0 * here.bound.max()


def test_bounds_cover_the_rounding_of_what_the_chassis_adds() -> None:
    """A small heave and a tight pose: adding the first to the second is most of what is off."""
    scene, rng = Scene.load("bounce-on-a-heaving-chassis"), np.random.default_rng(4)
    turns, rises = rng.uniform(1.5, 1.7, 8), rng.uniform(-1.0, 1.0, 8)
    found = solve_poses(scene, {"arm_angle": turns, "rack": np.zeros(8), "heave": rises})
    carried = scene.mechanism.topology.carried
    for k, (turn, rise) in enumerate(zip(turns.tolist(), rises.tolist(), strict=True)):
        still = {"arm_angle": (turn, 0.0, 0.0), "rack": (0.0,) * 3, "heave": (rise, 0.0, 0.0)}
        exact = reference_instant(scene, still).position
        for name, place in found.position.items():
            bound = Fraction(float((found.carried_bound if name in carried else found.bound)[k]))
            errors = [abs(Fraction(float(x)) - true) for x, true in zip(place[k], exact[name], strict=True)]
            assert max(errors) <= bound, name
