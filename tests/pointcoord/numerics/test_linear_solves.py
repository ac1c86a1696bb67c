"""Singular members of a batch, and large matrices of few entries."""

import numpy as np
import pytest

from pointcoord.numerics.few_entries import sparse_inverse
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.rounding import EPS

SINGULAR = {
    "equal rows": [[1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 1.0, 5.0]],
    "zero column": [[1.0, 0.0, 3.0], [4.0, 0.0, 1.0], [1.0, 0.0, 5.0]],
    "not a number": [[1.0, 2.0, 3.0], [np.nan, 1.0, 0.0], [0.0, 1.0, 5.0]],
    "equal up to rounding": [[1.0, 2.0, 3.0], [1.0 + EPS, 2.0, 3.0], [0.0, 1.0, 5.0]],
    "inverse above the largest number": [[1.0, 1e-310, 0.0], [1.0, 2e-310, 0.0], [0.0, 0.0, 1.0]],
}


@pytest.mark.parametrize("bad", SINGULAR.values(), ids=SINGULAR.keys())
def test_singular_member_of_a_batch_marks_only_itself(bad: list[list[float]]) -> None:
    matrices = np.random.default_rng(5).normal(size=(2, 2, 3, 3))
    matrices[1, 0] = bad
    factors = factorise(matrices)
    assert factors.singular.tolist() == [[False, False], [True, False]]
    for member in ((0, 0), (0, 1), (1, 1)):
        assert factors.condition[member] == factorise(matrices[member]).condition


N = 120


def hidden_triangle(rng: np.random.Generator, batch: tuple[int, ...] = ()) -> np.ndarray:
    """Well conditioned matrices with blocks of 1 to 4 rows on the diagonal, rows and columns shuffled."""
    matrix = np.zeros((*batch, N, N))
    low = 0
    while low < N:
        high = min(low + int(rng.integers(1, 5)), N)
        own = rng.uniform(-1.0, 1.0, (*batch, high - low, high - low)) + 3.0 * np.eye(high - low)
        matrix[..., low:high, low:high] = own * rng.choice([-1.0, 1.0], (high - low, 1))
        for row in range(low, high):
            places = rng.integers(0, low, 3) if low else []
            matrix[..., row, places] = rng.uniform(-0.3, 0.3, (*batch, len(places)))
        low = high
    return matrix[..., rng.permutation(N), :][..., rng.permutation(N)]


@pytest.mark.parametrize("batch", [(), (1,), (2, 3)])
def test_a_nearby_large_matrix_with_entries_of_its_own_is_solved_with_its_own_residual(
    batch: tuple[int, ...],
) -> None:
    rng = np.random.default_rng(7)
    matrix, right = hidden_triangle(rng, batch), rng.uniform(-1.0, 1.0, (*batch, N))
    change = 1e-9 * rng.uniform(-1.0, 1.0, matrix.shape) * (rng.uniform(0.0, 1.0, (N, N)) < 0.02)
    factors = factorise(matrix)
    assert factors.sparse is not None
    moved = factors.moved(matrix + change)
    for x, exact in ((factors.solve(right), matrix), (moved.solve(right), matrix + change)):
        wanted = np.linalg.solve(exact, right[..., None])[..., 0]
        # Rounding; of the moved one also z^2, z = |I - X A| <= 120 entries of 1e-9 times |X|, a few.
        allowed = (8 * EPS * factors.condition + 1e-13) * np.abs(wanted).max(axis=-1)
        assert (np.abs(x - wanted).max(axis=-1) <= allowed).all()


def test_a_small_a_full_and_a_singular_matrix_are_inverted_as_a_whole() -> None:
    rng = np.random.default_rng(6)
    dense = rng.uniform(-1.0, 1.0, (N, N))
    singular = hidden_triangle(rng)
    singular[3] = 0.0
    twice = hidden_triangle(rng)
    twice[3] = twice[4]
    for matrix in (np.eye(50), dense):
        assert sparse_inverse(matrix) is None
        assert not factorise(matrix).singular
    for matrix in (singular, twice):
        assert factorise(matrix).singular
