"""One factorisation: accuracy, singular members of a batch, and large matrices by their blocks."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.numerics import block_inverse
from pointcoord.numerics.block_inverse import inverse_by_blocks
from pointcoord.numerics.linear import (
    factorise,
    null_directions,
)
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


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
    for vectors, none in ((free, matrix @ free.T), (redundant, redundant @ matrix)):
        assert np.abs(vectors @ vectors.T - np.eye(len(vectors))).max(initial=0.0) <= limit
        assert np.abs(none).max(initial=0.0) <= limit * size


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


def test_factors_by_blocks_say_what_others_do(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(5)
    matrix, right = hidden_triangle(rng, (3,)), rng.uniform(-1.0, 1.0, (3, N))
    by_blocks = factorise(matrix)
    monkeypatch.setattr(block_inverse, "LARGE", np.inf)
    plain = factorise(matrix)
    assert by_blocks.condition == pytest.approx(plain.condition, rel=1e-10)
    x = by_blocks.solve(right)
    # Of one member by itself the processor may add in another order.
    allowed = 8 * EPS * plain.condition.max() * np.abs(x).max()
    assert (np.abs(x - plain.solve(right)).max(axis=-1) <= 8 * EPS * plain.condition * np.abs(x).max()).all()
    # One of the matrices for several right sides.
    one, several = by_blocks.taken(np.array([0])).reshaped(()), rng.uniform(-1.0, 1.0, (4, N))
    for side, found in zip(several, one.solve(several), strict=True):
        assert np.abs(found - one.solve(side)).max() <= 8 * EPS * one.condition * np.abs(found).max()
    for some in (
        by_blocks.taken(np.array([2, 0])),
        by_blocks.reshaped((1, 3)).reshaped((3,)).taken(np.array([2, 0])),
    ):
        assert np.abs(some.solve(right[[2, 0]]) - x[[2, 0]]).max() <= allowed
    turned = factorise(matrix[[1]] * np.where(np.arange(N) == 7, -1.0, 1.0))
    replaced = by_blocks.replaced(np.array([1]), turned)
    assert np.array_equal(replaced.preconditioner[1], turned.preconditioner[0])
    assert np.array_equal(replaced.preconditioner[::2], by_blocks.preconditioner[::2])


@pytest.mark.parametrize("batch", [(), (1,), (2, 3)])
def test_by_blocks_a_nearby_matrix_with_entries_of_its_own_is_solved_with_its_own_residual(
    batch: tuple[int, ...],
) -> None:
    rng = np.random.default_rng(7)
    matrix, right = hidden_triangle(rng, batch), rng.uniform(-1.0, 1.0, (*batch, N))
    change = 1e-9 * rng.uniform(-1.0, 1.0, matrix.shape) * (rng.uniform(0.0, 1.0, (N, N)) < 0.02)
    factors = factorise(matrix)
    assert factors.substitution is not None
    moved = factors.moved(matrix + change)
    for x, exact in ((factors.solve(right), matrix), (moved.solve(right), matrix + change)):
        wanted = np.linalg.solve(exact, right[..., None])[..., 0]
        # Rounding; of the moved one also z^2, z = |I - X A| <= 120 entries of 1e-9 times |X|, a few.
        allowed = (8 * EPS * factors.condition + 1e-13) * np.abs(wanted).max(axis=-1)
        assert (np.abs(x - wanted).max(axis=-1) <= allowed).all()


def test_where_blocks_do_not_help_the_matrix_is_inverted_as_a_whole() -> None:
    rng = np.random.default_rng(6)
    circle = np.eye(N) + np.roll(np.eye(N), 1, axis=1) * 0.5
    dense = rng.uniform(-1.0, 1.0, (N, N))
    singular = hidden_triangle(rng)
    singular[3] = 0.0
    twice = hidden_triangle(rng)
    twice[3] = twice[4]
    for matrix in (np.eye(50), circle, dense):
        assert inverse_by_blocks(matrix) is None
        assert not factorise(matrix).singular
    for matrix in (singular, twice):
        assert factorise(matrix).singular


def random_map(rng: np.random.Generator, unknowns: int) -> QuadraticMap:
    """Rows of products of differences; unknowns in several rows, some products in more than one."""
    shared = [tuple(rng.integers(0, unknowns + 3, 4).tolist()) for _ in range(unknowns)]
    rows = []
    for _ in range(unknowns):
        chosen = rng.integers(0, len(shared), 3)
        coefficients = rng.choice([-2.0, -1.0, 1.0, 0.5], 3)
        rows.append(
            tuple(
                Product(float(c), shared[i][:2], shared[i][2:])
                for c, i in zip(coefficients, chosen, strict=True)
            )
        )
    return quadratic_map(rows, unknowns, unknowns + 3)


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
