"""The quadratic map against its definition, in exact arithmetic.

Where the numbers are small integers every operation of the map is exact, so equalities need no tolerance.
"""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map

Array = NDArray[np.float64]
U = np.finfo(float).eps / 2
SIZE, UNKNOWNS = 9, 5
seeds = st.integers(0, 2**32 - 1)
plain = settings(deadline=None)


def random_map(rng: np.random.Generator, most_terms: int = 5) -> QuadraticMap:
    rows = []
    for _ in range(UNKNOWNS):
        ends = rng.integers(0, SIZE, size=(rng.integers(1, most_terms + 1), 4)).tolist()
        rows.append(
            tuple(
                Product(float(rng.choice([-2.0, -1.0, 0.5, 1.0, 4.0])), (a, b), (c, d)) for a, b, c, d in ends
            )
        )
    return quadratic_map(rows, UNKNOWNS, SIZE)


def integers(rng: np.random.Generator, *shape: int) -> Array:
    return rng.integers(-1000, 1000, size=(*shape, SIZE)).astype(float)


def exact_rows(system: QuadraticMap, y: list[Fraction]) -> list[Fraction]:
    """sum c (y_a - y_b)(y_c - y_d) from the definition."""
    return [
        sum(
            (
                Fraction(p.coefficient) * (y[p.left[0]] - y[p.left[1]]) * (y[p.right[0]] - y[p.right[1]])
                for p in row
            ),
            Fraction(0),
        )
        for row in system.rows
    ]


@plain
@given(seed=seeds)
def test_residual_is_the_definition_and_the_diagonal_of_the_polar_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, y = random_map(rng), integers(rng)
    exact = [float(value) for value in exact_rows(system, [Fraction(v) for v in y])]
    assert system.residual(y).tolist() == exact
    assert system.polar(y, y).tolist() == exact


@plain
@given(seed=seeds)
def test_jacobian_applied_to_a_step_is_twice_the_polar_form(seed: int) -> None:
    rng = np.random.default_rng(seed)
    system, (y, h) = random_map(rng), integers(rng, 2)
    h[UNKNOWNS:] = 0.0
    assert np.array_equal(system.jacobian(y) @ h[:UNKNOWNS], 2.0 * system.polar(y, h))
    # and the polar form is what is left of C(y + h) when C(y) and C(h) are taken away
    assert np.array_equal(
        2.0 * system.polar(y, h), system.residual(y + h) - system.residual(y) - system.residual(h)
    )


@plain
@given(seed=seeds, batch=st.lists(st.integers(1, 3), max_size=3).map(tuple))
def test_batches_of_any_shape_give_the_numbers_of_their_members(seed: int, batch: tuple[int, ...]) -> None:
    rng = np.random.default_rng(seed)
    system, y, h = random_map(rng), integers(rng, *batch), integers(rng, *batch)
    weights, inverse = np.abs(h[..., :UNKNOWNS]) + 1.0, integers(rng, *batch, UNKNOWNS)[..., :UNKNOWNS]
    whole = (
        system.residual(y),
        system.polar(y, h),
        system.jacobian(y),
        system.uncertainty(y, np.abs(h)),
        system.lipschitz(inverse, weights),
    )
    for member in np.ndindex(*batch):
        one = (
            system.residual(y[member]),
            system.polar(y[member], h[member]),
            system.jacobian(y[member]),
            system.uncertainty(y[member], np.abs(h[member])),
            system.lipschitz(inverse[member], weights[member]),
        )
        for number, (all_of_them, alone) in enumerate(zip(whole, one, strict=True)):
            # Integers are exact; the rounding in the uncertainty (3) and the division by the weights in
            # the Lipschitz constant (4) may differ by the order of a sum: 32 terms at most.
            rounding = 32 * U if number in (3, 4) else 0.0
            assert np.allclose(all_of_them[member], alone, rtol=rounding, atol=0.0)


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
        true = [Fraction(v) + Fraction(d) * Fraction(s) for v, d, s in zip(y, data, share, strict=True)]
        computed, bound = system.residual(y), system.uncertainty(y, data)
        for value, limit, exact in zip(computed, bound, exact_rows(system, true), strict=True):
            # The bound itself is evaluated in fewer than 16 roundings.
            assert abs(Fraction(value) - exact) <= Fraction(limit) * (1 + Fraction(16 * U))


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


def test_row_without_terms_and_unknown_coordinate_are_refused() -> None:
    good = (Product(1.0, (0, 1), (2, 3)),)
    with pytest.raises(ValueError, match="row 1 has no terms"):
        quadratic_map([good, ()], 2, 4)
    for bad in ((0, 4), (-1, 0)):
        with pytest.raises(ValueError, match=r"row 0.*outside 0\.\.3"):
            quadratic_map([(Product(1.0, bad, (2, 3)),)], 2, 4)
    for coefficient in (3.0, 0.0, -0.75, float("nan")):
        with pytest.raises(ValueError, match=r"row 0.*no power of two"):
            quadratic_map([(Product(coefficient, (0, 1), (2, 3)),)], 2, 4)
