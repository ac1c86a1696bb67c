"""The certificate by hand: of a parabola, and of matrices that rounding makes regular or singular.

Without one of its terms it lies: see tests/pointcoord/bounds/test_planted_faults.py.
"""

import numpy as np
import pytest

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import ball, certify
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map


def radius_alone(system: QuadraticMap, y: Array) -> float:
    """The certificate's radius of one pose of exact known coordinates, by its own inverse."""
    return float(certify(system, Enclosed.of(y[None]), factorise(system.jacobian(y))).radius[0])


@pytest.mark.parametrize("u", [1.01, 1.5, 3.0])
def test_the_balls_of_a_parabola_reach_to_its_two_branches(u: float) -> None:
    """u^2 = 1 has X = 1 / (2 u), omega = 1 / u and no defect, so that no estimate loses anything."""
    found = ball(np.array(abs(u**2 - 1.0) / (2.0 * u)), np.array(0.0), np.array(1.0 / u))
    assert (found.radius, found.outer) == pytest.approx((abs(u - 1.0), u + 1.0), rel=1e-5)


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
    assert radius_alone(system, y) == np.inf


@pytest.mark.parametrize(("condition", "proven"), [(1e10, True), (1e14, False)])
def test_nothing_is_proven_where_the_sums_of_a_matrix_may_round_its_inverse_away(
    condition: float, proven: bool
) -> None:
    # A u = 0 with known A: y = (u, A by rows, 0). |X| |A| = condition for the first two unknowns. The
    # rounding that is allowed for sums of n = 48 terms, gamma = (n + 2) eps, is 1.1e-14: z = gamma condition
    # passes 1 at 9e13.
    n = 48
    zero = n + n * n
    system = quadratic_map(
        [[Product(1.0, (n + n * i + j, zero), (j, zero)) for j in range(n)] for i in range(n)], n, zero + 1
    )
    matrix = np.eye(n)
    matrix[:2, :2] = 1.0
    matrix[1, 1] += 4.0 / condition
    radius = radius_alone(system, np.concatenate([np.zeros(n), matrix.ravel(), [0.0]]))
    assert bool(np.isfinite(radius)) == proven
