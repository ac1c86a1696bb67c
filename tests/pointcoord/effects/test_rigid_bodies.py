"""Rates of a body, for random rigid motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord import SingularConfiguration
from pointcoord.effects.knuckle_rates import ByEdges

EPS = np.finfo(float).eps
Array = NDArray[np.float64]


def body_rates(*states: Array) -> tuple[Array, Array]:
    """Of three points, states of shape (..., 3, 3)."""
    position, velocity, acceleration = (
        {str(i): state[..., i, :] for i in range(3)} for state in np.broadcast_arrays(*states)
    )
    return ByEdges().rates(position, velocity, acceleration)


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), in_plane=st.booleans())
def test_rates_of_a_batch_of_rigid_motions_are_recovered(seed: int, in_plane: bool) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(2, 4, 3, 3)) * (1.0, 1.0, 0.0 if in_plane else 1.0)
    omega, alpha, velocity, acceleration = rng.normal(size=(4, 2, 4, 1, 3))
    if in_plane:
        omega[..., 2] = 0.0  # where the paper's quotient is 0/0
    v = velocity + np.cross(omega, points)
    a = acceleration + np.cross(alpha, points) + np.cross(omega, np.cross(omega, points))
    found, second = body_rates(points, v, a)
    for place in np.ndindex(2, 4):
        r = points[place] - points[place].mean(axis=0)
        size, condition = np.abs(r).max(), np.linalg.cond(np.sum(r * r) * np.eye(3) - r.T @ r)
        turn, far = np.linalg.norm(omega[place]), np.abs(points[place]).max()
        # Sums of three products of numbers up to 5 sizes, then one solve of a system of this condition.
        rounded = 64 * 3 * EPS * condition * far / size**2
        tolerance = rounded * (np.abs(v[place]).max() + turn * far)
        assert np.abs(found[place] - omega[place]).max() <= tolerance
        # The error of omega enters twice through omega x (omega x r).
        wide = rounded * (np.abs(a[place]).max() + turn**2 * far) + 8 * condition * turn * tolerance
        assert np.abs(second[place] - alpha[place]).max() <= wide


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), power=st.integers(-20, 20))
def test_points_in_one_line_are_refused_also_in_a_batch(seed: int, power: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(4, 3, 3))
    line = np.linspace(-1.0, 1.0, 3)[:, None] * rng.normal(size=3)
    points[2] = rng.choice([0.0, 1.0, 1e4]) * rng.normal(size=3) + line
    points = points * 2.0**power
    with pytest.raises(SingularConfiguration, match="in one line"):
        body_rates(points, np.cross([1.0, 2.0, 3.0], points), np.zeros_like(points))


def test_a_needle_a_millionth_as_thick_as_long_turns_as_its_points_do() -> None:
    """Its inertia has the condition number of 1e12, of which the rates lose only the root."""
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
