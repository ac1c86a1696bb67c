"""Products of vectors in the last dimension."""

import numpy as np
import pytest

from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.numerics.vectors import cross, lengths


@pytest.mark.parametrize("shape", [(3,), (4, 3), (3, 3), (2, 3, 3)])
def test_a_vector_product_is_numpys(shape: tuple[int, ...]) -> None:
    random = np.random.default_rng(0)
    a, b = random.integers(-9, 9, shape).astype(float), random.integers(-9, 9, shape).astype(float)
    assert np.array_equal(cross(a, b), np.cross(a, b))


def test_lengths_are_of_the_last_dimension() -> None:
    assert lengths(np.array([[3.0, 4.0, 12.0], [0.0, -2.0, 0.0]])).tolist() == [13.0, 2.0]


def test_the_unit_of_rounding_is_the_most_that_is_lost_beside_one() -> None:
    assert 1.0 + EPS > 1.0
    assert 1.0 + UNIT_ROUNDOFF == 1.0
    assert 1.0 + UNIT_ROUNDOFF * (1.0 + EPS) == 1.0 + EPS
