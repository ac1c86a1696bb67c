r"""The proof of a patch: no term of its bound can be left out or halved, and real cars keep to it.

The bounds are sums of magnitudes. So they are reached, in the corner of the box, by an equation all of whose
terms pull the same way: u^2 = w v with w = 1 - a s_1 - b s_2 and v = 1, whose root has no coefficient above
zero but the first.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import perm

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import PAPER_STRUT, SampleCar, by_car

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.patches import patch_proof
from pointcoord.patches.domain import Domain
from pointcoord.patches.jet import Jet
from pointcoord.patches.patch_proof import PatchProof, prove_patches
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.follower import follow

Array = NDArray[np.float64]

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


ORDER = 10


@dataclass(frozen=True)
class Series:
    """A series about a pose, with all that its proof needs."""

    mechanism: Mechanism
    domain: Domain
    middle: Array
    half: Array
    factors: Factors
    series: Array
    lacking: Array
    data: Jet

    def proof(self) -> PatchProof:
        return prove_patches(self.mechanism.map, self.factors, self.series, ORDER, self.lacking, self.data)

    def at(self, shares: Array) -> Array:
        """All coordinates by the series, (N, size), the known ones as they are."""
        (each,) = monomials([shares.T], ORDER)
        y = each.T @ self.series[0]
        y[:, self.mechanism.map.unknowns :] = self.domain.known_at(self.middle[0] + shares * self.half[0])
        return y


def series_of(car: SampleCar, angle: float = 0.0625, travel: float = 6.0) -> Series:
    mechanism = car.mechanism()
    drawn = car.drawn_inputs
    middle = 1.0 if car is PAPER_STRUT else drawn["arm_angle"]
    rack = drawn["rack"]
    ranges = {"arm_angle": (middle - angle, middle + angle), "rack": (rack - travel, rack + travel)}
    domain = Domain(mechanism, ranges, 0)
    low, high = np.zeros((1, 2), dtype=np.int64), np.ones((1, 2), dtype=np.int64)
    centre, half = domain.middle_and_half(low, high)
    known, lacking, data = domain.known_over(centre, half, ORDER)
    y = follow(mechanism.map, close_drawing(mechanism).y[None], known[:, 0]).y
    factors = factorise(mechanism.map.jacobian(y))
    found = expand(mechanism.map, factors, y, known, inputs=2)
    return Series(mechanism, domain, centre, half, factors, found, lacking, data)


@by_car
def test_errors_are_within_their_bounds_of_the_solved_poses_and_not_far_below(car: SampleCar) -> None:
    series = series_of(car, 0.125, 12.0)
    system, n = series.mechanism.map, series.mechanism.map.unknowns
    proof = series.proof()
    shares = np.random.default_rng(8).uniform(-1.0, 1.0, (40, 2))
    y = series.at(shares)
    solved = newton_refine(system, y).y
    found, least = np.abs(solved - y)[:, :n].max(axis=0), proof.error.value[0]
    # Newton's method itself is off by some hundred roundings of coordinates below 1.
    assert (found <= least + 1e-14).all()
    assert least.max() <= 20.0 * found.max()
    factors = factorise(system.jacobian(solved))
    known, _, _ = series.domain.known_over(
        series.middle + shares * series.half, np.broadcast_to(series.half, (40, 2)), 3
    )
    every = powers(2, 3)
    local = expand(system, factors, solved, known, inputs=2)
    for direction in ((1.0, 0.0), (0.0, 1.0), (1.0, 1.0)):
        along = np.broadcast_to(np.array(direction)[:, None], (2, 40))
        states = [shares.T, along, np.zeros((2, 40))]
        _, first, second = monomials(states, ORDER)
        d = np.array(direction)
        speed = d @ np.stack([local[:, every.power_of(i, 1), :n] for i in range(2)], axis=-2)
        wanted = 2.0 * sum(local[:, k, :n] * np.prod(d ** every.exponents[k]) for k in range(3, 6))
        bound = np.einsum("i,iu->u", d, proof.error.first[0])
        curve = np.einsum("i,j,iju->u", d, d, proof.error.second[0])
        # A few hundred roundings of numbers below 1 beside.
        assert (np.abs(first.T @ series.series[0, :, :n] - speed) <= bound + 1e-13).all()
        assert (np.abs(second.T @ series.series[0, :, :n] - wanted) <= curve + 1e-13).all()


@by_car
def test_no_other_assembly_is_proven_to_be_near_where_another_one_is(car: SampleCar) -> None:
    # Mirrored about the plane of its three carriers, a point that three links hold is an assembly too.
    series = series_of(car)
    proof = series.proof()
    system, n = series.mechanism.map, series.mechanism.map.unknowns
    middle = series.series[0, 0]
    generator = np.random.default_rng(9)
    start = np.tile(middle, (400, 1))
    start[:, :n] += generator.normal(scale=0.5, size=(400, n))
    solved = newton_refine(system, start)
    others = solved.y[solved.converged]
    apart = np.abs(others - middle)[:, :n]
    other = (apart > 1e-6).any(axis=-1)
    assert other.sum() > 5
    assert (apart[other] > proof.unique_within[0]).any(axis=-1).all()


def test_a_patch_that_reaches_over_a_fold_is_not_proven() -> None:
    # The strut of the paper stops somewhere in this range.
    assert not series_of(PAPER_STRUT, 0.7, 90.0).proof().proven.any()


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
