"""Rates of a body, for random rigid motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord import SingularConfiguration
from pointcoord.effects.rigid import body_rates, stack_points

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


def spread(points: Array) -> tuple[float, float]:
    """Size of a set of points about its centroid and the condition number of its inertia tensor."""
    r = points - points.mean(axis=0)
    inertia = np.sum(r * r) * np.eye(3) - r.T @ r
    return float(np.abs(r).max()), float(np.linalg.cond(inertia))


@plain
@given(seed=seeds, count=st.integers(3, 6), flat=st.booleans())
def test_rates_of_a_rigid_motion_are_recovered(seed: int, count: int, flat: bool) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 3)) * (1.0, 1.0, 0.0 if flat else 1.0)
    omega, alpha, velocity, acceleration = rng.normal(size=(4, 3))
    if flat:
        omega[2] = 0.0  # in the plane of the points, where the paper's quotient is 0/0
    v = velocity + np.cross(omega, points)
    a = acceleration + np.cross(alpha, points) + np.cross(omega, np.cross(omega, points))
    size, condition = spread(points)
    found, second = body_rates(points, v, a)
    # Moments of `count` products of numbers up to 5 sizes, then one solve of a system of this condition.
    fast = np.abs(v).max() + np.linalg.norm(omega) * np.abs(points).max()
    tolerance = 64 * count * EPS * condition * fast * np.abs(points).max() / size**2
    assert np.abs(found - omega).max() <= tolerance
    # The error of omega enters twice through omega x (omega x r).
    hard = np.abs(a).max() + np.linalg.norm(omega) ** 2 * np.abs(points).max()
    wide = 64 * count * EPS * condition * hard * np.abs(points).max() / size**2
    assert np.abs(second - alpha).max() <= wide + 8 * condition * np.linalg.norm(omega) * tolerance


@plain
@given(seed=seeds)
def test_rates_of_a_batch_are_those_of_each(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, v, a = rng.normal(size=(3, 2, 4, 5, 3))
    omega, alpha = body_rates(points, v, a)
    for place in np.ndindex(2, 4):
        _, condition = spread(points[place])
        alone, second = body_rates(points[place], v[place], a[place])
        # The same operations; sums may be taken in another order.
        assert np.abs(omega[place] - alone).max() <= 64 * EPS * condition * (1 + np.abs(alone).max())
        size = 1 + np.abs(second).max() + np.abs(alone).max() ** 2
        assert np.abs(alpha[place] - second).max() <= 64 * EPS * condition * size * 10


@plain
@given(seed=seeds, count=st.integers(2, 5), far=st.sampled_from([0.0, 1.0, 1e4]), power=st.integers(-20, 20))
def test_points_in_one_line_are_refused(seed: int, count: int, far: float, power: int) -> None:
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=3)
    points = far * rng.normal(size=3) + np.linspace(-1.0, 1.0, count)[:, None] * direction
    points = points * 2.0**power
    with pytest.raises(SingularConfiguration, match="in one line"):
        body_rates(points, np.cross([1.0, 2.0, 3.0], points), np.zeros_like(points))


@plain
@given(seed=seeds, power=st.integers(-200, 200))
def test_size_of_a_body_changes_no_bit_of_its_rates(seed: int, power: int) -> None:
    states = np.random.default_rng(seed).normal(size=(3, 4, 3))
    for plainly, scaled in zip(body_rates(*states), body_rates(*np.ldexp(states, power)), strict=True):
        assert np.array_equal(plainly, scaled)


def test_one_line_in_a_batch_is_refused() -> None:
    points = np.random.default_rng(1).normal(size=(4, 3, 3))
    points[2] = np.linspace(0.0, 1.0, 3)[:, None] * [1.0, 2.0, -1.0]
    with pytest.raises(SingularConfiguration):
        body_rates(points, points, points)


def test_stacked_points_keep_their_order() -> None:
    a, b = np.zeros((5, 3)), np.ones(3)
    stacked = stack_points([a, b])
    assert stacked.shape == (5, 2, 3)
    assert np.array_equal(stacked[:, 1], np.ones((5, 3)))


@pytest.mark.parametrize("thin", [1e-2, 1e-4, 1e-6])
def test_rates_of_a_thin_body_lose_digits_once_and_not_twice(thin: float) -> None:
    # Of a triangle as thin as this the turn about its long side is known to eps / thin of the points'
    # velocities, which are rounded. Its inertia tensor has the condition number thin^-2.
    rng = np.random.default_rng(3)
    for _ in range(50):
        points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [rng.uniform(0.2, 0.8), thin, 0.0]])
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        points, omega = points @ turn.T, rng.normal(size=3)
        found, _ = body_rates(points, np.cross(omega, points), np.zeros((3, 3)))
        # Points and velocities up to 4 are rounded, three of each, and enter as 1 / (0.8 thin) at most.
        assert np.abs(found - omega).max() <= 16 * 4 * EPS / (0.8 * thin)


def test_a_needle_a_millionth_as_thick_as_long_turns_as_its_points_do() -> None:
    # Whole numbers, so that points, velocities and what is asked for are exact.
    rng = np.random.default_rng(5)
    for _ in range(200):
        start, end = rng.integers(-(2**22), 2**22, (2, 3))
        points = np.array([start, end, (start + end) // 2 + rng.integers(-12, 13, 3)]).astype(float)
        length = np.linalg.norm(points[1] - points[0])
        height = np.linalg.norm(np.cross(points[1] - points[0], points[2] - points[0])) / length
        if height < 1e-6 * length:
            continue
        omega = rng.integers(-9, 10, 3).astype(float)
        v = np.cross(omega, points)
        found, _ = body_rates(points, v, np.cross(omega, v))
        # The means of three are rounded, by EPS |p| of points and EPS |omega| |p| of velocities, each in two
        # components; over the height that is how far the needle turns about itself.
        turn = 4.0 * EPS * np.abs(points).max() * np.abs(omega).max() / height
        assert np.abs(found - omega).max() <= turn
