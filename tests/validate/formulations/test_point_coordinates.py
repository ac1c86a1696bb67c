"""What pointcoord says of its own accuracy, as a comparison takes it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from changed_scenes import scene_with

from pointcoord import Motion, NotFollowed, Scene, SingularConfiguration, simulate
from pointcoord.method import Method
from pointcoord.results.proof import Proof
from validate.cars.car import Car
from validate.cars.input_ends import end
from validate.comparison.compare import compare_solutions
from validate.formulations.protocol import FormulationError
from validate.formulations.registry import formulation

STRUT = Car(Scene.load("bounce").mechanism.points, "left", closure="collinear")


def rack_to_its_end(short: float, tolerance: float = 1e-9) -> Scene:
    """From the middle to a share `short` before the end, where the tie rod locks."""
    last = end(STRUT, {"arm_angle": math.pi / 2, "rack": 0.0}, "rack", ahead=True)
    assert last is not None
    laws = {"arm_angle": {"constant": math.pi / 2}, "rack": {"sweep": [0.0, last.value * (1.0 - short)]}}
    time = {"start": 0.0, "stop": 1.0, "samples": 2}
    return scene_with("steer", inputs=laws, time=time, tolerance=tolerance)


@pytest.mark.parametrize("part", ["bound", "carried_bound"])
def test_a_pose_that_nothing_is_proven_of_is_no_answer(monkeypatch: pytest.MonkeyPatch, part: str) -> None:
    prove = Motion.proof

    def unproven(motion: Motion, rates: bool = False) -> Proof:
        proof = prove(motion, rates)
        return replace(proof, **{part: np.where(motion.times == 1.0, np.inf, getattr(proof, part))})

    monkeypatch.setattr(Motion, "proof", unproven)
    with pytest.raises(FormulationError, match="no error bound of the pose can be proven") as caught:
        formulation("pointcoord").solve(rack_to_its_end(1e-12))
    reason = caught.value.reason
    assert isinstance(reason, SingularConfiguration)
    assert reason.where == "at t = 1 s"
    assert reason.condition > 1e6  # of that instant; at the other it is below 100


@pytest.mark.parametrize("tolerance", [1e-300, 1.0])
def test_a_series_claims_what_it_leaves_out_and_a_coarse_one_is_no_test(tolerance: float) -> None:
    scene = scene_with("steer", tolerance=tolerance)
    series, newton = (formulation(name).solve(scene) for name in ("pointcoord-as-asked", "pointcoord-newton"))
    outcome = compare_solutions(scene, series, newton, "steer")
    assert not outcome.disagreements
    claimed = max(float(claim.max()) for claim in series.accuracy.claims["acceleration"].values())
    largest = max(float(np.abs(array).max()) for array in series.numbers["acceleration"].values())
    # A series is cut at 4 eps to 1e-5 of a derivative's size.
    if tolerance < 1.0:
        assert outcome.agreed
        assert claimed < 1e-12 * largest
    else:
        assert 1e-12 * largest < claimed < 1e-4 * largest
        assert {row.verdict for row in outcome.undecided} == {"not tested"}
        assert {row.rests_on for row in outcome.undecided} == {"pointcoord-as-asked"}


@pytest.mark.parametrize(("method", "tolerance"), [("pointcoord", 1.0), ("pointcoord-chord", 1e300)])
def test_a_comparison_solves_as_finely_as_rounding_allows_however_coarse_the_scene(
    method: str, tolerance: float
) -> None:
    fine, coarse = (formulation(method).solve(rack_to_its_end(0.5, t)) for t in (1e-13, tolerance))
    for quantity, claims in ((q, of) for q, of in coarse.accuracy.claims.items() if of):
        for name, claim in claims.items():
            # Both are proven; they differ where Newton's last step and the instants of the joints do.
            gap = np.abs(coarse.numbers[quantity][name] - fine.numbers[quantity][name])
            assert (gap <= claim + fine.accuracy.claims[quantity][name]).all()
        widest, other = (
            max(float(claim.max()) for claim in solution.accuracy.claims[quantity].values())
            for solution in (coarse, fine)
        )
        assert widest <= 10.0 * other + 1e-15


def test_a_law_too_rough_to_follow_finely_is_followed_as_the_scene_asks(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = rack_to_its_end(0.5, 1e-3)
    asked: list[float] = []

    def solved(scene: Scene, method: Method) -> Motion:
        asked.append(scene.tolerance)
        if len(asked) == 1:
            raise NotFollowed(0.5, name="rack")
        return simulate(scene, method)

    monkeypatch.setattr("validate.formulations.point_coordinates.simulate", solved)
    assert len(formulation("pointcoord").solve(scene).times) == len(scene.instants)
    assert asked[0] < 1e-11
    assert asked[1:] == [1e-3]
