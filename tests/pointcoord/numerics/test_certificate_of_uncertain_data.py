"""The certificate where the known coordinates are uncertain, on systems whose solutions are at hand."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import Certificate, ball, certify
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.numerics.rounding import EPS

plain = settings(deadline=None)


def certify_alone(system: QuadraticMap, y: Array, data: Array) -> Certificate:
    """The certificate of one pose, whose known coordinates may be off by `data`, by its own inverse."""
    found = certify(system, Enclosed.of(y[None], 0.0, data[None]), factorise(system.jacobian(y)))
    return replace(
        found, radius=found.radius[0], step=found.step[0], spread=found.spread[0], tail=found.tail[0]
    )


def linear_map(n: int) -> QuadraticMap:
    """A u = b with known A and b: y = (u, A by rows, b, 0, 1)."""
    zero, one = n + n * n + n, n + n * n + n + 1
    rows = [
        (
            *(Product(1.0, (n + n * i + j, zero), (j, zero)) for j in range(n)),
            Product(-1.0, (n + n * n + i, zero), (one, zero)),
        )
        for i in range(n)
    ]
    return quadratic_map(rows, unknowns=n, size=one + 1)


def certified(matrix: Array, right: Array, u: Array, doubt: Array) -> Certificate:
    """The certificate of u for matrix and right side, of which the entries may be off by `doubt`."""
    n = len(right)
    y = np.concatenate([u, matrix.ravel(), right, [0.0, 1.0]])
    data = np.concatenate([np.zeros(n), doubt, [0.0, 0.0]])
    return certify_alone(linear_map(n), y, data)


@plain
@given(z=st.floats(0.0, 0.99), constant=st.floats(1e-9, 0.99), omega=st.floats(1e-3, 1e3))
def test_the_ball_is_the_smallest_that_the_test_holds_for(z: float, constant: float, omega: float) -> None:
    eta = constant * (1.0 - z) ** 2 / (2.0 * omega)
    found = ball(np.array(eta), np.array(z), np.array(omega))
    assert found.proven

    def holds(radius: Fraction) -> bool:
        return Fraction(eta) + Fraction(z) * radius + Fraction(omega) * radius**2 / 2 <= radius

    radius, outer = (Fraction(float(number)) for number in (found.radius, found.outer))
    # What is said has a millionth to spare for its own rounding.
    less, more = 1 - Fraction(1, 10**5), 1 + Fraction(1, 10**5)
    assert holds(radius)
    assert not holds(radius * less)
    assert holds(outer)
    assert not holds(outer * more)
    turned = Fraction(z) + Fraction(omega) * radius
    tail = Fraction(z) * radius + Fraction(omega) * radius**2 / 2
    assert turned <= Fraction(float(found.contraction)) <= turned * more
    assert tail <= Fraction(float(found.tail)) <= tail * more


@plain
@given(seed=st.integers(0, 2**32 - 1), size=st.floats(-6.0, -1.3))
def test_radius_covers_the_worst_solution_over_the_corners_of_the_data_box(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    matrix = np.eye(2) + rng.uniform(-0.3, 0.3, size=(2, 2))
    right = rng.uniform(-1.0, 1.0, size=2)
    doubt = 10.0**size * rng.uniform(0.0, 1.0, size=6)
    u = np.linalg.solve(matrix, right)
    certificate = certified(matrix, right, u, doubt)
    worst, each = 0.0, np.zeros(2)
    for signs in product((-1.0, 1.0), repeat=6):
        moved = np.concatenate([matrix.ravel(), right]) + np.array(signs) * doubt
        gap = np.abs(np.linalg.solve(moved[:4].reshape(2, 2), moved[4:]) - u)
        worst, each = max(worst, float(gap.max())), np.maximum(each, gap)
    # A solution of two equations with a condition number below 10 is right to 40 roundings.
    noise = 40 * EPS * np.abs(u).max()
    assert worst <= certificate.radius + noise
    assert (each <= certificate.coordinates + noise).all()
    # And it is of use: the rows of |X| d are reached at a corner each, z <= 0.2 (entries off by 0.05, |X|
    # below 2.5 in each row's sum, two entries a row) costs a factor of 1 / (1 - z) at most twice.
    assert certificate.radius <= 2.0 * worst + noise


def test_nothing_is_proven_of_a_matrix_that_is_regular_by_rounding_only() -> None:
    # With x = 1 + 3/4 2^-53 the matrix (5 x, 7 x; 5, 7) has no inverse. As differences of two numbers 5 x
    # is rounded to 5 and 7 x away from 7: what is computed has an inverse, and LAPACK finds it exactly.
    tiny = 0.75 * 2.0**-53
    zero, one, low_first, low_second = 6, 7, 8, 9
    rows = [
        (
            Product(1.0, (2, low_first), (0, zero)),
            Product(1.0, (3, low_second), (1, zero)),
            Product(-1.0, (zero, zero), (one, zero)),
        ),
        (Product(1.0, (4, zero), (0, zero)), Product(1.0, (5, zero), (1, zero))),
    ]
    system = quadratic_map(rows, unknowns=2, size=10)
    y = np.array([0.0, 0.0, 5.0, 7.0, 5.0, 7.0, 0.0, 1.0, -5.0 * tiny, -7.0 * tiny])
    factors = factorise(system.jacobian(y))
    assert np.array_equal(factors.preconditioner @ system.jacobian(y), np.eye(2))
    certificate = certify_alone(system, y, np.zeros_like(y))
    assert certificate.radius == np.inf


@pytest.mark.parametrize(("condition", "proven"), [(1e10, True), (1e14, False)])
def test_nothing_is_proven_where_the_sums_of_a_matrix_may_round_its_inverse_away(
    condition: float, proven: bool
) -> None:
    # |X| |A| = condition for the first two unknowns. The rounding that is allowed for sums of n = 48 terms,
    # gamma = (n + 2) eps, is 1.1e-14: z = gamma condition passes 1 at 9e13.
    n = 48
    matrix = np.eye(n)
    matrix[:2, :2] = 1.0
    matrix[1, 1] += 4.0 / condition
    certificate = certified(matrix, np.zeros(n), np.zeros(n), np.zeros(n * n + n))
    assert bool(np.isfinite(certificate.radius)) == proven
