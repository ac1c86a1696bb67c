"""The power series of a motion: its equations order by order, and how fast it converges."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
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


@few
@given(t=st.floats(-0.5, 2.0))
def test_first_two_orders_are_the_velocity_and_half_the_acceleration(strut: Mechanism, t: float) -> None:
    pose = pose_at(strut, t)
    known = known_at(strut, t, 2)
    series = expand(strut.map, pose.factors, pose.y, known)
    # The same equations with another solver, from the Jacobian by all coordinates: column j is 2 B(y, e_j).
    whole = 2.0 * strut.map.polar(pose.y, np.eye(strut.layout.size)).T
    by_unknowns, by_known = whole[:, :N], whole[:, N:]
    velocity = np.linalg.solve(by_unknowns, -by_known @ known[1])
    rate = np.concatenate([velocity, known[1]])
    half = np.linalg.solve(by_unknowns, -by_known @ known[2] - strut.map.residual(rate))
    # Two solves each, error n eps times the condition number; in the second the error of the first
    # comes back through 2 B(y', .) and the inverse once more.
    rounding = 8 * N * EPS * float(pose.condition)
    assert np.abs(series[1, :N] - velocity).max() <= rounding * np.abs(velocity).max()
    grown = rounding * float(pose.condition) * max(np.abs(velocity).max() ** 2, np.abs(half).max())
    assert np.abs(series[2, :N] - half).max() <= grown


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


def test_derivative_of_the_series_is_the_velocity_at_the_later_time(strut: Mechanism) -> None:
    t, s, order = 0.3, 0.1, 20
    pose, later = pose_at(strut, t), pose_at(strut, t + s)
    series = expand(strut.map, pose.factors, pose.y, known_at(strut, t, order))
    slope = np.polynomial.polynomial.polyval(s, series[1:] * np.arange(1, order + 1)[:, None])
    velocity = expand(strut.map, later.factors, later.y, known_at(strut, t + s, 1))[1]
    # The last terms are below 1e-13; the rest is rounding of two solves: eps times the condition number
    # of each, the first multiplied once more by what a displaced pose does to its velocity.
    assert np.abs(series[-1]).max() * order * s ** (order - 1) < 1e-13
    tolerance = (
        1e-13 + 8 * N * EPS * float(pose.condition) * np.abs(velocity).max() * float(later.condition) / 10
    )
    assert np.abs(slope - velocity).max() <= tolerance


def test_series_of_a_batch_are_those_of_each(strut: Mechanism) -> None:
    instants = np.array([[0.0, 0.5], [1.0, 1.5]])
    pose = assemble(
        strut, {"arm_angle": ARM.series(instants, 0)[..., 0], "rack": RACK.series(instants, 0)[..., 0]}
    )
    known = strut.known_series({"arm_angle": ARM.series(instants, 8), "rack": RACK.series(instants, 8)})
    batch = expand(strut.map, pose.factors, pose.y, known)
    for place in np.ndindex(2, 2):
        factors = factorise(strut.map.jacobian(pose.y[place]))
        alone = expand(strut.map, factors, pose.y[place], known[place])
        scale = np.abs(alone).max(axis=-1, keepdims=True)
        # The factors are of poses a step of noise apart; order k is a k-fold product of solves.
        tolerance = 8 * N * EPS * float(pose.condition[place]) * np.arange(1, 10)[:, None] ** 2 * scale
        assert (np.abs(batch[place] - alone) <= tolerance).all()
        # From orders that are at hand it goes on to the same.
        carried_on = expand(strut.map, factors, pose.y[place], known[place], batch[place][:4])
        assert (np.abs(carried_on - alone) <= tolerance).all()


def test_inputs_at_rest_give_a_series_at_rest(strut: Mechanism) -> None:
    pose = pose_at(strut, 0.0)
    known = np.zeros((6, strut.layout.size - N))
    known[0] = pose.y[N:]
    series = expand(strut.map, pose.factors, pose.y, known)
    assert np.array_equal(series[0], pose.y)
    assert not series[1:].any()


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


def test_time_unit_of_the_series_changes_no_bit(strut: Mechanism) -> None:
    pose = pose_at(strut, 0.4)
    known = known_at(strut, 0.4, 12)
    powers = 2.0 ** (-3 * np.arange(13.0))[:, None]
    plain = expand(strut.map, pose.factors, pose.y, known)
    scaled = expand(strut.map, pose.factors, pose.y, known * powers)
    assert np.array_equal(scaled[:, :N], (plain * powers)[:, :N])


def test_driven_series_are_those_of_the_inputs(strut: Mechanism, table: dict[str, tuple[float, ...]]) -> None:
    known = known_at(strut, 0.4, 6)
    rack = known[:, strut.layout.scalar("rack travel") - N] * float(strut.unit)
    assert np.array_equal(rack, RACK.series(0.4, 6))
    arm = np.linalg.norm(np.subtract(table["lower_ball_joint"], table["lower_arm_front"]))

    def rise(t: float) -> float:
        return float(arm * np.cos(ARM.series(t, 0)[0]))

    series = known[:, strut.layout.scalar("arm_angle rise") - N] * float(strut.unit)
    # Order 6 at 2^-6 s: what is left out is below 370 mm times (0.4 / 64)^7, below rounding.
    for s in (-(2.0**-6), 2.0**-6):
        assert abs(np.polynomial.polynomial.polyval(s, series) - rise(0.4 + s)) <= 16 * EPS * arm


@few
@given(t=st.floats(-0.5, 2.0), order=st.integers(1, 40), begun=st.integers(1, 12))
def test_a_series_is_carried_on_as_if_it_had_not_stopped(
    strut: Mechanism, t: float, order: int, begun: int
) -> None:
    pose = pose_at(strut, t)
    # In a unit of time in which the terms fall.
    known = known_at(strut, t, order) * 0.25 ** np.arange(order + 1.0)[:, None]
    whole = expand(strut.map, pose.factors, pose.y, known)
    carried_on = expand(strut.map, pose.factors, pose.y, known, whole[: begun + 1])
    # What is at hand is kept, and order k is a k-fold product of solves.
    assert np.array_equal(carried_on[: begun + 1], whole[: begun + 1])
    rounding = 8 * N * EPS * float(pose.condition) * np.arange(1, order + 2)[:, None] ** 2
    assert (np.abs(carried_on - whole) <= rounding * np.abs(whole).max(axis=-1, keepdims=True)).all()


@few
@given(t=st.floats(0.0, 1.5), order=st.integers(2, 14), squares=st.booleans())
def test_sums_of_a_degree_are_the_polar_forms_of_what_moves(
    strut: Mechanism, t: float, order: int, squares: bool
) -> None:
    """B of two coefficients in which only some coordinates move, row by row."""
    rng = np.random.default_rng(order)
    driven = strut.topology.driven if squares else range(N, strut.layout.size)
    moving = tuple(driven)
    terms = strut.map.moving_products(moving)
    a, b = np.zeros((2, strut.layout.size))
    for each in (a, b):
        each[[*range(N), *moving]] = rng.integers(-8, 9, N + len(moving))
    own = [np.append(each[[*range(N), *moving]], 0.0) for each in (a, b)]
    both = (terms.factors(each) for each in own)
    (one, other), (left, right) = ((each[: terms.count], each[-terms.count :]) for each in both)
    # Whole numbers round nothing.
    assert np.array_equal(terms.gather(0.5 * (one * right + left * other)), strut.map.polar(a, b))
