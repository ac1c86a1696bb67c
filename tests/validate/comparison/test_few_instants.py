"""Numbers of few instants are looked at together, and say what they say array by array."""

import numpy as np
import pytest

from validate.comparison import tolerance
from validate.comparison.tolerance import largest_numbers, level


@pytest.mark.parametrize("width", [(), (3,)])
def test_few_instants_together_have_the_largest_numbers_of_each_array(
    width: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    random = np.random.default_rng(7)
    numbers = [random.normal(size=(5, *width)) for _ in range(4)]
    numbers[1][2] = np.nan
    numbers[2][3] = -np.inf
    claims, condition = [np.abs(array) for array in numbers], np.linspace(1.0, 1e15, 5)
    together = largest_numbers(numbers, 5), level(claims, np.ones(5), condition)
    monkeypatch.setattr(tolerance, "FEW", 0)
    plainly = largest_numbers(numbers, 5), level(claims, np.ones(5), condition)
    for one, other in zip(together, plainly, strict=True):
        np.testing.assert_array_equal(one, other)
    finite = np.array([np.where(np.isfinite(a), np.abs(a), 0.0).reshape(5, -1).max(axis=1) for a in numbers])
    np.testing.assert_array_equal(together[0], finite.max(axis=0))


def test_a_quantity_without_numbers_has_none_that_is_large() -> None:
    assert largest_numbers([], 3).tolist() == [0.0, 0.0, 0.0]
