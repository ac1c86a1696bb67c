"""Polynomials through Chebyshev's points, against numpy's own."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev

from pointcoord.numerics.chebyshev import interpolation

EPS = float(np.finfo(float).eps)


@pytest.mark.parametrize("degree", [2, 6, 8, 12])
def test_a_polynomial_comes_back_from_its_values(degree: int) -> None:
    matrices, rng = interpolation(degree), np.random.default_rng(degree)
    wanted = rng.normal(size=(5, degree + 1))
    values = chebyshev.chebval(matrices.points, wanted.T)
    found = matrices.chebyshev(values, np.zeros(degree + 1))
    assert np.abs(found - wanted).max() < 8 * degree * EPS
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
