"""Rates are derivatives of what is solved."""

import numpy as np
import pytest
from cars_in_closed_form import Linkage
from relative_cars import model_of, swing
from sample_cars import SampleCar, by_car

from validate.cars.car import Car
from validate.relative.errors import PoseError

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


@by_car
def test_a_pose_on_a_fold_is_refused(car: SampleCar) -> None:
    linkage = Linkage.of(Car(car.points, car.side, closure=car.closure, suspension=car.type))
    end = linkage.end(linkage.home, "rack", True)
    assert end is not None
    model = model_of(car)
    beyond = linkage.home["rack"] + (1.0 + 1e-12) * (end[0] - linkage.home["rack"])
    laws = {
        name: np.array([[value, 0.1, 0.0]])
        for name, value in {"arm_angle": linkage.home["arm_angle"], "rack": beyond}.items()
    }
    with pytest.raises(PoseError, match=r"cannot be reached|singular"):
        model.rates(model.poses(laws, [0.0]), laws)
