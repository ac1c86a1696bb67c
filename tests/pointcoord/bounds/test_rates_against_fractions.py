"""Rates of a pose by itself lie within their radii of rational ones, where a rounding is all that there is.

One unknown u in u p = q with known p(t) and q(t): u' p + u p' = q' and u'' p + 2 u' p' + u p'' = q''. Or in
u u = q, where an error of u counts by its square as well.
"""

from __future__ import annotations

from fractions import Fraction
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.bounds.certified_poses import CertifiedPoses, grouped, with_known
from pointcoord.bounds.enclosed_points import enclosed_coordinates
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.numerics.rounding import UNIT_ROUNDOFF as U

Array = NDArray[np.float64]
COUNT = 300
UNKNOWN, ZERO, ONE, P, Q = range(5)
SYSTEM = quadratic_map(
    [(Product(1.0, (UNKNOWN, ZERO), (P, ZERO)), Product(-1.0, (Q, ZERO), (ONE, ZERO)))], 1, 5
)

SQUARE = quadratic_map(
    [(Product(1.0, (UNKNOWN, ZERO), (UNKNOWN, ZERO)), Product(-1.0, (Q, ZERO), (ONE, ZERO)))], 1, 5
)


def known(seed: int) -> list[tuple[Array, Array]]:
    """p and q with their first and second derivatives, each (COUNT,)."""
    generator = np.random.default_rng(seed)
    return [(generator.uniform(1.0, 2.0, COUNT), generator.uniform(1.0, 2.0, COUNT)) for _ in range(3)]


def exact_rates(numbers: list[tuple[Array, Array]], i: int) -> list[Fraction]:
    (p, q), (p1, q1), (p2, q2) = ((Fraction(float(a[i])), Fraction(float(b[i]))) for a, b in numbers)
    u = q / p
    v = (q1 - u * p1) / p
    return [u, v, (q2 - 2 * v * p1 - u * p2) / p]


def found(numbers: list[tuple[Array, Array]], off: float, unsolved: float = 0.0) -> list[Enclosed]:
    """What is proven of a quotient that was computed to a relative `off`."""
    exact = np.array([[float(rate) for rate in exact_rates(numbers, i)] for i in range(COUNT)]).T
    return enclosed(SYSTEM, numbers, exact, off, unsolved)


def enclosed(
    system: QuadraticMap, numbers: list[tuple[Array, Array]], exact: Array, off: float, unsolved: float = 0.0
) -> list[Enclosed]:
    """What is proven of an unknown and its rates, exact (3, COUNT), computed to a relative `off`."""
    generator = np.random.default_rng(1)
    states = []
    for rate, (p, q) in zip(exact, numbers, strict=True):
        state = np.zeros((COUNT, 5))
        state[:, UNKNOWN] = rate * (1.0 + off * generator.uniform(-1.0, 1.0, COUNT))
        state[:, P], state[:, Q] = p, q
        states.append(state)
    states[0][:, ONE] = 1.0
    mechanism = cast(Mechanism, SimpleNamespace(map=system, drawn_lacks=np.zeros(5), drawn_doubt=np.zeros(5)))
    groups, factors = grouped(system, states[0], (P, Q))
    assert groups.size == 1
    driven = [{P: Enclosed.of(p[:, None]), Q: Enclosed.of(q[:, None])} for p, q in numbers]
    poses = CertifiedPoses.of(mechanism, groups, factors, states[0][:, None], driven[0])
    rates = [
        with_known(state[:, None], 1, known) for state, known in zip(states[1:], driven[1:], strict=True)
    ]
    exact_states = enclosed_coordinates(mechanism, poses, rates, np.full(COUNT, unsolved), ())
    assert not any(state.change.any() for state in exact_states)
    return [Enclosed.of(s.high[:, 0], s.low[:, 0], *s.radius[:, :, 0]) for s in exact_states]


@pytest.mark.parametrize("off", [U, 1e-9, 1e-5, 1e-3])
def test_rates_of_a_pose_lie_within_their_radii(off: float) -> None:
    numbers = known(2)
    states = found(numbers, off)
    closest = np.zeros(3)
    for i in range(COUNT):
        for d, exact in enumerate(exact_rates(numbers, i)):
            state = states[d]
            middle = Fraction(float(state.high[i, UNKNOWN])) + Fraction(float(state.low[i, UNKNOWN]))
            radius = Fraction(float(state.radius[0, i, UNKNOWN]))
            assert abs(exact - middle) <= radius, (i, d)
            closest[d] = max(closest[d], float(abs(exact - middle) / radius))
    # Of what rounds in the order of its square only, some thousandths of the radius are used.
    assert (closest > (0.02 if off > U else 1e-3)).all(), closest
    for state in states:
        # A correction is known to some roundings of itself; rates here are below 40.
        assert state.radius[0, :, UNKNOWN].max() <= 40.0 * 40.0 * U * (off + 20.0 * U)


@pytest.mark.parametrize("off", [1e-6, 1e-4, 1e-2])
def test_a_square_of_an_error_is_within_the_radii(off: float) -> None:
    generator = np.random.default_rng(6)
    # Of so few bits that their products are exact.
    u, v, a = (generator.integers(2**16, 2**17, COUNT) / 2.0**20 for _ in range(3))
    none = np.zeros(COUNT)
    numbers = [(none, u * u), (none, 2.0 * u * v), (none, 2.0 * (v * v + u * a))]
    closest = np.zeros(3)
    for d, (state, exact) in enumerate(
        zip(enclosed(SQUARE, numbers, np.stack([u, v, a]), off), (u, v, a), strict=True)
    ):
        error = np.abs((exact - state.high[:, UNKNOWN]) - state.low[:, UNKNOWN])
        radius = state.radius[0, :, UNKNOWN]
        # The error itself is rounded in numbers below 1/8.
        assert (error <= radius + U**2).all(), d
        closest[d] = (error / radius).max()
    assert (closest > 0.1).all(), closest


def test_a_number_is_expected_to_be_rounded_once_at_least_and_a_few_times_at_most() -> None:
    numbers = known(3)
    for state in found(numbers, U):
        expected = state.radius[1]
        assert (expected >= U * np.abs(state.high)).all()
        # The known ones are exact but for their rounding; numbers here are below 40.
        assert (expected[:, [P, Q]] <= 1.01 * U * np.abs(state.high[:, [P, Q]])).all()
        assert expected.max() <= 40.0 * 40.0 * U


def test_a_pose_that_was_left_unsolved_is_expected_to_be_off_by_that_and_its_rates_with_it() -> None:
    numbers = known(4)
    plain, loose = found(numbers, U), found(numbers, U, 1e-6)
    more = [(b.radius[1] - a.radius[1])[:, UNKNOWN] for a, b in zip(plain, loose, strict=True)]
    (p, _), (p1, _), _ = numbers
    np.testing.assert_allclose(more[0], 1e-6, rtol=1e-6)
    # u off by d makes u' off by d p' / p, and solving for it counts that again with the condition number.
    assert (more[1] >= 1e-6 * p1 / p * (1.0 - 1e-6)).all()
    assert (more[1] <= 1.01e-6 * p1 / p).all()
    assert (more[2] > more[1] * p1 / p).all()
