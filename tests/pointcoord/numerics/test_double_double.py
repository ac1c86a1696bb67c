"""Sums and products in twice the working precision, against rational arithmetic."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pointcoord.numerics.double_double import (
    pair_cross,
    pair_product,
    pair_sum,
    two_product,
    two_sum,
)

U = Fraction(1, 2**53)
numbers = st.floats(-1e100, 1e100, allow_nan=False, allow_subnormal=False).filter(
    lambda x: x == 0.0 or abs(x) > 1e-100
)


@given(a=numbers, b=numbers)
def test_high_and_low_are_exactly_the_sum_and_the_product(a: float, b: float) -> None:
    for pair, exact in (
        (two_sum(np.array(a), np.array(b)), Fraction(a) + Fraction(b)),
        (two_product(np.array(a), np.array(b)), Fraction(a) * Fraction(b)),
    ):
        assert Fraction(float(pair[0])) + Fraction(float(pair[1])) == exact


@given(seed=st.integers(0, 2**32 - 1))
def test_sums_and_products_of_pairs_keep_twice_the_digits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    high = rng.normal(size=(2, 3))
    low = float(U) * high * rng.uniform(-1.0, 1.0, size=high.shape)
    a, b = ((high[i], low[i]) for i in (0, 1))
    x, y = (
        [Fraction(p) + Fraction(q) for p, q in zip(*(part.tolist() for part in pair), strict=True)]
        for pair in (a, b)
    )
    sums, products = pair_sum(a, b), pair_product(a, b)
    cross = pair_cross(a, b)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        size = abs(x[j] * y[k]) + abs(x[k] * y[j])
        for pair, exact, largest in (
            (sums, x[i] + y[i], abs(x[i]) + abs(y[i])),
            (products, x[i] * y[i], abs(x[i] * y[i])),
            (cross, x[j] * y[k] - x[k] * y[j], size),
        ):
            # Some twenty roundings of low parts, each below u of them.
            assert (
                abs(Fraction(float(pair[0][i])) + Fraction(float(pair[1][i])) - exact) <= 20 * U**2 * largest
            )
