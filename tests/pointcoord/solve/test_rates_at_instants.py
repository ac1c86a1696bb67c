"""The paper's algorithm at instants: its rates, its limits, and what its printed formula makes of them."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import Motion, Scene, simulate
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import CHORD, MAP, METHODS, NEWTON, NEWTON_COLD, SERIES, Method
from validate.paper.printed import PRINTED

EPS = np.finfo(float).eps
ALL = (SERIES, MAP, NEWTON, NEWTON_COLD, CHORD, PRINTED)


@pytest.mark.parametrize("method", ALL, ids=str)
def test_velocity_is_the_derivative_of_the_position(make_scene: Callable[..., Scene], method: Method) -> None:
    h = 2.0**-10
    motion = simulate(make_scene(rack=(0.0, 20.0), start=0.5, stop=0.5 + 8 * h, samples=9), method)
    proof = motion.proof()
    bound = max(float(proof.bound.max()), float(proof.carried_bound.max()))
    for name, p in motion.position.items():
        # Central differences of order 8 over the nine instants: no truncation is left at this step (the
        # ninth derivative is below 1e9 mm / s^9, times h^8); rounding: the weights sum to 2.1.
        weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
        tolerance = 1e9 * h**8 + 2.1 * 2 * bound / h + 2.1 * 1e-9 * method.by_series / h * 1e-3
        assert np.abs(weights @ p / h - motion.velocity[name][4]).max() <= tolerance


def acceleration_gap(motion: Motion, h: float) -> float:
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    return max(
        float(np.abs(weights @ v / h - motion.acceleration[n][4]).max()) for n, v in motion.velocity.items()
    )


def test_acceleration_is_the_derivative_of_the_velocity_and_the_printed_one_is_not(
    make_scene: Callable[..., Scene],
) -> None:
    h = 2.0**-10
    gaps = {
        method.name: acceleration_gap(
            simulate(make_scene(rack=(0.0, 20.0), start=0.5, stop=0.5 + 8 * h, samples=9), method), h
        )
        for method in ALL
    }
    # Velocities up to 400 mm/s with the rounding of two solves, condition number below 100 and 4000 for the
    # two formulations, over h; no truncation is left.
    tolerance = 2.1 * 64 * EPS * 400.0 * 4000.0 / h
    for method in ALL[:-1]:
        assert gaps[method.name] <= tolerance
    # Eq. (23) lacks a factor of two and repeats a row: off by more than any rounding.
    assert gaps[PRINTED.name] > 1e3 * tolerance
    assert gaps[PRINTED.name] > 1.0  # mm/s^2


# So near a fold no patch of a map can be proven.
@pytest.mark.parametrize("method", [name for name in METHODS if name != MAP.name])
@pytest.mark.parametrize("short", [1e-5, 1e-8])
def test_rates_near_a_lock_are_those_of_the_pose_that_is_reported(
    make_scene: Callable[..., Scene], strut: Mechanism, method: Method, short: float
) -> None:
    # A Jacobian of Newton's last but one place, off by more than the pose's error, gave velocities that
    # stretched the links of the reported pose.
    scene = make_scene((np.pi / 2,), (0.0, 130.10076831981567 * (1 - short)), stop=1.0, samples=2)
    motion = simulate(scene, method)
    p, v = motion.position, motion.velocity
    fast = max(np.abs(v[name]).max() for name in strut.layout.moving)
    for start, end in strut.layout.squared_lengths:
        stretch = (p[start][-1] - p[end][-1]) @ (v[start][-1] - v[end][-1])
        # r . v = 0 for every link. LU leaves some eps of the matrix times the solution, here 8; both factors
        # are rounded, coordinates up to 600 mm; three products.
        assert abs(stretch) <= 16 * EPS * 600.0 * 3 * fast
