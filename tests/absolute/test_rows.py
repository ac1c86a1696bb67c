"""Rows, their Jacobian and their drift, against differences and against Pinocchio's own anchors."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import absolute
from absolute.mechanism import Mechanism

EPS = np.finfo(float).eps

# Rows [translation; rotation] of a frame anchor that each joint keeps, and the sign of its rotation.
ANCHOR_ROWS = {"spherical": [0, 1, 2], "revolute": [0, 1, 2, 3, 4], "prismatic": [0, 1, 3, 4, 5]}


def configuration(mechanism: Mechanism, seed: int, far: float) -> np.ndarray:
    step = np.random.default_rng(seed).normal(size=mechanism.pin_model.nv) * far
    return mechanism.moved(mechanism.drawn, mechanism.poses(mechanism.drawn).rotation, step)


def body_rates(
    velocity: np.ndarray, acceleration: np.ndarray, rotation: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Rates [o', w], [o'', w'] in world axes as Pinocchio's, in body axes and spatial: o'' - w x o'."""
    twist, spatial = velocity.reshape(-1, 2, 3), acceleration.reshape(-1, 2, 3).copy()
    spatial[:, 0] -= np.cross(twist[:, 1], twist[:, 0])
    return (twist @ rotation).ravel(), (spatial @ rotation).ravel()


def placement_error(placement: pin.SE3) -> np.ndarray:
    """Translation and (-R12, R02, R10): what the rows of an anchor measure."""
    turn = placement.rotation
    return np.array([*placement.translation, -turn[1, 2], turn[0, 2], turn[1, 0]])


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_jacobian_is_the_derivative_of_the_rows_on_the_manifold(strut: absolute.Model, seed: int) -> None:
    mechanism = Mechanism(strut)
    q = configuration(mechanism, seed, 0.5)
    poses = mechanism.poses(q)
    jacobian = mechanism.stack.jacobian(mechanism.stack.place(*poses))
    direction = np.random.default_rng(seed + 1).normal(size=mechanism.pin_model.nv)
    direction /= np.linalg.norm(direction)
    h = 1e-5

    def values(step: float) -> np.ndarray:
        return mechanism.stack.place(
            *mechanism.poses(mechanism.moved(q, poses.rotation, step * direction))
        ).values

    slope = (values(h) - values(-h)) / (2 * h)
    # Truncation h^2 / 6 times a third derivative below 100, and rounding of two values over 2 h.
    assert np.abs(slope - jacobian @ direction).max() < 100 * h**2 / 6 + 8 * EPS / h


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_drift_is_the_second_derivative_along_a_steady_turn(strut: absolute.Model, seed: int) -> None:
    # Origins move straight, bodies turn steadily: no body accelerates, so the rows' second
    # derivative over time is the drift alone.
    mechanism = Mechanism(strut)
    poses = mechanism.poses(configuration(mechanism, seed, 0.5))
    rng = np.random.default_rng(seed + 1)
    velocity, spin = rng.normal(size=(2, len(poses.origin), 3)) / 3
    velocity[0] = spin[0] = 0.0
    stack = mechanism.stack
    h = 1e-4

    def values(t: float) -> np.ndarray:
        turned = np.array([pin.exp3(t * w) @ r for w, r in zip(spin, poses.rotation, strict=True)])
        return stack.place(turned, poses.origin + t * velocity).values

    bend = (values(h) - 2 * values(0.0) + values(-h)) / h**2
    drift = stack.drift(stack.place(*poses), np.stack((velocity, spin), axis=1))
    # Truncation h^2 / 12 times a fourth derivative below 1000, and rounding of four values over h^2.
    assert np.abs(bend - drift).max() < 1000 * h**2 / 12 + 8 * EPS / h**2


def test_rates_of_targets_are_their_derivatives(strut: absolute.Model) -> None:
    mechanism = Mechanism(strut)
    start, rate, second = np.random.default_rng(4).normal(size=(3, 2)) * [0.5, 50.0] + [[1.6, 0.0]]
    h = 1e-4
    t = np.array([-h, 0.0, h])[:, None]
    series = start + rate * t + second * t * t / 2.0, rate + second * t, second + 0.0 * t
    before, here, after = mechanism.targets(*series)[..., mechanism.joint_rows :].swapaxes(0, 1)
    # Truncation h^2 / 6 times a third derivative below 1000, and rounding of two values over 2 h.
    change = (after - before)[:2] / (2.0 * h)
    assert np.abs(change - here[1:]).max() < 1000.0 * h**2 / 6.0 + 8.0 * EPS / h
    # One instant after the other is the same.
    steady = mechanism.targets(start, rate)
    together = mechanism.targets(*(np.tile(part, (3, 1)) for part in (start, rate, 0.0 * rate)))
    assert all(np.array_equal(steady, together[:, k]) for k in range(3))


def test_one_number_is_never_spread_over_several_inputs(strut: absolute.Model) -> None:
    mechanism = Mechanism(strut)
    two = mechanism.drawn_inputs.tolist()
    with pytest.raises(IndexError):
        mechanism.targets(np.zeros((1, 1)))
    for values in (two[:1], [*two, 0.0]):
        with pytest.raises(ValueError, match="zip"):
            mechanism.named(values)
