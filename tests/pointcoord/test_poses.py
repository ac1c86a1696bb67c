"""Unrelated poses are each the pose that the drawing leads to, and their bounds hold."""

import numpy as np
import pytest

from pointcoord import AssemblyError, InputOutOfRange, Scene, UnknownName, poses, solve_poses
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import assemble


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
