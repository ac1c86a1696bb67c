"""Series in several inputs: powers, products, bounds and sums, against polynomials and whole numbers."""

from __future__ import annotations

from math import prod

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from pointcoord.numerics import power_series
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers, products
from pointcoord.numerics.power_series import multiplied
from pointcoord.patches.evaluation import sum_one, sum_series, table_of_exponents
from pointcoord.patches.jet import Jet

Array = NDArray[np.float64]


@pytest.mark.parametrize("pairs_at_once", [1, 30])
@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_a_product_of_series_is_the_product_of_their_sums(
    monkeypatch: pytest.MonkeyPatch, inputs: int, pairs_at_once: int
) -> None:
    """By however many pairs at once; whole numbers, so that no sum is rounded."""
    generator = np.random.default_rng(inputs)
    own, doubled, pairs = powers(inputs, 3), powers(inputs, 6), products(inputs, 3, (0, 6), 0)
    left, right = generator.integers(-9, 10, (2, own.count, 5)).astype(float)
    monkeypatch.setattr(power_series, "PAIRS", pairs_at_once)
    found = np.zeros((doubled.count, 5))
    found[pairs.targets] = multiplied(left, right, pairs)
    s = generator.integers(-2, 3, (inputs, 30)).astype(float)
    factors, product = (monomials([s], order)[0] for order in (3, 6))
    assert np.array_equal(found.T @ product, (left.T @ factors) * (right.T @ factors))


@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_bounds_of_series_and_of_their_products_are_reached_in_the_corner(inputs: int) -> None:
    """Where no term is negative."""
    generator = np.random.default_rng(inputs)
    own, doubled = powers(inputs, 3), powers(inputs, 6)
    a, b = generator.integers(0, 10, (2, 4, own.count, 2)).astype(float)
    pairs = products(inputs, 3, (0, 6), 0)
    product = np.zeros((4, doubled.count, 2))
    found = multiplied(a.swapaxes(0, 1), b.swapaxes(0, 1), pairs)
    product[:, pairs.targets] = found.swapaxes(0, 1)
    for coefficients, every, jet in (
        (a, own, Jet.of(-a, own.exponents)),
        (product, doubled, Jet.of(a, own.exponents) * Jet.of(b, own.exponents)),
    ):
        k = every.exponents.astype(float)
        assert np.array_equal(jet.value, coefficients.sum(axis=1))
        for i in range(inputs):
            assert np.array_equal(jet.first[:, i], np.einsum("k,pkm->pm", k[:, i], coefficients))
            for j in range(inputs):
                twice = k[:, i] * (k[:, j] - float(i == j))
                assert np.array_equal(jet.second[:, i, j], np.einsum("k,pkm->pm", twice, coefficients))


@pytest.mark.parametrize("patches", [1, 3])
@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_sums_and_rates_of_many_poses_and_of_one_are_those_of_polynomials(inputs: int, patches: int) -> None:
    """Along s + s' t + s'' t^2 / 2, of each derivative only some numbers."""
    generator = np.random.default_rng(patches)
    every, order, count = powers(inputs, 3), 3, 700
    coefficients = generator.normal(size=(patches, every.count, 4))
    middle, half = generator.normal(size=(patches, inputs)), generator.uniform(1.0, 2.0, (patches, inputs))
    patch = generator.integers(0, patches, count)
    states = list(generator.normal(size=(3, count, inputs)))
    local = [(states[0] - middle[patch]) / half[patch], *(state / half[patch] for state in states[1:])]
    laws = [
        [Polynomial([s, v, 0.5 * a]) for s, v, a in zip(*rows, strict=True)]
        for rows in zip(*local, strict=True)
    ]
    parts = (slice(4), slice(1, 4), slice(2))
    many = sum_series([coefficients[..., part] for part in parts], (middle, half), order, patch, states)
    for n in range(0, count, 50):
        each = [
            prod((law**k for law, k in zip(laws[n], ks, strict=True)), start=Polynomial([1.0]))
            for ks in every.exponents.tolist()
        ]
        ready = table_of_exponents(coefficients[patch[n]], inputs, order)
        for d, part in enumerate(parts):
            wanted = np.array([p.deriv(d)(0.0) if d else p(0.0) for p in each]) @ coefficients[patch[n]]
            np.testing.assert_allclose(many[d][:, n], wanted[part], rtol=1e-12, atol=1e-12)
            for highest in range(d, 3):
                one = sum_one(*ready, [state[n].tolist() for state in local[: highest + 1]])
                np.testing.assert_allclose(one[d], wanted, rtol=1e-12, atol=1e-12)
