"""Products of series, and what a series leaves of the equations, against rational numbers."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import perm, prod

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import SAMPLES, SampleCar, by_car

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics import power_series
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.multi_index import powers, products
from pointcoord.numerics.power_series import multiplied
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.patches.jet import Jet
from pointcoord.patches.patch_proof import _remaining
from pointcoord.patches.reported_points import moving_points, reported_points

Array = NDArray[np.float64]
ORDER, SEEDS = 3, 400
UNKNOWN, ZERO, ONE, OTHER, LIKE_UNKNOWN, LIKE_OTHER = range(6)


@pytest.mark.parametrize("pairs_at_once", [1, 7, 30, 8192])
def test_products_of_series_do_not_depend_on_how_many_pairs_are_multiplied_at_once(
    monkeypatch: pytest.MonkeyPatch, pairs_at_once: int
) -> None:
    pairs = products(2, 4, (2, 8), 1)
    left, right = np.random.default_rng(3).integers(-9, 10, (2, powers(2, 4).count, 5, 3)).astype(float)
    wanted = np.add.reduceat(left[pairs.first] * right[pairs.second], pairs.starts, axis=0)
    monkeypatch.setattr(power_series, "PAIRS", pairs_at_once)
    # Whole numbers: no sum is rounded.
    assert np.array_equal(multiplied(left, right, pairs), wanted)


@pytest.mark.parametrize("k", [(1,), (6,), (7,), (0, 4), (3, 2), (4, 4), (2, 0, 2), (1, 2, 3), (2, 4, 2)])
def test_the_pairs_of_a_power_are_each_once_in_a_table_of_exponents(k: tuple[int, ...]) -> None:
    every = powers(len(k), 8)
    number = every.exponents.tolist().index(list(k))
    places = np.stack(np.indices([9] * len(k)), axis=-1)
    found = {}
    for alike in (False, True):
        up, down = every.pairs(alike)[number]
        first, second = (places[side].reshape(-1, len(k)) for side in (up, down))
        assert (first + second == k).all()
        found[alike] = sorted(map(tuple, first.tolist()))
        assert len(set(found[alike])) == len(first)
    assert len(found[False]) == prod(one + 1 for one in k)
    # Of half of them the others are what is left of k.
    others = [tuple(np.subtract(k, i).tolist()) for i in found[True]]
    twice = any(one % 2 for one in k)
    assert every.times[number] == 1.0 + twice
    assert sorted(found[True] + others if twice else found[True]) == found[False]
    # Laid out flat a power is where its exponents say.
    flat = np.arange(9 ** len(k)).reshape([9] * len(k))
    assert np.arange(9 ** len(k))[every.places(number, number + 1)].tolist() == [flat[k]]


@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_bounds_of_series_without_negative_terms_are_reached_in_the_corner(inputs: int) -> None:
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


def test_what_does_not_depend_on_the_inputs_has_no_derivatives() -> None:
    values = np.random.default_rng(1).normal(size=(4, 3))
    jet = Jet.constant(values, 2)
    assert np.array_equal(jet.value, np.abs(values))
    assert jet.first.shape == (4, 2, 3)
    assert jet.second.shape == (4, 2, 2, 3)
    assert not jet.first.any()
    assert not jet.second.any()
    only = jet.where(np.array([True, False, True, False]))
    for part, whole in zip(only.parts, jet.parts, strict=True):
        assert np.array_equal(part[::2], whole[::2])
        assert np.isinf(part[1::2]).all()


def one_row(generator: np.random.Generator) -> QuadraticMap:
    """x y - x' y', of which the unknown is one of the four, on either side of its product."""
    first, second = ((UNKNOWN, OTHER), (LIKE_UNKNOWN, LIKE_OTHER))
    if generator.integers(2):
        first = first[::-1]
    if generator.integers(2):
        second = second[::-1]
    row = [
        Product(sign, (left, ZERO), (right, ZERO)) for sign, (left, right) in ((1.0, first), (-1.0, second))
    ]
    return quadratic_map([tuple(row)], 1, 6)


def like(numbers: Array, generator: np.random.Generator) -> Array:
    """The same to some roundings."""
    return np.asarray(numbers * (1.0 + 2.0**-52 * generator.integers(-3, 4, numbers.shape)))


def random_series(generator: np.random.Generator) -> Array:
    """A constant and one power, each of any size."""
    series = np.zeros(ORDER + 1)
    series[[0, generator.integers(1, ORDER + 1)]] = 10.0 ** generator.uniform(-4.0, 4.0, 2)
    return series * generator.choice([-1.0, 1.0], ORDER + 1) * generator.uniform(1.0, 2.0, ORDER + 1)


def product(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    """Of two polynomials in one variable."""
    found = [Fraction(0)] * (len(a) + len(b) - 1)
    for i, one in enumerate(a):
        for j, other in enumerate(b):
            found[i + j] += one * other
    return found


def at_an_end(polynomial: list[Fraction], derivative: int, end: int) -> Fraction:
    """A polynomial's derivative at -1 or 1."""
    return sum(
        (
            perm(k, derivative) * end ** (k - derivative) * c
            for k, c in enumerate(polynomial)
            if k >= derivative
        ),
        Fraction(0),
    )


