"""The laws that drive coordinates, and the vector product, in numbers known by hand."""

import math

import numpy as np
import pytest

from absolute.laws import LAWS
from absolute.vectors import cross


@pytest.mark.parametrize("shape", [(3,), (4, 3), (3, 3), (2, 3, 3)])
def test_a_vector_product_is_numpys(shape: tuple[int, ...]) -> None:
    random = np.random.default_rng(0)
    a, b = random.integers(-9, 9, shape).astype(float), random.integers(-9, 9, shape).astype(float)
    assert np.array_equal(cross(a, b), np.cross(a, b))


def test_a_linear_law_is_its_value() -> None:
    law = LAWS["linear"]
    assert law.expand(7.0) == (7.0, 1.0, 0.0)
    assert law.invert(7.0) == 7.0


def test_a_cosine_law_turns_through_all_derivatives_of_a_cosine() -> None:
    law = LAWS["cosine"]
    assert law.expand(0.5) == (math.cos(0.5), -math.sin(0.5), -math.cos(0.5))
    assert law.invert(math.cos(0.5)) == pytest.approx(0.5, abs=1e-15)
    # A drawn height may be a rounding longer than the arm.
    assert law.invert(1.0 + 1e-15) == 0.0
    assert law.invert(-1.0 - 1e-15) == math.pi
    assert law.invert(1.0) == 0.0
    assert law.invert(0.0) == math.pi / 2
