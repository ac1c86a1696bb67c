"""Where laws of inputs stay over a span, and where they change.

Their values and rates are held to exact ones in tests/pointcoord/numerics/test_enclosures.py.
"""

import warnings
from math import factorial

import numpy as np
import pytest

from pointcoord.numerics.infinitesimal import slope_of, with_slope
from pointcoord.time_functions import Polynomial, Sine, Sum, Table, TimeFunction, cosine_and_sine

EPS = np.finfo(float).eps


@pytest.mark.parametrize("size", [1e306, 1e308, -1e308])
def test_a_huge_law_is_summed_plainly_and_warns_of_nothing(size: float) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        value, rate, _ = Polynomial((1.0, size, size)).series(0.2, 2).tolist()
    # Three roundings of a sum of like signs.
    assert abs(value / (0.24 * size) - 1.0) <= 4 * EPS
    assert abs(rate / (1.4 * size) - 1.0) <= 4 * EPS or np.isinf(rate)


SPANS: list[tuple[TimeFunction, float]] = [
    (Polynomial((1.0, 2.0, -3.0, 0.5)), 6.0 + 3.0),
    (Polynomial((1.5,)), 0.0),
    (Sine(0.3, 7.0, 0.2, 1.5), 0.3 * 49.0),
    (Sine(-0.3, 40.0, 3.0, -1.0), 0.3 * 1600.0),
    (Table((0.0, 1.0, 2.0, 3.0), (0.0, 1.0, 8.0, 27.0)), 18.0),  # t^3
    # Of terms that go the same way: else each may be at its own end.
    (Sum((Polynomial((1.0, 2.0)), Table((0.0, 1.0, 2.0, 3.0), (0.0, 1.0, 8.0, 27.0)))), 18.0),
]


@pytest.mark.parametrize(("law", "bend"), SPANS, ids=lambda case: type(case).__name__)
def test_over_a_span_a_law_stays_where_it_says_and_hardly_less(law: TimeFunction, bend: float) -> None:
    """Beyond the values it takes there it says at most what its second derivative allows."""
    edges = np.linspace(0.0, 1.0, 33)
    first, last = edges[:-1], edges[1:]
    low, high = law.values_over(first, last)
    values = law.series(first[:, None] + (last - first)[:, None] * np.linspace(0.0, 1.0, 65), 0)[..., 0]
    assert (values >= low[:, None]).all()
    assert (values <= high[:, None]).all()
    # A slope about the middle changes by bend h / 2 to either end, so that the ends are too far out by
    # bend h^2 / 4 at most, and between samples a value may be missed by bend (h / 64)^2 / 8.
    spare = bend * (edges[1] - edges[0]) ** 2 * (0.25 + 0.01) + 1e-13
    assert (high - values.max(axis=1) <= spare).all()
    assert (values.min(axis=1) - low <= spare).all()
    middle = 0.5 * (first + last)
    low, high = law.values_over(middle, middle)
    at_once = law.series(middle, 0)[:, 0]
    assert (low <= at_once).all()
    assert (at_once <= high).all()
    assert (high - low <= 1e-12).all()


RISING = Table((0.0, 1.0, 2.0, 3.0), (2.0, 2.0, 2.0, 2.5))


@pytest.mark.parametrize(
    ("law", "still"),
    [
        (Polynomial((3.0, 0.0, 0.0)), True),
        (Polynomial((3.0, 0.0, 1e-300)), False),
        (Sine(0.0, 5.0, 1.0, 2.0), True),
        (Sine(2.0, 0.0, 1.0, 2.0), True),
        (Sine(1e-300, 5.0), False),
        (Table((0.0, 1.0, 2.0, 3.0), (2.0, 2.0, 2.0, 2.0)), True),
        (RISING, False),
        (Sum((Polynomial((1.0,)), Polynomial((2.0,)))), True),
        (Sum((Polynomial((1.0,)), RISING)), False),
    ],
)
def test_a_law_stands_still_by_its_form(law: TimeFunction, still: bool) -> None:
    assert law.still is still
    if still:
        assert not law.series(np.linspace(0.0, 3.0, 31), 6)[:, 1:].any()


def test_a_sum_has_the_breaks_of_its_terms() -> None:
    assert Sum((Polynomial((1.0,)), RISING)).breaks == RISING.breaks


def test_over_more_than_a_turn_a_sine_reaches_both_its_crests_as_they_are_rounded() -> None:
    # One crest is at zero, where the value has no size of its own to be rounded by.
    for law in (Sine(0.3, 200.0, 0.0, -0.3), Sine(0.3, 200.0, 0.0, 0.3), Sine(-0.3, 200.0, 0.0, -0.3)):
        (low,), (high,) = law.values_over(np.array([0.0]), np.array([0.1]))
        near = np.concatenate([turn * np.pi / 200.0 + np.arange(-20, 21) * 1e-17 for turn in (0.5, 1.5)])
        values = law.series(near, 0)[:, 0]
        assert low < values.min() <= law.offset - 0.3 + 2.0**-53
        assert law.offset + 0.3 - 2.0**-53 <= values.max() < high
        # What is added is a few roundings of numbers below 1.
        assert values.min() - low <= 100 * EPS
        assert high - values.max() <= 100 * EPS


def test_the_series_of_a_cosine_and_a_sine_change_with_their_angle_in_closed_form() -> None:
    """Of a + b t, with slopes a' and b', the terms are b^k / k! cos(a + k pi / 2)."""
    a, b, by_a, by_b = 0.7, 1.3, np.array([[1.0], [0.0], [-2.0]]), np.array([[0.0], [1.0], [0.5]])
    k = np.arange(5)
    angle, slope = np.pad([a, b], (0, 3)), np.concatenate([by_a, by_b, np.zeros((3, 3))], axis=1)
    found = cosine_and_sine(with_slope(angle, slope))
    orders = np.array([factorial(i) for i in k])
    for series, start in zip(found, (a, a - np.pi / 2), strict=True):
        value, turned = np.cos(start + k * np.pi / 2), -np.sin(start + k * np.pi / 2)
        exact = (by_a * b**k * turned + by_b * k * b ** np.maximum(k - 1.0, 0.0) * value) / orders
        np.testing.assert_allclose(series.real[0], b**k * value / orders, rtol=0, atol=4 * EPS)
        np.testing.assert_allclose(slope_of(series), exact, rtol=0, atol=32 * EPS)
