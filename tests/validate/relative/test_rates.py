"""Rates are derivatives of what is solved, and so are the derivatives by the rows that claims are made of."""

import numpy as np
import pytest
from cars_in_closed_form import Linkage
from relative_cars import model_of, swing
from sample_cars import SampleCar, by_car

import validate.relative.follow
from validate.cars.car import Car
from validate.relative.accuracy import point_derivatives
from validate.relative.errors import PoseError
from validate.relative.model import Model
from validate.relative.tree import Tree

TIMES = np.linspace(0.3, 1.3, 5)
STEP = 1e-3


def stencil(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivative by differences of the fourth order at five places, (5, ...)."""
    weights = np.array([[1.0, -8.0, 0.0, 8.0, -1.0], [-1.0, 16.0, -30.0, 16.0, -1.0]])
    first, second = np.tensordot(weights / 12.0, values, axes=1)
    return first / STEP, second / STEP**2


@by_car
def test_velocities_and_accelerations_are_difference_quotients_of_positions(car: SampleCar) -> None:
    model = model_of(car)
    poses = model.poses(swing(car, TIMES), TIMES)
    numbers = model.numbers(poses, model.rates(poses, swing(car, TIMES)))
    for k, time in enumerate(TIMES):
        near = time + STEP * np.arange(-2.0, 3.0)
        places = model.positions(model.poses(swing(car, near), near))
        for name, place in places.items():
            first, second = stencil(place)
            # STEP^4 of fifth derivatives, below 1e6 mm/s^5; rounding of 1e-13 mm over STEP and STEP^2.
            np.testing.assert_allclose(numbers["velocity"][name][k], first, atol=1e-6, err_msg=name)
            np.testing.assert_allclose(numbers["acceleration"][name][k], second, atol=1e-5, err_msg=name)


@by_car
def test_angular_velocity_moves_every_line_of_the_knuckle(car: SampleCar) -> None:
    model = model_of(car)
    poses = model.poses(swing(car, TIMES), TIMES)
    n = model.numbers(poses, model.rates(poses, swing(car, TIMES)))
    turn, rate = n["angular_velocity"]["knuckle"], n["angular_acceleration"]["knuckle"]
    for name in ("tie_rod_outer", "wheel_centre"):
        r, v, a = (n[q][name] - n[q]["lower_ball_joint"] for q in ("position", "velocity", "acceleration"))
        np.testing.assert_allclose(v, np.cross(turn, r), atol=1e-10)
        np.testing.assert_allclose(a, np.cross(rate, r) + np.cross(turn, np.cross(turn, r)), atol=1e-9)


def with_rows_off(model: Model, row: int, by: float, laws: dict[str, np.ndarray]) -> dict:
    """Everything, with one row of the closure equations held to another value than zero."""
    right = validate.relative.follow.targets_at

    def wrong(tree: Tree, inputs: np.ndarray) -> np.ndarray:
        targets = right(tree, inputs)
        targets[..., row] += by
        return targets

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(validate.relative.follow, "targets_at", wrong)
        poses = model.poses(laws, TIMES)
    return model.numbers(poses, model.rates(poses, laws))


@by_car
def test_derivatives_by_the_rows_are_what_an_error_in_a_row_does(car: SampleCar) -> None:
    """The claims rest on them: of places, velocities and accelerations alike."""
    model = model_of(car)
    laws = swing(car, TIMES)
    poses = model.poses(laws, TIMES)
    motion = model.rates(poses, laws)
    known = model.deviations(poses, motion)
    step = 1e-5
    scales = [model.unit * np.ldexp(1.0, -order * motion.exponent)[:, None] for order in range(3)]
    for row in range(model.tree.size):
        ahead, behind = (with_rows_off(model, row, s * step, laws) for s in (1.0, -1.0))
        for name, place in model.tree.cut.points.items():
            found = point_derivatives(known.motion, model.tree.together((place,)))
            for order, quantity in enumerate(("position", "velocity", "acceleration")):
                slope = (ahead[quantity][name] - behind[quantity][name]) / (2.0 * step)
                largest = max(np.abs(a).max() for a in ahead[quantity].values()) + model.unit
                # step^2 of third derivatives, some hundreds of the largest number.
                np.testing.assert_allclose(
                    found[order][:, row, 0] * scales[order],
                    slope,
                    atol=1e-6 * largest,
                    err_msg=f"{row} {name}",
                )


@by_car
def test_claims_hold_what_an_early_end_of_newtons_method_leaves(car: SampleCar) -> None:
    times = np.linspace(0.0, 2.0, 41)
    laws = swing(car, times)
    model = model_of(car)
    best, coarse = model.poses(laws, times), model.poses(laws, times, 1e-4)
    motion = model.rates(coarse, laws)
    claims = model.claims(coarse, motion, model.deviations(coarse, motion))
    exact, found = model.numbers(best, model.rates(best, laws)), model.numbers(coarse, motion)
    for quantity, arrays in found.items():
        for name, array in arrays.items():
            # What is left is some 1e-6 of the car, and its square is left out.
            assert (np.abs(array - exact[quantity][name]) <= 1.01 * claims[quantity][name]).all(), name
    gap = max(np.abs(found["position"][n] - exact["position"][n]).max() for n in found["position"])
    assert gap > 1e-7


@by_car
def test_a_pose_on_a_fold_is_refused_and_not_claimed(car: SampleCar) -> None:
    linkage = Linkage.of(Car(car.points, car.side, closure=car.closure, suspension=car.type))
    end = linkage.end(linkage.home, "rack", True)
    assert end is not None
    model = model_of(car)
    near = linkage.home["rack"] + (1.0 - 1e-15) * (end[0] - linkage.home["rack"])
    values = {"arm_angle": linkage.home["arm_angle"], "rack": near}
    laws = {name: np.array([[value, 0.1, 0.0]]) for name, value in values.items()}

    def answer() -> None:
        poses = model.poses(laws, [0.0])
        model.deviations(poses, model.rates(poses, laws))

    with pytest.raises(PoseError, match=r"fold|cannot be reached|singular"):
        answer()
