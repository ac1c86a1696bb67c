"""Numbers in twice the working precision: the exact result lies within the proven radius, which is small."""

from collections.abc import Callable
from fractions import Fraction
from math import factorial
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_digits import fractions

from pointcoord.numerics.enclosure import Enclosed, anchored, angle, quotient, root
from pointcoord.scene.input_part import InputPart
from pointcoord.time_functions import Polynomial
from validate.formulations.input_rates import rates

U = 2.0**-53
WAVE = {"amplitude": 0.37, "angular_frequency": 5.3, "phase": 1.1}


def exact(number: Enclosed, part: float = 0.0) -> Any:
    """The numbers, each with a part of its proven radius."""
    high, low, change, radius = map(fractions, (number.high, number.low, number.change, number.radius[0]))
    return high + low + change + Fraction(part) * radius


ORDER = 12
REACHES = st.sampled_from([0.0, 2.0**-40, 0.01, 3.0])


def group(rng: np.random.Generator, reach: float, radius: float) -> Enclosed:
    """Numbers in five groups of four."""
    high = rng.uniform(0.5, 2.0, (5, 1))
    radii = np.abs(rng.uniform(0.0, radius, (2, 5, 1)))
    change = reach * rng.uniform(-1.0, 1.0, (5, 4))
    return Enclosed(high, U * high * rng.uniform(-1.0, 1.0, (5, 1)), radii, change, np.full((5, 1), reach))


ONE = Enclosed.of(1.7)
# By each operation on two groups, what it makes of two numbers.
OPERATIONS: dict[str, tuple[Callable[[Enclosed, Enclosed], Enclosed], Callable[[Any, Any], Any]]] = {
    "sum": (lambda a, b: a + b, lambda x, y: x + y),
    "difference": (lambda a, b: a - b, lambda x, y: x - y),
    "product": (lambda a, b: a * b, lambda x, y: x * y),
    "times one number": (lambda a, b: ONE * a, lambda x, y: mpmath.mpf(1.7) * x),
    "less one number": (lambda a, b: a - ONE, lambda x, y: x - mpmath.mpf(1.7)),
    "scaled": (lambda a, b: a.scaled(0.25), lambda x, y: x / 4),
    "quotient": (quotient, lambda x, y: x / y),
    "root": (lambda a, b: root(a * a), lambda x, y: abs(x)),
    "angle": (angle, mpmath.atan2),
    "cosine": (lambda a, b: a.cosine_sine()[0], lambda x, y: mpmath.cos(x)),
    "sine": (lambda a, b: a.cosine_sine()[1], lambda x, y: mpmath.sin(x)),
}


def in_digits(number: Enclosed, part: float = 0.0) -> list[Any]:
    return [mpmath.mpf(x.numerator) / x.denominator for x in exact(number, part).ravel()]


