"""What pointcoord says of its own accuracy, as a comparison takes it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Motion, Scene, SingularConfiguration
from pointcoord.proof import Proof
from validate.compare import compare_solutions
from validate.formulation import FormulationError
from validate.formulations import formulation
from validate.input_ends import Car, Linkage
from validate.paper_car import PAPER

STRUT = Linkage.of(Car(dict(PAPER), "left", (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), "collinear"))


def rack_to_its_end(short: float, tolerance: float = 1e-9) -> Scene:
    """From the middle to a share `short` before the end, where the tie rod locks."""
    end = STRUT.end({"arm_angle": math.pi / 2, "rack": 0.0}, "rack", ahead=True)
    assert end is not None
    content = Scene.load("steer").model_dump(mode="json", exclude_none=True)
    content["inputs"] = {
        "arm_angle": {"constant": math.pi / 2},
        "rack": {"polynomial": [0.0, end[0] * (1.0 - short)]},
    }
    content["time"] = {"start": 0.0, "stop": 1.0, "samples": 2}
    return Scene.from_mapping({**content, "tolerance": tolerance})


def test_poses_are_proven_to_a_part_in_1e12_of_the_way_before_a_lock() -> None:
    solved = formulation("pointcoord").solve(rack_to_its_end(1e-12))
    # A fold of the length of the car: condition number 1 / sqrt(1e-12) and somewhat more.
    assert solved.accuracy.condition[1] > 1e6
    assert np.isfinite(solved.accuracy.pose_error).all()


@pytest.mark.parametrize("part", ["bound", "carried_bound"])
def test_a_pose_that_nothing_is_proven_of_is_no_answer(monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    prove = Motion.proof

    def unproven(motion: Motion) -> Proof:
        proof = prove(motion)
        return replace(proof, **{part: np.where(motion.times == 1.0, np.inf, getattr(proof, part))})

    monkeypatch.setattr(Motion, "proof", unproven)
    with pytest.raises(FormulationError, match="no error bound of the pose can be proven") as caught:
        formulation("pointcoord").solve(rack_to_its_end(1e-12))
    reason = caught.value.reason
    assert isinstance(reason, SingularConfiguration)
    assert reason.where == "at t = 1 s"
    assert reason.condition > 1e6  # of that instant; at the other it is below 100


@pytest.mark.parametrize("tolerance", [1e-300, 1e-9, 1.0, 1e300])
def test_a_scenes_tolerance_widens_that_of_a_rate_within_the_limits_of_a_series(tolerance: float) -> None:
    # A series is cut at 4 eps to 1e-6 of a derivative's size, and the adapter allows ten times that.
    solved = formulation("pointcoord").solve(rack_to_its_end(0.5, tolerance))
    within = min(max(tolerance / 512.0, 40 * float(np.finfo(float).eps)), 1e-5)
    assert solved.accuracy.truncation == pytest.approx(within, rel=1e-12)


def test_what_lies_far_away_loosens_positions_and_no_rate() -> None:
    scene = Scene.load("bounce")
    near, model = (formulation(name).solve(scene) for name in ("pointcoord", "absolute"))
    far = replace(near, accuracy=replace(near.accuracy, stored=np.full(len(near.times), 1e-3)))
    plain, loose = (compare_solutions(scene, one, model, "far") for one in (near, far))
    for before, after in zip(plain.rows, loose.rows, strict=True):
        if before.quantity in ("position", "wheel"):
            assert after.tolerance > before.tolerance
        else:
            assert after.tolerance == before.tolerance


def test_an_infinite_tolerance_is_a_disagreement() -> None:
    scene = Scene.load("bounce")
    one, two = (formulation(name).solve(scene) for name in ("pointcoord", "absolute"))
    unknown = replace(one, accuracy=replace(one.accuracy, pose_error=np.full(len(one.times), np.inf)))
    assert compare_solutions(scene, one, two, "bounce").agreed
    assert not compare_solutions(scene, unknown, two, "bounce").agreed
