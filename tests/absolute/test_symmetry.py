"""Turn, mirror, scale or move the whole car: the solution does the same."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kinds import Car, Kind
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
TIMES = np.linspace(0.2, 2.4, 4)
# Size 500 mm, condition number below 60; two solutions are compared.
ROUNDING = 2 * EPS * 500.0 * 60.0


def changed(car: Car, matrix: Array, shift: Array) -> dict[str, Array]:
    return {name: matrix @ np.array(point) + shift for name, point in car.items()}


def compare(
    kind: Kind,
    inputs: dict[str, Array],
    matrix: Array,
    shift: Array,
    tolerance: float,
) -> None:
    """Solve the car changed by p -> matrix p + shift and hold it against the plain car."""
    turned = kind.build(changed(kind.car, matrix, shift), up=matrix[:, 2], right=matrix[:, 1])
    plain = absolute.solve(kind.build(kind.car), inputs)
    other = absolute.solve(turned, inputs)
    sense = np.sign(np.linalg.det(matrix))
    for name in kind.car:
        assert np.allclose(
            other.position[name], plain.position[name] @ matrix.T + shift, rtol=0, atol=tolerance
        )
        assert np.allclose(other.velocity[name], plain.velocity[name] @ matrix.T, rtol=0, atol=tolerance)
        assert np.allclose(
            other.acceleration[name], plain.acceleration[name] @ matrix.T, rtol=0, atol=tolerance
        )
    for body in plain.angular_velocity:
        # An angular velocity is an axial vector: a mirror turns its sense round.
        for a, b in (
            (other.angular_velocity, plain.angular_velocity),
            (other.angular_acceleration, plain.angular_acceleration),
        ):
            assert np.allclose(a[body], sense * b[body] @ matrix.T, rtol=0, atol=tolerance / 100)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**6), mirrored=st.booleans())
def test_turned_or_mirrored_car_moves_turned_or_mirrored(
    kind: Kind,
    seed: int,
    mirrored: bool,
) -> None:
    matrix = pin.exp3(np.random.default_rng(seed).normal(size=3) * 2)
    if mirrored:
        matrix = matrix @ np.diag([1.0, -1.0, 1.0])
    # Turning rounds the drawing as well: once more the same error.
    compare(kind, kind.inputs(TIMES), matrix, np.zeros(3), 2 * ROUNDING)


@pytest.mark.parametrize("quarter", [(1, 0, 0), (0, 1, 0), (0, 0, 1)])
def test_no_direction_of_the_frame_is_special(
    kind: Kind,
    quarter: tuple[int, int, int],
) -> None:
    compare(
        kind, kind.inputs(TIMES), np.round(pin.exp3(np.pi / 2 * np.array(quarter))), np.zeros(3), ROUNDING
    )


@pytest.mark.parametrize("distance", [2.0**20, 2.0**30])
def test_distance_from_the_origin_costs_only_its_own_rounding(kind: Kind, distance: float) -> None:
    # Points are integers, so the moved drawing is exact; positions are rounded at the distance,
    # and the middle of the drawing as well.
    shift = np.array([distance, -distance, 3 * distance])
    compare(kind, kind.inputs(TIMES), np.eye(3), shift, ROUNDING + 8 * EPS * 3 * distance)


@pytest.mark.parametrize("distance", [2.0**20, 2.0**30])
def test_rates_far_from_the_origin_are_as_accurate_as_near_it(kind: Kind, distance: float) -> None:
    near = absolute.solve(kind.build(kind.car), kind.inputs(TIMES))
    far = absolute.solve(kind.build(changed(kind.car, np.eye(3), np.full(3, distance))), kind.inputs(TIMES))
    for name in kind.car:
        # Differences to the middle keep the rounding of the middle, eps * distance, in the worst
        # case; here body shapes are differences of it and so exact to a few parts of eps * size.
        assert np.allclose(far.velocity[name], near.velocity[name], rtol=0, atol=ROUNDING)
        assert np.allclose(far.acceleration[name], near.acceleration[name], rtol=0, atol=ROUNDING)


@pytest.mark.parametrize("factor", [1e-6, 1e-3, 1e3, 1e9])
def test_scaled_mechanism_moves_scaled(kind: Kind, factor: float) -> None:
    plain = absolute.solve(kind.build(kind.car), kind.inputs(TIMES), conditions=True)
    inputs = kind.inputs(TIMES)
    scaled_inputs = {"arm_angle": inputs["arm_angle"], "rack": inputs["rack"] * factor}
    scaled = absolute.solve(
        kind.build(changed(kind.car, np.eye(3) * factor, np.zeros(3))),
        scaled_inputs,
        conditions=True,
    )
    for name in kind.car:
        for a, b in (
            (scaled.position, plain.position),
            (scaled.velocity, plain.velocity),
            (scaled.acceleration, plain.acceleration),
        ):
            assert np.allclose(a[name], b[name] * factor, rtol=0, atol=2 * ROUNDING * factor)
    assert plain.condition is not None
    assert scaled.condition is not None
    # The Jacobian has no units left: the same numbers up to rounding.
    assert np.allclose(scaled.condition, plain.condition, rtol=1e-9)
