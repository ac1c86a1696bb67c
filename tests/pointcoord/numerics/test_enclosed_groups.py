"""Numbers of neighbouring instants: what every operation says of them holds of rational numbers."""

from fractions import Fraction

import mpmath
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.numerics.enclosed_groups import EnclosedGroups
from pointcoord.numerics.enclosure import Enclosed, cross, dot, quotient
from pointcoord.numerics.rounding import UNIT_ROUNDOFF as U

Array = NDArray[np.float64]
Exact = NDArray[np.object_]
GROUPS, COUNT = 3, 5
seeds = st.integers(0, 2**32 - 1)
some = settings(deadline=None, max_examples=60)
fraction = np.vectorize(Fraction, otypes=[object])


def numbers(rng: np.random.Generator, *shape: int, near: float = 0.0) -> tuple[EnclosedGroups, Exact]:
    """Groups of numbers, and for each instant an exact one that lies somewhere within the radius."""
    near = near or 10.0 ** rng.uniform(-8.0, 0.0)
    high = rng.normal(size=(GROUPS, 1, *shape))
    change = near * rng.normal(size=(GROUPS, COUNT, *shape))
    radius = U * near * rng.uniform(size=(GROUPS, 1, *shape))
    anchor = Enclosed.of(high, U * rng.uniform(-0.5, 0.5, size=high.shape), radius, radius)
    groups = EnclosedGroups.around(anchor, change)
    off = fraction(radius * rng.uniform(-1.0, 1.0, size=change.shape))
    return groups, middle(groups) + off


def middle(groups: Enclosed) -> Exact:
    assert isinstance(groups, EnclosedGroups)
    return fraction(groups.high) + fraction(groups.low) + fraction(groups.change)


def holds(found: Enclosed, exact: Exact, rounding: float) -> None:
    """The exact numbers lie within the radius, which is no more than it has to be, and within its reach."""
    assert isinstance(found, EnclosedGroups)
    off = np.abs(middle(found) - exact)
    assert (off <= fraction(np.broadcast_to(found.radius[0], off.shape))).all()
    assert (np.abs(found.change) <= found.reach).all()
    # What a number is given with, and some roundings of how far the instants lie apart.
    assert found.radius[0].max() <= rounding


def largest(*groups: Enclosed) -> float:
    return max(float(each.reach.max()) for each in groups if isinstance(each, EnclosedGroups))


def test_a_change_loses_a_rounding_of_itself() -> None:
    rng = np.random.default_rng(2)
    first = rng.normal(size=(GROUPS, 1, 3))
    exact = fraction(first) + fraction(1e-3 * rng.normal(size=(GROUPS, COUNT, 3)))
    change = (exact - fraction(first)).astype(float)
    found = EnclosedGroups.around(Enclosed.of(first), change)
    for radius in found.radius:
        # It is found again to a rounding of the largest change, and no more than that is said.
        assert (np.abs(middle(found) - exact) <= fraction(radius)).all()
        assert radius.max() <= 1.1 * U * np.abs(change).max()


