r"""The proof of a patch: no term of its bound can be left out or halved.

The bounds are sums of magnitudes. So they are reached, in the corner of the box, by an equation all of whose
terms pull the same way: u^2 = w v with w = 1 - a s_1 - b s_2 and v = 1, whose root has no coefficient above
zero but the first.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from many_digits import fractions
from numpy.polynomial import polynomial

from pointcoord.numerics.arrays import Array
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.patches import patch_proof
from pointcoord.patches.jet import Jet
from pointcoord.patches.patch_proof import prove_patches

SEEDS = 400
UNKNOWN, NONE, ONE, OTHER, LIKE_UNKNOWN, LIKE_OTHER = range(6)

# y = (u, w, v, p, 0) in  u^2 + u p - w v = 0.
U, W, V, P, ZERO = range(5)
ROW = [Product(sign, (i, ZERO), (j, ZERO)) for sign, i, j in ((1.0, U, U), (1.0, U, P), (-1.0, W, V))]
SQUARE = quadratic_map([tuple(ROW)], 1, 5)
SLOPES, LOW_ORDER = np.array([0.2, 0.3]), 3
EVERY = powers(2, LOW_ORDER)
CENTRE = np.array([1.0, 1.0, 1.0, 0.0, 0.0])
NOTHING = Jet.constant(np.zeros((1, 5)), 2)


def in_the_corner(coefficients: Array) -> tuple[float, Array, Array]:
    """A series in two inputs and its two derivatives where both are 1."""
    k = EVERY.exponents.astype(float)
    twice = k[:, :, None] * k[:, None] - np.eye(2) * k[:, :, None]
    return float(coefficients.sum()), k.T @ coefficients, np.tensordot(coefficients, twice, 1)


def root() -> tuple[Factors, Array]:
    """The series of u, whose coefficients fall too slowly for their order."""
    known = np.zeros((1, EVERY.count, 4))
    known[:, 0] = CENTRE[1:]
    known[0, 1:3, W - 1] = -SLOPES
    factors = factorise(SQUARE.jacobian(CENTRE[None]))
    return factors, expand(SQUARE, factors, CENTRE[None], known, inputs=2)


def test_errors_of_a_root_are_within_their_bounds() -> None:
    """Where all terms of the bounds are reached."""
    factors, series = root()
    found = prove_patches(SQUARE, factors, series, LOW_ORDER, np.zeros((1, 5)), NOTHING).error
    u = np.sqrt(1.0 - SLOPES.sum())
    exact = u, -SLOPES / (2.0 * u), -np.outer(SLOPES, SLOPES) / (4.0 * u**3)
    parts = zip(exact, in_the_corner(series[0, :, U]), found.parts, strict=True)
    assert all((np.abs(e - s) <= bound[0, ..., 0]).all() for e, s, bound in parts)


def test_how_far_the_jacobian_changes_is_bounded() -> None:
    """Whether I - X C_u is no more than is said where p, which is 0, is as far below as it may be."""
    factors, series = root()
    off = np.zeros((1, EVERY.count, 5))
    off[0, :, P] = np.random.default_rng(2).uniform(0.01, 0.02, EVERY.count)
    low = np.array([[0.0, 0.0, 0.0, 0.03, 0.0]])
    data = Jet.of(off, EVERY.exponents)
    found = patch_proof._change(SQUARE, factors, series, LOW_ORDER, low, data)
    whole = series[0, :, U] - 0.5 * off[0, :, P]
    whole[0] -= 0.5 * low[0, P]
    value, first, second = in_the_corner(whole)
    parts = zip((1.0 - value, -first, -second), found.parts, strict=True)
    assert all((e <= b[0, ..., 0, 0] * INFLATION).all() for e, b in parts)


def one_row(generator: np.random.Generator) -> QuadraticMap:
    """x y - x' y', of which the unknown is one of the four, on either side of its product."""
    first, second = ((UNKNOWN, OTHER), (LIKE_UNKNOWN, LIKE_OTHER))
    if generator.integers(2):
        first = first[::-1]
    if generator.integers(2):
        second = second[::-1]
    row = [
        Product(sign, (left, NONE), (right, NONE)) for sign, (left, right) in ((1.0, first), (-1.0, second))
    ]
    return quadratic_map([tuple(row)], 1, 6)


def like(numbers: Array, generator: np.random.Generator) -> Array:
    """The same to some roundings."""
    return np.asarray(numbers * (1.0 + 2.0**-52 * generator.integers(-3, 4, numbers.shape)))


def random_series(generator: np.random.Generator) -> Array:
    """A constant and one power, each of any size."""
    series = np.zeros(LOW_ORDER + 1)
    series[[0, generator.integers(1, LOW_ORDER + 1)]] = 10.0 ** generator.uniform(-4.0, 4.0, 2)
    return series * generator.choice([-1.0, 1.0], LOW_ORDER + 1) * generator.uniform(1.0, 2.0, LOW_ORDER + 1)


@pytest.mark.parametrize("doubtful", [False, True])
def test_what_a_series_leaves_is_no_more_than_its_bound_says(doubtful: bool) -> None:
    """C(y(s)) and its derivatives at both ends, exactly; with errors of the known series at their most."""
    closest = np.zeros(3)
    for seed in range(SEEDS):
        generator = np.random.default_rng(seed)
        system = one_row(generator)
        series, errors = np.zeros((2, LOW_ORDER + 1, 6))
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
        data = Jet.of(errors[None], powers(1, LOW_ORDER).exponents)
        found, _ = patch_proof._remaining(system, factors, series[None], LOW_ORDER, low[None], data)
        exact = fractions(series) + fractions(errors)
        exact[0] += fractions(low)
        one, other = (np.convolve(exact[:, p.left[0]], exact[:, p.right[0]]) for p in system.rows[0])
        inverse = Fraction(float(factors.preconditioner[0, 0, 0]))
        bounds = (found.value[0, 0], found.first[0, 0, 0], found.second[0, 0, 0, 0])
        # The inflation of every bound is for the rounding of its own last operations.
        for d, bound in enumerate(INFLATION * np.array(bounds)):
            rest = polynomial.polyder(one - other, d)
            left = max(abs(inverse * polynomial.polyval(end, rest)) for end in (-1, 1))
            assert left <= Fraction(float(bound)), (seed, d)
            closest[d] = max(closest[d], float(left / Fraction(float(bound))) if bound else 0.0)
    assert (closest > 0.3).all(), closest
