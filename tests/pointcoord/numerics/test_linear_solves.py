"""One factorisation: accuracy, scaling, and batches in which some members are singular."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.numerics.linear import (
    factorise,
    null_directions,
    smallest_left_singular_vector,
)

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


def graded(rng: np.random.Generator, n: int, condition: float) -> Array:
    """A matrix with singular values spread over a range, columns and rows in no special place."""
    q, r = (np.linalg.qr(rng.normal(size=(n, n)))[0] for _ in range(2))
    return q @ np.diag(np.geomspace(1.0, 1.0 / condition, n)) @ r


@plain
@given(seed=seeds, n=st.integers(1, 17), power=st.integers(0, 12))
def test_solution_has_the_accuracy_of_an_lu_solve(seed: int, n: int, power: int) -> None:
    rng = np.random.default_rng(seed)
    # Entries on a grid of 2^-30 and small whole numbers as solution: the right-hand side is exact.
    matrix = np.round(graded(rng, n, 10.0**power) * 2**30) / 2**30
    x = rng.integers(-8, 9, size=n).astype(float)
    factors = factorise(matrix)
    if factors.singular or factors.condition > 1e13:
        return
    # LU with partial pivoting: error below 3 n eps times the condition number (Higham, theorem 9.4, with
    # the growth factor of about n seen in practice taken into the margin of the bound).
    error = np.abs(factors.solve(matrix @ x) - x).max()
    assert error <= 3 * n * EPS * float(factors.condition) * max(np.abs(x).max(), 1.0)


def test_condition_number_is_that_of_the_maximum_norm() -> None:
    matrix = np.array([[1.0, 1.0], [1.0, 0.75]])
    inverse = np.array([[-3.0, 4.0], [4.0, -4.0]])
    assert np.array_equal(factorise(matrix).inverse, inverse)
    assert factorise(matrix).condition == 2.0 * 8.0


SINGULAR = {
    "equal rows": np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 1.0, 5.0]]),
    "zero row": np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0], [0.0, 1.0, 5.0]]),
    "zero column": np.array([[1.0, 0.0, 3.0], [4.0, 0.0, 1.0], [1.0, 0.0, 5.0]]),
    "zero matrix": np.zeros((3, 3)),
    "not a number": np.array([[1.0, 2.0, 3.0], [np.nan, 1.0, 0.0], [0.0, 1.0, 5.0]]),
    "infinite": np.array([[1.0, 2.0, 3.0], [np.inf, 1.0, 0.0], [0.0, 1.0, 5.0]]),
    "equal up to rounding": np.array([[1.0, 2.0, 3.0], [1.0 + EPS, 2.0, 3.0], [0.0, 1.0, 5.0]]),
    "inverse above the largest number": np.array([[1.0, 1e-310, 0.0], [1.0, 2e-310, 0.0], [0.0, 0.0, 1.0]]),
}


@pytest.mark.parametrize("bad", SINGULAR.values(), ids=SINGULAR.keys())
def test_singular_member_of_a_batch_marks_only_itself(bad: Array) -> None:
    rng = np.random.default_rng(5)
    good = rng.normal(size=(2, 2, 3, 3))
    good[1, 0] = bad
    right = rng.normal(size=(2, 2, 3))
    factors = factorise(good)
    assert factors.singular.tolist() == [[False, False], [True, False]]
    with np.errstate(all="ignore"):  # the marked member's own solution may be anything
        x = factors.solve(right)
    for member in ((0, 0), (0, 1), (1, 1)):
        alone = factorise(good[member])
        assert factors.condition[member] == alone.condition
        assert np.array_equal(x[member], alone.solve(right[member]))


@plain
@given(seed=seeds, rows=st.integers(1, 6), columns=st.integers(1, 6), rank=st.integers(0, 6))
def test_null_directions_span_the_null_spaces(seed: int, rows: int, columns: int, rank: int) -> None:
    rank = min(rank, rows, columns)
    rng = np.random.default_rng(seed)
    # Products of small whole numbers are exact, so the rank is not larger than wanted.
    matrix = (rng.integers(-4, 5, (rows, rank)) @ rng.integers(-4, 5, (rank, columns))).astype(float)
    true_rank = int(np.linalg.matrix_rank(matrix)) if rank else 0
    free, redundant = null_directions(matrix)
    assert free.shape == (columns - true_rank, columns)
    assert redundant.shape == (rows - true_rank, rows)
    # LAPACK's bound on its own error: a few times max(m, n) eps of the largest singular value.
    limit = 8 * 6 * EPS
    size = max(np.linalg.norm(matrix), 1.0)
    for vectors, product in ((free, matrix @ free.T), (redundant, redundant @ matrix)):
        assert np.abs(vectors @ vectors.T - np.eye(len(vectors))).max(initial=0.0) <= limit
        assert np.abs(product).max(initial=0.0) <= limit * size


@plain
@given(seed=seeds, n=st.integers(2, 8))
def test_weakest_balance_of_rows_is_shortened_the_most(seed: int, n: int) -> None:
    rng = np.random.default_rng(seed)
    matrix = graded(rng, n, 1e6)
    balance = smallest_left_singular_vector(matrix)
    # The smallest stretch is 1e-6; rounding of the product is n eps.
    assert abs(np.linalg.norm(balance) - 1.0) <= 4 * n * EPS
    assert np.linalg.norm(balance @ matrix) <= 1e-6 + 16 * n * EPS
