"""A fault of a tree of joints in a program is seen, and one that is not there is told.

That they agree within what they claim is in test_stated_accuracy, of random cars, and in tests/mechanisms.
"""

import sys
from dataclasses import replace

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import MissingLibrary, Scene
from pointcoord.numerics.arrays import Array
from validate.comparison.compare import compare
from validate.extras import not_there
from validate.formulations.registry import OUTSIDE, formulation
from validate.formulations.trees import InTree
from validate.peers.in_mujoco import InMujoco
from validate.peers.motion import Poses, Rates


class Faulty(InMujoco):
    """Off by a nanometre in a place, and by a billionth in a rate."""

    def poses(self, inputs: Array, tolerance: float, start: Poses) -> Poses:
        poses = super().poses(inputs, tolerance, start)
        off = poses.places["tie_rod_outer"] + np.array([0.0, 1e-6 / self.tree.unit, 0.0])
        return replace(poses, places={**poses.places, "tie_rod_outer": off})

    def rates(self, poses: Poses, series: Array) -> Rates:
        rates = super().rates(poses, series)
        turns = {body: array * (1.0 + 1e-9) for body, array in rates["angular_acceleration"].items()}
        return {**rates, "angular_acceleration": turns}


def test_a_fault_of_a_program_does_not_widen_what_it_claims() -> None:
    scene = Scene.load("off-axis-strut")
    outcome = compare(scene, "pointcoord", InTree("faulty", Faulty))
    assert {(row.quantity, row.name) for row in outcome.disagreements} == {
        ("position", "tie_rod_outer"),
        ("angular_acceleration", "knuckle"),
    }


@pytest.mark.parametrize("who", OUTSIDE)
def test_a_program_that_is_not_installed_is_told_with_its_package_and_extra(
    who: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, who, None)
    monkeypatch.delitem(sys.modules, f"validate.peers.in_{who}", raising=False)
    with pytest.raises(MissingLibrary) as caught:
        formulation(who)
    assert f"needs the package {who!r}, which is not installed" in str(caught.value)
    assert "pip install 'pointcoord[peers]'" in str(caught.value)
    lacking = not_there(who, ImportError("libGL.so.1: cannot open shared object file"))
    assert lacking.libraries == (who,)
    assert "does not load (libGL.so.1" in str(lacking)
    assert "the system package" in str(lacking)


def test_a_rod_that_is_called_as_an_angle_has_no_force_from_a_tree() -> None:
    """A five-link has a rod `toe`; a tree of joints gives the angle of that name, and no forces."""
    loaded = {"loads": {"": {"force": [0.0, 0.0, 4000.0]}}, "wheel_radius": 300.0}
    scene = scene_with("five-link", loaded, effects=["toe", "loads"])
    given = formulation("relative").solve(scene).numbers
    assert "toe" in given["wheel"]
    assert "rod_force" not in given
    assert "toe" in formulation("pointcoord").solve(scene).numbers["rod_force"]