@settings(max_examples=max(30, settings.default.max_examples // 4))
@given(st.integers(0, 2**32 - 1), REACHES, REACHES, st.sampled_from([0.0, 1e-18, 0.1]))
def test_what_is_made_of_groups_lies_within_radii_that_they_share(
    seed: int, first: float, second: float, radius: float
) -> None:
    """Of numbers at the ends of their own radii; of exact numbers the radii are small."""
    rng = np.random.default_rng(seed)
    a, b = group(rng, first, radius), group(rng, second, radius)
    s, t = rng.choice([-1.0, 1.0], 2).tolist()
    with mpmath.workdps(50):
        x, y = in_digits(a, s), in_digits(b, t)
        for name, (operation, true) in OPERATIONS.items():
            made = operation(a, b)
            if not np.isfinite(made.radius[0]).all():
                assert name in ("quotient", "angle")
                continue
            radii = np.broadcast_to(made.radius[0], (5, 4)).ravel().tolist()
            for p, q, found, r in zip(x, y, in_digits(made), radii, strict=True):
                assert abs(true(p, q) - found) <= r * (1 + 1e-6), name
            assert (np.abs(made.change) <= made.reach * (1.0 + 4 * U)).all(), name
            if first == second == radius == 0.0:
                assert max(radii) <= (1e-28 if name in PRECISE else 1e-14), name


PRECISE = {*OPERATIONS} - {"quotient", "root", "angle"}


def test_what_rounds_changes_is_counted_and_no_more_than_that() -> None:
    """Of exact numbers that are put in groups the largest error is a good part of the radius."""
    rng, shares = np.random.default_rng(3), np.zeros((50, 2))
    for case in range(50):
        values = rng.uniform(0.5, 9.0, (5, 4))
        lone = Enclosed.of(values.ravel(), U * values.ravel() * rng.uniform(-1.0, 1.0, 20))
        grouped, true = lone.together(lambda x: x.reshape(5, 4)), exact(lone).reshape(5, 4)
        pairs = ((anchored(values, (5, 1)), fractions(values)), (grouped, true))
        for kind, (number, meant) in enumerate(pairs):
            off, radii = np.abs(exact(number) - meant), fractions(number.radius[0])
            assert (off <= radii).all()
            shares[case, kind] = (off / np.where(radii > 0, radii, 1)).max()
    assert (shares.max(axis=0) > 0.2).all()


def test_a_power_of_two_rounds_nothing_but_what_falls_below_the_normal_numbers() -> None:
    # Exact, with a low part, zero; each with a radius.
    numbers = Enclosed.of(np.array([0.7, 0.7, 0.0, 1.0]), np.array([0.0, 1e-20, 0.0, 0.0]), 2.0**-80)
    for factor in (0.25, 8.0):
        assert np.array_equal(numbers.scaled(factor).radius, factor * numbers.radius)
    for high, low in ((1.0 + U, 0.0), (0.7, 3.1e-20), (0.7, 0.0)):
        one, factor = Enclosed.of(high, low), 2.0**-1030
        lost = abs(exact(one.scaled(factor)) - exact(one) * Fraction(factor))
        assert lost <= one.scaled(factor).radius[0]


def test_a_quotient_is_bounded_beside_the_place_where_the_divisor_of_a_group_goes_through_zero() -> None:
    divisors = np.array([[-0.03, -0.01, 0.0, 0.01, 0.03]])
    found = quotient(Enclosed.of(1.0), anchored(divisors, (1, 1)))
    radius = np.broadcast_to(found.radius[0], divisors.shape)[0]
    assert np.isinf(radius).tolist() == [False, False, True, False, False]
    known, true = np.isfinite(radius), 1 / fractions(divisors[divisors != 0.0])
    assert (np.abs(fractions(found.middle[0, known]) - true) <= fractions(radius[known])).all()
    assert (radius[known] <= 40 * U * np.abs(true)).all()


def test_a_root_of_what_may_be_zero_is_at_most_the_root_of_what_it_may_be() -> None:
    found = root(Enclosed.of(np.array([0.0, -1e-9, 1e-12]), 0.0, np.array([4.0, 2e-9, 0.0])))
    assert found.radius[0] == pytest.approx([2.0, np.sqrt(3e-9), 0.0], abs=1e-12)
    assert found.high == pytest.approx([0.0, 0.0, 1e-6])


@pytest.mark.parametrize(
    "law",
    [
        {"polynomial": (0.3, -7.0, 11.0, 0.01)},
        {"sine": {"amplitude": 0.37, "angular_frequency": 5.3, "phase": 1.1, "offset": 1.6}},
        {"sine": {"amplitude": 30.0, "angular_frequency": 1e4, "phase": 0.3}},
        # Phases that would swallow digits of the time.
        {"sine": {"amplitude": 2.0, "angular_frequency": 3.7, "phase": 1e9}},
        {"sine": {"amplitude": 2.0, "angular_frequency": 3.7, "phase": -1e16}},
        # Terms of 16 to 192 that cancel before it comes to rest at 1.
        {"polynomial": (0.0, 0.0, 16.0, -32.0, 16.0)},
        # An offset that cancels the swing at 0.7.
        {"sine": {"amplitude": 350.0, "angular_frequency": 2.0, "offset": -350.0 * np.sin(1.4)}},
        {"table": {"times": (0.0, 0.2, 0.5, 1.0), "values": (1.0, 1.2, 0.9, 1.1)}},
        {"sum": [{"polynomial": (0.8, 0.25)}, {"sine": WAVE}, {"polynomial": (-0.8, 1e-9)}]},
    ],
    ids=lambda law: next(iter(law)),
)
def test_a_law_is_its_own_value_rounded_once_whatever_its_series_gives(law: dict[str, Any]) -> None:
    """As the comparison rounds it, by intervals; a table is the spline that scipy makes. So are its rates."""
    part = InputPart.model_validate(law)
    # Before a table begins there is no law.
    anywhere = np.random.default_rng(2).uniform(0.0 if part.table else -3.0, 1.0, 40)
    instants = np.concatenate([anywhere, 1.0 - 10.0 ** -np.arange(1.0, 13.0), [0.7]])
    function = part.function
    with np.errstate(invalid="ignore"):  # of an angle that is not known in twice the precision
        enclosed = function.enclosed(instants, ORDER)
    for derivative, (found, true) in enumerate(zip(enclosed, rates(part, instants, ORDER).T, strict=True)):
        off = np.abs(fractions(found.high) - fractions(true))
        assert (off <= fractions(found.radius[0])).all()
        computed = factorial(derivative) * function.series(instants, ORDER)[:, derivative]
        assert (np.abs(found.high - computed) <= found.radius[1] + 4 * U * np.abs(computed)).all()


def test_a_law_that_lies_on_a_tie_may_be_either_neighbour() -> None:
    """150 t + 25 t^2 at the double next to 0.2 lies within 1e-30 of the middle of two doubles near 31."""
    (value, *_) = Polynomial((0.0, 150.0, 25.0)).enclosed(np.array([0.2]))
    assert np.spacing(31.0) <= value.radius[0, 0] <= 1.01 * np.spacing(31.0)
