"""The quadratic map against its definition, in exact arithmetic, and parts of it.

Where the numbers are small integers every operation of the map is exact, so equalities need no tolerance.
"""

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_digits import fractions

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map

U = np.finfo(float).eps / 2
SIZE, UNKNOWNS = 9, 5
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


def random_map(rng: np.random.Generator, unknowns: int = UNKNOWNS) -> QuadraticMap:
    """Rows of one to five products of differences, some products in more than one row."""
    size = unknowns + SIZE - UNKNOWNS
    ends, rows = rng.integers(0, size, (unknowns, 4)).tolist(), []
    for _ in range(unknowns):
        chosen = rng.integers(0, unknowns, rng.integers(1, 6))
        coefficients = rng.choice([-2.0, -1.0, 0.5, 1.0, 4.0], len(chosen)).tolist()
        rows.append(
            tuple(
                Product(c, (ends[i][0], ends[i][1]), (ends[i][2], ends[i][3]))
                for c, i in zip(coefficients, chosen, strict=True)
            )
        )
    return quadratic_map(rows, unknowns, size)


def integers(rng: np.random.Generator, *shape: int) -> Array:
    return rng.integers(-1000, 1000, size=(*shape, SIZE)).astype(float)


def exact_rows(system: QuadraticMap, y: Any) -> Any:
    """sum c (y_a - y_b)(y_c - y_d) from the definition."""
    terms = (
        [
            Fraction(p.coefficient) * (y[p.left[0]] - y[p.left[1]]) * (y[p.right[0]] - y[p.right[1]])
            for p in row
        ]
        for row in system.rows
    )
    return np.array([sum(row) for row in terms], dtype=object)


@plain
@given(seed=seeds, doubt=st.sampled_from([0.0, 2.0**-60, 2.0**-45, 2.0**-10]))
def test_uncertainty_bounds_the_error_of_the_residual_against_exact_arithmetic(
    seed: int, doubt: float
) -> None:
    rng = np.random.default_rng(seed)
    system = random_map(rng)
    # Close pairs far from zero, where differences cancel, and numbers of very different size.
    y = np.where(rng.random(SIZE) < 0.5, 1.0 + rng.normal(size=SIZE) * 1e-8, rng.normal(size=SIZE) * 100.0)
    data = doubt * rng.integers(0, 3, size=SIZE)
    for share in (rng.choice([-1.0, 1.0], size=SIZE), rng.integers(-4, 5, size=SIZE) / 4.0):
        exact = exact_rows(system, fractions(y) + fractions(data) * fractions(share))
        # The bound itself is evaluated in fewer than 16 roundings.
        limit = fractions(system.uncertainty(y, data)) * (1 + Fraction(16 * U))
        assert (np.abs(fractions(system.residual(y)) - exact) <= limit).all()


@plain
@given(seed=seeds)
def test_the_jacobian_moves_by_its_uncertainty_at_most_and_at_a_corner(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, y, data = random_map(rng), integers(rng, 4), np.abs(integers(rng, 4))
    bound = system.jacobian_uncertainty(data)
    for _ in range(5):
        moved = y + data * rng.integers(-1, 2, y.shape)
        assert (np.abs(system.jacobian(moved) - system.jacobian(y)) <= bound).all()
    # Of one product of four coordinates both differences move by two coordinates' worth.
    a, b, c, d = rng.permutation(SIZE)[:4].tolist()
    one = quadratic_map([(Product(-4.0, (a, b), (c, d)),)], UNKNOWNS, SIZE)
    corner = y.copy()
    corner[:, [a, c]] += data[:, [a, c]]
    corner[:, [b, d]] -= data[:, [b, d]]
    change = np.abs(one.jacobian(corner) - one.jacobian(y))
    assert np.array_equal(change, one.jacobian_uncertainty(data))


@pytest.mark.parametrize("unknowns", [6, 104])
@pytest.mark.parametrize("seed", range(4))
def test_the_lipschitz_constant_is_the_sum_over_all_pairs_of_unknowns(unknowns: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    system = random_map(rng, unknowns)
    inverse = rng.uniform(-1.0, 1.0, (2, unknowns, unknowns))
    weights = rng.uniform(0.1, 2.0, (3, 2, unknowns))
    # By the definition: the Jacobian's derivative by each unknown, from the polar form of unit vectors.
    units = np.eye(unknowns, system.size)
    curvature = np.array([2.0 * system.polar(units, unit) for unit in units])  # (k, j, rows)
    found = system.lipschitz(inverse, weights)
    for one, member in product(range(3), range(2)):
        g = weights[one, member]
        bent = np.abs(curvature @ inverse[member].T)  # (k, j, i)
        wanted = (np.einsum("kji,j,k->i", bent, g, g) / g).max()
        assert found[one, member] == pytest.approx(wanted, rel=1e-12)
        assert system.lipschitz(inverse[member], g) == pytest.approx(wanted, rel=1e-12)
    plain = np.abs(np.einsum("kjr,mir->mkji", curvature, inverse)).sum(axis=(1, 2)).max(axis=-1)
    assert system.lipschitz(inverse) == pytest.approx(plain, rel=1e-12)
    assert system.lipschitz(inverse[0]) == pytest.approx(plain[0], rel=1e-12)
