"""A motion is followed on the branch of its drawing, however it is sampled, and refused where that ends."""

import numpy as np
import pytest
from cars_in_closed_form import Linkage
from hypothesis import given
from hypothesis import strategies as st
from relative_cars import model_of, swing
from sample_cars import PAPER_STRUT, SAMPLES, SampleCar, by_car

import validate.relative.follow
from validate.cars.car import Car
from validate.relative.errors import InputError, PoseError

TIMES = np.linspace(0.0, 2.0, 201)


def largest_gap(one: dict[str, np.ndarray], other: dict[str, np.ndarray]) -> float:
    return max(float(np.abs(one[name] - other[name]).max()) for name in one)


@given(st.sampled_from(SAMPLES), st.lists(st.integers(0, 200), min_size=1, max_size=8, unique=True))
def test_a_pose_is_the_same_by_whichever_instants_it_is_reached(car: SampleCar, chosen: list[int]) -> None:
    model = model_of(car)
    laws = swing(car, TIMES)
    whole = model.positions(model.poses(laws, TIMES))
    few = sorted(chosen)
    part = {name: law[few] for name, law in laws.items()}
    some = model.positions(model.poses(part, TIMES[few]))
    # Two hundred roundings of a metre, and a condition number of ten.
    assert largest_gap({name: place[few] for name, place in whole.items()}, some) < 2e-11


@by_car
@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-9])
def test_the_error_follows_the_tolerance_and_so_does_the_work(car: SampleCar, tolerance: float) -> None:
    model = model_of(car)
    laws = swing(car, TIMES)
    best, coarse = model.poses(laws, TIMES), model.poses(laws, TIMES, tolerance)
    error = largest_gap(model.positions(best), model.positions(coarse))
    # Rows off by the tolerance move the points by the condition number, some ten, times as much.
    assert error <= 20.0 * tolerance
    assert np.linalg.norm(coarse.residual, axis=1).max() * model.unit <= tolerance
    assert coarse.steps < best.steps


@by_car
def test_a_predicted_step_that_jumps_to_another_branch_is_taken_back(
    car: SampleCar, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Planted: whatever Newton's method corrects is taken, and the prediction is thrown far off."""
    model = model_of(car)
    laws = swing(car, TIMES)
    right = model.positions(model.poses(laws, TIMES))
    weights = validate.relative.follow._weights

    def thrown(times: np.ndarray, count: int) -> np.ndarray:
        found = weights(times, count)
        found[100] = [0.0] * (count - 1) + [-1.0]
        return found

    monkeypatch.setattr(validate.relative.follow, "_weights", thrown)
    monkeypatch.setattr(validate.relative.follow, "CORRECTED", np.inf)
    poses = model.poses(laws, TIMES)
    tree = model.tree
    assert (tree.signs(poses.jacobian) == tree.signs(model.home.jacobian)).all()
    assert largest_gap(model.positions(poses), right) < 2e-11


@by_car
@pytest.mark.parametrize("driven", ["arm_angle", "rack"])
@pytest.mark.parametrize("ahead", [False, True])
def test_an_input_beyond_its_end_is_refused_with_the_end(car: SampleCar, driven: str, ahead: bool) -> None:
    linkage = Linkage.of(Car(car.points, car.side, closure=car.closure, suspension=car.type))
    end = linkage.end(linkage.home, driven, ahead)
    assert end is not None
    home = linkage.home
    goal = {name: np.full(5, value) for name, value in home.items()}
    goal[driven] = home[driven] + np.array([0.0, 0.5, 0.9, 1.1, 1.2]) * (end[0] - home[driven])
    if driven == "arm_angle" and not 0.0 < goal[driven][3] < np.pi:
        return
    with pytest.raises(PoseError) as caught:
        model_of(car).poses(goal, np.arange(5.0))
    error = caught.value
    assert error.instant == 3
    assert error.wanted[driven] == goal[driven][3]
    # A way is followed until its steps shrink below 2^-44 of it, or the fold's rounding, root of 1e-15, is
    # at 1e-9 of a range at the most.
    assert error.reached[driven] == pytest.approx(end[0], abs=1e-9 * abs(end[0] - home[driven]))
    assert f"{driven} = {error.reached[driven]:.10g}" in str(error)
    assert len(error.partial.q) == 3


def test_a_way_that_is_blocked_between_two_poses_is_refused_and_the_way_round_is_taken() -> None:
    """Below a rack travel of -0.0029 mm the paper's arm cannot pass 35.1 degrees, above it can."""
    model = model_of(PAPER_STRUT)

    def reached(*places: tuple[float, float]) -> dict[str, np.ndarray]:
        angles, racks = np.array(places).T
        laws = {"arm_angle": np.deg2rad(angles), "rack": racks}
        return model.positions(model.poses(laws, np.arange(float(len(places)))))

    round_ = reached((37.0, -0.1), (37.0, 0.1), (34.0, 0.1), (34.0, -0.1))
    assert round_["wheel_centre"].shape == (4, 3)
    with pytest.raises(PoseError, match="hold each other") as caught:
        reached((37.0, -0.1), (34.0, -0.1))
    assert caught.value.instant == 1
    assert "tie_rod" in caught.value.links
    # The arm ends at 35.27 degrees there.
    assert np.rad2deg(caught.value.reached["arm_angle"]) == pytest.approx(35.27, abs=0.005)


@by_car
def test_an_angle_beyond_half_a_turn_is_refused(car: SampleCar) -> None:
    laws = swing(car, TIMES)
    laws["arm_angle"][9, 0] = 3.2
    with pytest.raises(InputError, match="from 0 to pi") as caught:
        model_of(car).poses(laws, TIMES)
    assert (caught.value.instant, caught.value.value) == (9, 3.2)


@by_car
@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_an_input_that_is_no_number_is_refused_with_its_instant(car: SampleCar, wrong: float) -> None:
    laws = swing(car, TIMES)
    laws["rack"][7, 0] = wrong
    with pytest.raises(InputError, match="rack") as caught:
        model_of(car).poses(laws, TIMES)
    assert caught.value.instant == 7
    with pytest.raises(InputError, match="missing"):
        model_of(car).poses({"arm_angle": laws["arm_angle"]}, TIMES)
