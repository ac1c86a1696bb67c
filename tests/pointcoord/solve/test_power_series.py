"""The power series of a motion: its equations order by order, and how fast it converges."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.power_series import cross_series, expand
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.time_functions import Polynomial, Sine

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
N = 17
ARM, RACK = Polynomial((1.1, 0.4, -0.1)), Sine(30.0, 1.5, 0.2)
few = settings(deadline=None, max_examples=max(10, settings.default.max_examples // 4))


def known_at(mechanism: Mechanism, t: float, order: int) -> Array:
    return mechanism.known_series({"arm_angle": ARM.series(t, order), "rack": RACK.series(t, order)})


def pose_at(mechanism: Mechanism, t: float) -> Pose:
    return assemble(mechanism, {"arm_angle": ARM.series(t, 0)[..., 0], "rack": RACK.series(t, 0)[..., 0]})


@few
@given(t=st.floats(-0.5, 2.0), order=st.integers(1, 24))
def test_coefficients_solve_the_constraints_at_every_order(strut: Mechanism, t: float, order: int) -> None:
    pose = pose_at(strut, t)
    series = expand(strut.map, pose.factors, pose.y, known_at(strut, t, order))
    assert series.shape == (order + 1, strut.layout.size)
    condition = float(pose.condition)
    size = np.abs(series).max(axis=-1)
    for k in range(order + 1):
        total = sum(strut.map.polar(series[i], series[k - i]) for i in range(k + 1))
        # Each order is a sum of k + 1 products in at most four terms per row, of differences of two, and
        # one solve, whose backward error is n eps of the row times the solution; C_u at the pose was
        # factorised a step of noise earlier, which is eps times the condition number.
        products = sum(size[i] * size[k - i] for i in range(k + 1))
        tolerance = (16 * (k + 1) + 4 * N + 4 * condition) * EPS * 4 * products
        assert np.abs(total).max() <= tolerance


@pytest.mark.parametrize("t", [0.0, 0.7, 1.6])
def test_truncated_error_decays_geometrically_and_twice_as_fast_in_half_the_time(
    strut: Mechanism, t: float
) -> None:
    orders = np.arange(2, 19)
    pose = pose_at(strut, t)
    series = expand(strut.map, pose.factors, pose.y, known_at(strut, t, int(orders[-1])))
    size = np.abs(series[:, :N]).max(axis=-1)
    reach = 0.5 * float(np.min(size[10:] ** (-1.0 / np.arange(10, len(size)))))
    slopes = []
    for s in (reach, 0.5 * reach):
        end = pose.y + series[1] * s
        end[N:] = known_at(strut, t + s, 0)[0]
        exact = newton_refine(strut.map, np.polynomial.polynomial.polyval(s, series) * 1.0)
        y = exact.y.copy()
        y[N:] = end[N:]
        exact = newton_refine(strut.map, y)
        assert exact.converged
        errors = [
            np.abs(np.polynomial.polynomial.polyval(s, series[: order + 1]) - exact.y)[:N].max()
            for order in orders
        ]
        seen = np.array(errors) > 1e3 * EPS
        assert seen.sum() >= 6
        slopes.append(np.polyfit(orders[seen], np.log2(np.array(errors)[seen]), 1)[0])
    # At half the time every order gains one bit more. Coefficients of a series with complex singular
    # points swing about their trend, which the fit over six orders or more sees as a quarter of a bit.
    assert slopes[0] < -0.5
    assert abs(slopes[1] - slopes[0] + 1.0) < 0.25


@settings(deadline=None)
@given(seed=st.integers(0, 2**32 - 1), order=st.integers(0, 8))
def test_series_of_a_cross_product_is_the_product_of_the_series(seed: int, order: int) -> None:
    rng = np.random.default_rng(seed)
    a, b = rng.integers(-20, 20, size=(2, order + 1, 3)).astype(float)
    polynomials = [[np.polynomial.Polynomial(v[:, i]) for i in range(3)] for v in (a, b)]
    p, q = polynomials

    def cut(x: np.polynomial.Polynomial) -> Array:
        return np.pad(x.coef, (0, 2 * order + 2))[: order + 1]

    exact = [cut(p[i - 2] * q[i - 1] - p[i - 1] * q[i - 2]) for i in range(3)]
    # Whole numbers: exact.
    assert np.array_equal(cross_series(a, b), np.stack(exact, axis=-1))
