"""Trees of joints in programs agree within what they claim, and a fault of theirs is seen."""

import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, assume, given, note, settings
from numpy.typing import NDArray

from pointcoord import MissingLibrary, Scene, SceneError
from validate.comparison.compare import compare
from validate.extras import not_there
from validate.formulations.protocol import FormulationError
from validate.formulations.refusals import DRAWING, INPUT, MOTION, START, why_refused
from validate.formulations.registry import OUTSIDE, formulation
from validate.formulations.trees import InTree
from validate.peers.in_mujoco import InMujoco
from validate.peers.motion import Poses, Rates
from validate.strategies import scenes

Array = NDArray[np.float64]

# Each scene is solved nine times, and a search is short.
# Without shrinking, which takes minutes where a motion is long.
PHASES = (Phase.explicit, Phase.generate)
searched = settings(
    max_examples=min(settings.default.max_examples if settings.default else 100, 5), phases=PHASES
)


TREES = ("relative", *OUTSIDE)


@pytest.mark.parametrize("who", TREES)
@searched
@given(scene=scenes(samples=3))
def test_a_program_agrees_on_random_cars_and_motions(scene: Scene, who: str) -> None:
    note(repr(scene))
    try:
        outcome = compare(scene, "pointcoord", who)
    except FormulationError as error:
        # What pointcoord refuses tells nothing here; the program must refuse for a reason of the car.
        assume(error.formulation == who and not isinstance(error.reason, SceneError))
        refused = why_refused(error)
    else:
        refused = ""
        assert not outcome.disagreements
    assert refused in ("", DRAWING, START, MOTION, INPUT)


class Faulty(InMujoco):
    """Off by a nanometre in a place, and by a billionth in a rate."""

    def poses(self, inputs: Array, tolerance: float, start: Poses) -> Poses:
        poses = super().poses(inputs, tolerance, start)
        off = poses.places["tie_rod_outer"] + np.array([0.0, 1e-6 / self.linkage.tree.unit, 0.0])
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
    lacking = not_there(who, ImportError("libGL.so.1: cannot open shared object file"), "peers")
    assert lacking.libraries == (who,)
    assert "does not load (libGL.so.1" in str(lacking)
    assert "the system's package" in str(lacking)


def test_a_rod_that_is_called_as_an_angle_has_no_force_from_a_tree() -> None:
    """A five-link has a rod `toe`; a tree of joints gives the angle of that name, and no forces."""
    content = Scene.load("five-link").model_dump(exclude_none=True)
    content["mechanism"] |= {"loads": {"": {"force": [0.0, 0.0, 4000.0]}}, "wheel_radius": 300.0}
    content["effects"] = ["toe", "loads"]
    scene = Scene.from_mapping(content)
    given = formulation("relative").solve(scene).numbers
    assert "toe" in given["wheel"]
    assert "rod_force" not in given
    assert "toe" in formulation("pointcoord").solve(scene).numbers["rod_force"]
