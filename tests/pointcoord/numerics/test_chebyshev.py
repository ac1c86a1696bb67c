"""Polynomials through Chebyshev's points, against numpy's own."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from pointcoord.numerics.chebyshev import binomials, interpolation, shares_beyond

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("degree", [2, 6, 8, 12])
def test_a_polynomial_comes_back_from_its_values(degree: int) -> None:
    matrices, rng = interpolation(degree), np.random.default_rng(degree)
    wanted = rng.normal(size=(5, degree + 1))
    values = chebyshev.chebval(matrices.points, wanted.T)
    found = matrices.chebyshev(values, np.zeros(degree + 1))
    assert np.abs(found - wanted).max() < 8 * degree * EPS
    for powers, law in zip(found @ matrices.powers, wanted, strict=True):
        np.testing.assert_allclose(powers, chebyshev.cheb2poly(law), rtol=0, atol=4.0**degree * EPS)
    slopes = chebyshev.chebval(matrices.points, chebyshev.chebder(wanted.T))
    assert np.abs(values @ matrices.slopes.T - slopes).max() < 8 * degree**3 * EPS


def test_values_taken_beside_the_points_are_corrected() -> None:
    matrices, rng = interpolation(8), np.random.default_rng(1)
    # Coefficients fall as in a cell, a hundredth for each order; what is left is the square of the way.
    wanted = rng.normal(size=9) * 100.0 ** -np.arange(9)
    moved = rng.uniform(-(2.0**-24), 2.0**-24, 9)
    values = chebyshev.chebval(matrices.points + moved, wanted)
    found = matrices.chebyshev(values, moved)
    assert np.abs(found - wanted).max() < 8 * EPS
    assert np.abs(matrices.chebyshev(values, 0.0 * moved) - wanted).max() > 1e-11


def test_what_powers_have_beyond_a_degree_is_what_numpy_says() -> None:
    for degree in (4, 8):
        shares = shares_beyond(degree, 41)
        for order in range(41):
            law = chebyshev.poly2cheb(np.eye(41)[order])
            assert shares[order] == pytest.approx(np.abs(law[degree + 1 :]).sum(), rel=1e-12)
    # (1 + x)^j has them as coefficients.
    for j, row in enumerate(binomials(41)):
        np.testing.assert_allclose(row[: j + 1], np.polynomial.polynomial.polypow([1.0, 1.0], j), rtol=1e-13)
        assert not row[j + 1 :].any()
