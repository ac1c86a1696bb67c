"""Vectors and derivatives of the reference, held to what is known of whole numbers."""

from collections.abc import Callable
from fractions import Fraction
from itertools import permutations, product

import numpy as np
import pytest
from flint import arb

from validate.reference.dual import Dual, slope_of, value_of
from validate.reference.vectors import Vector, cross, dot, minus, plus, squares, times

ONES: tuple[Vector, ...] = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
A, B = (2, -3, 5), (7, 11, -13)


def test_products_of_the_directions_of_space() -> None:
    for i, j in product(range(3), repeat=2):
        assert dot(ONES[i], ONES[j]) == (i == j)
    for i, j, k in permutations(range(3)):
        sign = 1 if (i, j, k) in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1
        assert cross(ONES[i], ONES[j]) == times(ONES[k], sign)
        assert cross(ONES[i], ONES[i]) == (0, 0, 0)


def test_sums_and_products_of_vectors_are_numpys() -> None:
    a, b = np.array(A), np.array(B)
    assert plus(A, B) == tuple(a + b)
    assert minus(A, B) == tuple(a - b)
    assert times(A, 4) == tuple(4 * a)
    assert dot(A, B) == a @ b
    assert cross(A, B) == tuple(np.cross(a, b))
    assert squares(A) == a @ a
    assert squares(A, B) == (a @ a) * (b @ b)
    assert squares(A, B, A) == (a @ a) ** 2 * (b @ b)


X, Y, DX, DY = (Fraction(n) for n in (3, 4, 5, -7))


@pytest.mark.parametrize(
    ("of", "value", "by_x", "by_y"),
    [
        (lambda x, y: x + y, X + Y, 1, 1),
        (lambda x, y: x - y, X - Y, 1, -1),
        (lambda x, y: x * y, X * Y, Y, X),
        (lambda x, y: x / y, X / Y, 1 / Y, -X / Y**2),
    ],
)
def test_a_dual_follows_the_rules_of_differentiation(
    of: Callable[..., Dual], value: Fraction, by_x: Fraction, by_y: Fraction
) -> None:
    x, y = Dual(X, DX), Dual(Y, DY)
    assert of(x, y) == Dual(value, by_x * DX + by_y * DY)
    assert of(x, Y) == Dual(value, by_x * DX)
    assert of(X, y) == Dual(value, by_y * DY)


def test_a_number_does_not_depend_on_the_parameter() -> None:
    assert Dual(X) == Dual(X, Fraction(0))
    assert -Dual(X, DX) == Dual(-X, -DX)
    assert (value_of(Dual(X, DX)), slope_of(Dual(X, DX))) == (X, DX)
    assert (value_of(X), slope_of(X)) == (X, 0)


def test_sine_and_cosine_turn_into_each_other() -> None:
    sine, cosine = Dual(arb(1) / 2, arb(3)).sin_cos()
    assert sine.value.overlaps((arb(1) / 2).sin())
    assert cosine.value.overlaps((arb(1) / 2).cos())
    assert sine.slope.overlaps(3 * (arb(1) / 2).cos())
    assert cosine.slope.overlaps(-3 * (arb(1) / 2).sin())


def test_a_root_changes_by_half_its_share() -> None:
    root = Dual(arb(9), arb(5)).sqrt()
    assert root.value == 3
    assert root.slope.overlaps(arb(5) / 6)


def test_arrays_leave_sums_and_products_to_the_dual() -> None:
    array = np.array([1.0, 2.0])
    assert isinstance(array * Dual(X, DX), Dual)
    assert isinstance(array - Dual(X, DX), Dual)