@some
@given(seed=seeds)
def test_sums_and_products_enclose_those_of_every_number_within(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (a, x), (b, y) = numbers(rng, 3), numbers(rng, 3)
    near = 400.0 * U * largest(a, b) * (1.0 + largest(a, b)) + 1e-28
    for found, exact in ((a + b, x + y), (a - b, x - y), (a * b, x * y), (-a, -x), (a * a, x * x)):
        holds(found, exact, near)
    powers = np.array([0.25, 2.0, 1024.0])[:, None, None]
    holds(a.scaled(powers), x * fraction(powers), 1024.0 * near)


@some
@given(seed=seeds)
def test_a_number_that_is_one_for_all_instants_stands_on_either_side(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, x = numbers(rng, 3)
    own = rng.normal(size=3)
    one, y = Enclosed.of(own), fraction(own)
    near = 400.0 * U * largest(a) + 1e-28
    pairs = ((a + one, x + y), (one + a, x + y), (a - one, x - y), (one - a, y - x))
    for found, exact in (*pairs, (a * one, x * y), (one * a, x * y)):
        holds(found, exact, near)


@some
@given(seed=seeds)
def test_products_of_vectors_enclose_those_of_every_number_within(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (a, x), (b, y) = numbers(rng, 3), numbers(rng, 3)
    near = 3000.0 * U * largest(a, b) * (1.0 + largest(a, b)) + 1e-28
    holds(dot(a, b), (x * y).sum(axis=-1), near)
    turned = [x[..., j] * y[..., k] - x[..., k] * y[..., j] for j, k in ((1, 2), (2, 0), (0, 1))]
    holds(cross(a, b), np.stack(turned, axis=-1), near)
    holds(dot(a, b).spread_out * a, (x * y).sum(axis=-1)[..., None] * x, 3.0 * near)


@some
@given(seed=seeds)
def test_cosines_and_sines_enclose_those_of_every_angle_within(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle, exact = numbers(rng, near=10.0 ** rng.uniform(-8.0, -1.5))
    with mpmath.workdps(50):
        for found, function in zip(angle.cosine_sine(), (mpmath.cos, mpmath.sin), strict=True):
            values = [function(mpmath.mpf(x.numerator) / x.denominator) for x in exact.ravel()]
            digits = [Fraction(int(mpmath.nint(value * 10**45)), 10**45) for value in values]
            holds(found, np.array(digits).reshape(exact.shape), 40.0 * U * largest(angle) + 1e-27)


def test_a_group_that_turns_too_far_is_not_bounded() -> None:
    angle = EnclosedGroups.around(Enclosed.of(np.zeros((1, 1))), np.array([[0.0, 0.6]]))
    assert np.isinf(angle.cosine_sine()[0].radius[0]).all()


@some
@given(seed=seeds)
def test_a_quotient_of_small_numbers_encloses_that_of_every_number_within(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (a, x), (b, y) = numbers(rng, near=1e-3), numbers(rng, near=1e-3)
    small, divisor = a.scaled(2.0**-40), b * b + Enclosed.of(0.1)
    exact = x / 2**40 / (y * y + fraction(0.1))
    holds(quotient(small, divisor), exact, 1e-9 * U)


@some
@given(seed=seeds)
def test_the_distance_of_a_reported_number_is_no_less_than_that_of_any_number_within(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, x = numbers(rng, 3)
    reported = x.astype(float) * (1.0 + 10.0 ** rng.uniform(-16.0, -9.0))
    proven, expected = a.errors(reported)
    off = np.abs(fraction(reported) - x)
    assert (off <= fraction(proven)).all()
    assert (proven <= off.astype(float) * (1.0 + 1e-9) + 30.0 * U * largest(a) + 1e-30).all()
    assert (expected == a.radius[1]).all()


@some
@given(seed=seeds)
def test_other_numbers_of_the_instants_are_enclosed_with_what_they_are_off(seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, x = numbers(rng, 3, near=1e-4)
    values = rng.normal(size=(GROUPS, 1, 3)) + 1e-4 * rng.normal(size=(GROUPS, COUNT, 3))
    holds(a.like(values), fraction(values), 10.0 * U * 1e-3)
    off = a.scaled(2.0**-30)
    holds(a.corrected(values, off), fraction(values) + x / 2**30, 10.0 * U * 1e-3)


@some
@given(seed=seeds)
def test_numbers_of_instants_are_enclosed_also_where_they_lie_next_to_a_tie(seed: int) -> None:
    # From 1 + 0.9 u to 1 + 1.1 u the high part goes up by 2 u, and the low one back by nearly as much.
    rng = np.random.default_rng(seed)
    up = rng.integers(0, 2, size=GROUPS * COUNT)
    high, low = 1.0 + 2.0 * U * up, U * (0.9 - 1.8 * up) + 0.1 * U * rng.uniform(-1.0, 1.0, size=up.shape)
    low[rng.integers(0, 2, size=up.shape) == 0] *= 1.0 - 1e-3
    exact = (fraction(high) + fraction(low)).reshape(GROUPS, COUNT)
    found = EnclosedGroups.of_instants(Enclosed(high, low, np.zeros((2, *high.shape))), (GROUPS, COUNT))
    holds(found, exact, 20.0 * U**2)


@some
@given(seed=seeds)
def test_vectors_are_taken_apart_and_keep_their_numbers(seed: int) -> None:
    a, x = numbers(np.random.default_rng(seed), 5)
    for places in ([1, 2, 3], [4, 0, 2]):
        holds(a.take(places), x[..., places], 1.0)
    holds(a.component(3), x[..., 3], 1.0)


def test_numbers_that_are_enclosed_one_by_one_are_enclosed_in_groups() -> None:
    rng = np.random.default_rng(4)
    high = 1.0 + 1e-3 * rng.normal(size=GROUPS * COUNT)
    single = Enclosed.of(high, 0.4 * U * rng.normal(size=high.shape), U**2)
    exact = (fraction(single.high) + fraction(single.low)).reshape(GROUPS, COUNT)
    holds(EnclosedGroups.of_instants(single, (GROUPS, COUNT)), exact, 20.0 * U * 1e-2)
    one = EnclosedGroups.of_one(Enclosed.of(0.5, 1e-20), (GROUPS, COUNT))
    holds(one, np.full((GROUPS, COUNT), Fraction(0.5) + Fraction(1e-20)), 1e-28)