@pytest.mark.parametrize("doubtful", [False, True])
def test_what_a_series_leaves_is_no_more_than_its_bound_says(doubtful: bool) -> None:
    """C(y(s)) and its derivatives at both ends, exactly; with errors of the known series at their most."""
    closest = np.zeros(3)
    for seed in range(SEEDS):
        generator = np.random.default_rng(seed)
        system = one_row(generator)
        series, errors = np.zeros((2, ORDER + 1, 6))
        series[0, ONE] = 1.0
        for place, other in ((UNKNOWN, LIKE_UNKNOWN), (OTHER, LIKE_OTHER)):
            series[:, place] = random_series(generator)
            series[:, other] = like(series[:, place], generator)
        low = np.zeros(6)
        if doubtful:
            place = int(generator.choice([OTHER, LIKE_UNKNOWN, LIKE_OTHER]))
            errors[:, place] = 1e-6 * random_series(generator)
            low[place] = 1e-6 * float(random_series(generator)[0])
        factors = factorise(system.jacobian(series[:1]))
        data = Jet.of(errors[None], powers(1, ORDER).exponents)
        found = _remaining(system, factors, series[None], ORDER, low[None], data)
        exact = [
            [Fraction(a) + Fraction(b) for a, b in zip(own, off, strict=True)]
            for own, off in zip(series.T.tolist(), errors.T.tolist(), strict=True)
        ]
        for own, lacks in zip(exact, low.tolist(), strict=True):
            own[0] += Fraction(lacks)
        terms = [product(exact[term.left[0]], exact[term.right[0]]) for term in system.rows[0]]
        rest = [one - other for one, other in zip(*terms, strict=True)]
        inverse = Fraction(float(factors.preconditioner[0, 0, 0]))
        bounds = (found.value[0, 0], found.first[0, 0, 0], found.second[0, 0, 0, 0])
        # The inflation of every bound is for the rounding of its own last operations.
        for d, bound in enumerate(INFLATION * np.array(bounds)):
            left = max(abs(inverse * at_an_end(rest, d, end)) for end in (-1, 1))
            assert left <= Fraction(float(bound)), (seed, d)
            closest[d] = max(closest[d], float(left / Fraction(float(bound))) if bound else 0.0)
    assert (closest > 0.3).all(), closest


def test_weights_that_do_not_give_the_drawn_point_are_in_its_bound_and_not_far_below_it() -> None:
    """A carried point whose weight is off by 1e-6 is off by that of its edge, wherever the body stands."""
    for car in SAMPLES:
        mechanism = car.mechanism()
        series, error = standing_series(mechanism)
        names = moving_points(mechanism.topology)
        drawn, bound = reported_points(mechanism, series, error, 2)
        assert bound.value.max() < 1e-11  # rounding of a car of some 1000 mm
        for name in mechanism.topology.carried:
            for i in range(3):
                weights = mechanism.carrier_weights[name].copy()
                weights[i] += 1e-6
                wrong = replace(mechanism, carrier_weights={**mechanism.carrier_weights, name: weights})
                found, off = reported_points(wrong, series, error, 2)
                here = slice(3 * names.index(name), 3 * names.index(name) + 3)
                moved = np.abs(found - drawn)[0, 0, here]
                assert moved.max() > 1e-6
                assert (off.value[0, here] >= moved).all(), (name, i)
                # Twice that for the inverse of the frame, whose edges are not square; and all three weights
                # are held to be as far off as the worst of them.
                assert off.value[0, here].max() <= 100.0 * moved.max(), (name, i)


def standing_series(mechanism: Mechanism) -> tuple[Array, Jet]:
    """A series of two inputs in which nothing moves, and no error."""
    count, unknowns = powers(2, 2).count, mechanism.map.unknowns
    series = np.zeros((1, count, mechanism.map.size))
    series[0, 0] = mechanism.drawn
    return series, Jet.constant(np.zeros((1, unknowns)), 2)


@by_car
def test_a_carried_point_is_off_by_what_its_carriers_are_off_at_most(car: SampleCar) -> None:
    """To first order exactly the sum of what each coordinate of the carriers moves it."""
    mechanism = car.mechanism()
    series, _ = standing_series(mechanism)
    unknowns, names = mechanism.map.unknowns, moving_points(mechanism.topology)
    generator = np.random.default_rng(4)
    # Numbers of any size, so that none hides another; so small that their products are nothing.
    size = 1e-6 * 10.0 ** generator.uniform(-3.0, 0.0, unknowns)
    error = Jet.constant(size[None], 2)
    error.first[0] = 1e-6 * 10.0 ** generator.uniform(-3.0, 0.0, (2, unknowns))
    found, off = reported_points(mechanism, series, error, 2)
    step = 1e-3
    gains = []
    for k in range(unknowns):
        ahead, behind = series.copy(), series.copy()
        ahead[0, 0, k] += step
        behind[0, 0, k] -= step
        none = Jet.constant(np.zeros((1, unknowns)), 2)
        ends = [reported_points(mechanism, each, none, 2)[0][0, 0] for each in (ahead, behind)]
        gains.append(np.abs(ends[0] - ends[1]) / (2.0 * step))
    table = np.array(gains)
    here = slice(3 * len(mechanism.topology.moving), None)
    # A coordinate of the first carrier moves the point and both edges; the bound takes these apart.
    wanted = size @ table
    assert (off.value[0, here] >= wanted[here] * (1.0 - 1e-6)).all()
    assert (off.value[0, here] <= 4.0 * wanted[here].max()).all()
    for i in range(2):
        wanted = error.first[0, i] @ table
        assert (off.first[0, i, here] >= wanted[here] * (1.0 - 1e-6)).all()
        assert (off.first[0, i, here] <= 4.0 * wanted[here].max()).all()
    assert found.shape[-1] == 3 * len(names)
