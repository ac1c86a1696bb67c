"""The proof of a patch: it holds of sound series, and sees a fault in any part of an unsound one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import PAPER_STRUT, SampleCar, by_car

from pointcoord.linkage.drives import ArmAngle, Travel
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import doubled_residual
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers, products
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.patches.domain import Domain
from pointcoord.patches.jet import Jet
from pointcoord.patches.patch_proof import PatchProof, prove_patches
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.follower import follow

Array = NDArray[np.float64]
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

    def proof(self, series: Array | None = None) -> PatchProof:
        used = self.series if series is None else series
        return prove_patches(self.mechanism.map, self.factors, used, ORDER, self.lacking, self.data)

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
    ranges = {
        "arm_angle": (middle - angle, middle + angle),
        "rack": (drawn["rack"] - travel, drawn["rack"] + travel),
    }
    domain = Domain(mechanism, ranges, 0)
    low, high = np.zeros((1, 2), dtype=np.int64), np.ones((1, 2), dtype=np.int64)
    centre, half = domain.middle_and_half(low, high)
    known, lacking, data = domain.known_over(centre, half, ORDER)
    y = follow(mechanism.map, close_drawing(mechanism).y[None], known[:, 0]).y
    factors = factorise(mechanism.map.jacobian(y))
    found = expand(mechanism.map, factors, y, known, inputs=2)
    return Series(mechanism, domain, centre, half, factors, found, lacking, data)


def errors(series: Series, proof: PatchProof, count: int = 300) -> tuple[Array, Array]:
    """What Newton's method moves the series by at random places, and the bounds of that, by coordinate."""
    n = series.mechanism.map.unknowns
    y = series.at(np.random.default_rng(7).uniform(-1.0, 1.0, (count, 2)))
    solved = newton_refine(series.mechanism.map, y)
    assert solved.converged.all()
    return np.abs(solved.y - y)[:, :n].max(axis=0), proof.error.value[0]


@by_car
def test_the_error_is_within_its_bound_and_not_far_below_it(car: SampleCar) -> None:
    series = series_of(car, 0.125, 12.0)
    proof = series.proof()
    assert proof.proven.all()
    found, bound = errors(series, proof)
    # Newton's method itself is off by some hundred roundings of coordinates below 1.
    assert (found <= bound + 1e-14).all()
    assert bound.max() <= 20.0 * found.max()


@by_car
def test_every_order_more_makes_the_bound_smaller(car: SampleCar) -> None:
    series = series_of(car, 0.125, 12.0)
    system = series.mechanism.map
    bounds = []
    for order in (4, 6, 8, 10):
        count = powers(2, order).count
        known, lacking, data = series.domain.known_over(series.middle, series.half, order)
        assert known.shape[1] == count
        cut = series.series[:, :count]
        bounds.append(prove_patches(system, series.factors, cut, order, lacking, data).error.value.max())
    assert all(later < 0.2 * earlier for earlier, later in pairwise(bounds))


@by_car
@pytest.mark.parametrize("place", [0, 1, 2, 7, 40, 65])
def test_a_coefficient_that_is_off_by_1e_8_is_seen_in_the_bound(car: SampleCar, place: int) -> None:
    series = series_of(car)
    sound = series.proof()
    for coordinate in range(0, series.mechanism.map.unknowns, 5):
        spoilt = series.series.copy()
        spoilt[0, place, coordinate] += 1e-8
        proof = series.proof(spoilt)
        # The bound must reach the fault, which is 1e-8 where all variables are 1.
        assert proof.error.value[0, coordinate] >= 1e-8 - sound.error.value[0, coordinate]


@by_car
def test_a_drive_that_is_known_less_well_widens_the_bound_by_what_it_moves(car: SampleCar) -> None:
    series = series_of(car)
    sound, layout = series.proof(), series.mechanism.layout
    for drive in series.mechanism.topology.drives:
        place = layout.scalar(drive.coordinate)
        value = series.data.value.copy()
        value[0, place] += 1e-7
        doubted = replace(series, data=replace(series.data, value=value)).proof()
        n = series.mechanism.map.unknowns
        rate = np.zeros(series.mechanism.map.size)
        rate[place] = 1e-7
        moved = np.abs(series.factors.solve(2.0 * series.mechanism.map.polar(series.series[:, 0], rate)))[0]
        gain = doubted.error.value[0] - sound.error.value[0]
        assert moved.shape == (n,)
        assert (gain >= 0.9 * moved).all()


@by_car
def test_derivatives_are_within_their_bounds_of_those_of_the_solved_poses(car: SampleCar) -> None:
    series = series_of(car, 0.125, 12.0)
    system, n = series.mechanism.map, series.mechanism.map.unknowns
    proof = series.proof()
    shares = np.random.default_rng(8).uniform(-1.0, 1.0, (40, 2))
    solved = newton_refine(system, series.at(shares)).y
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


def test_the_residual_of_a_series_is_of_higher_order_only() -> None:
    # C(y(s)) has no terms up to the order: seen where s is small, in twice the precision.
    series = series_of(PAPER_STRUT)
    exact = np.zeros_like(series.lacking)
    sizes = []
    for share in (0.5, 0.25):
        (each,) = monomials([np.full((2, 1), share)], ORDER)
        y = each.T @ series.series[0]
        rows, _ = doubled_residual(series.mechanism.map, y, exact, exact)
        sizes.append(np.abs(rows).max())
    assert sizes[0] / sizes[1] > 2.0 ** (ORDER - 2) or sizes[1] < 1e-14


@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_powers_and_their_rates_are_those_of_their_exponents(inputs: int) -> None:
    generator = np.random.default_rng(inputs)
    states = list(generator.uniform(-1.0, 1.0, (3, inputs, 20)))
    every = powers(inputs, 5)
    found = monomials(states, 5)
    h = 1e-4

    def at(t: float) -> Array:
        s = states[0] + t * states[1] + 0.5 * t * t * states[2]
        return np.asarray(np.prod(s[None] ** every.exponents[..., None], axis=1))

    np.testing.assert_allclose(found[0], at(0.0), rtol=1e-13, atol=1e-15)
    # Central differences: h^2 times third derivatives below 1e3, and rounding over h and h^2.
    np.testing.assert_allclose(found[1], (at(h) - at(-h)) / (2 * h), atol=2e-5)
    np.testing.assert_allclose(found[2], (at(h) - 2 * at(0.0) + at(-h)) / h**2, atol=2e-5)


@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_products_of_series_are_products_of_their_sums(inputs: int) -> None:
    generator = np.random.default_rng(inputs)
    own, doubled = powers(inputs, 3), powers(inputs, 6)
    a, b = generator.normal(size=(2, own.count))
    pairs = products(inputs, 3, (0, 6), 0)
    coefficients = np.zeros(doubled.count)
    coefficients[pairs.targets] = np.add.reduceat(a[pairs.first] * b[pairs.second], pairs.starts)
    s = generator.uniform(-1.0, 1.0, (inputs, 30))
    factors, product = (monomials([s], order)[0] for order in (3, 6))
    np.testing.assert_allclose(coefficients @ product, (a @ factors) * (b @ factors), atol=1e-13)


@pytest.mark.parametrize("inputs", [1, 2, 3])
def test_a_jet_bounds_its_series_and_products_of_them(inputs: int) -> None:
    generator = np.random.default_rng(inputs)
    every = powers(inputs, 4)
    a, b = generator.normal(size=(2, every.count))
    jets = [Jet.of(c[None, :, None], every.exponents) for c in (a, b)]
    product = jets[0] * jets[1]
    s = generator.choice([-1.0, 1.0, 0.7], size=(inputs, 60))
    for i in range(inputs):
        for j in range(inputs):
            one, other = (np.repeat(np.eye(inputs)[k][:, None], 60, axis=1) for k in (i, j))
            both = monomials([s, one + other, np.zeros_like(s)], 4)
            alone = [monomials([s, d, np.zeros_like(s)], 4) for d in (one, other)]
            f, g = ([c @ both[0], c @ alone[0][1], c @ alone[1][1]] for c in (a, b))
            mixed = [0.5 * (c @ (both[2] - alone[0][2] - alone[1][2])) for c in (a, b)]
            assert np.abs(f[0]).max() <= jets[0].value[0, 0] * (1.0 + 1e-14)
            assert np.abs(f[1]).max() <= jets[0].first[0, i, 0] * (1.0 + 1e-14)
            assert np.abs(mixed[0]).max() <= jets[0].second[0, i, j, 0] * (1.0 + 1e-14)
            crossed = mixed[0] * g[0] + f[1] * g[2] + f[2] * g[1] + f[0] * mixed[1]
            assert np.abs(crossed).max() <= product.second[0, i, j, 0] * (1.0 + 1e-14)


def test_a_drive_s_series_over_a_range_is_as_near_as_it_says() -> None:
    car = PAPER_STRUT.mechanism()
    for drive in car.topology.drives:
        middle, half = (
            (np.array([1.2]), np.array([0.5]))
            if isinstance(drive, ArmAngle)
            else (
                np.array([3.0]),
                np.array([20.0]),
            )
        )
        assert isinstance(drive, ArmAngle | Travel)
        s = np.linspace(-1.0, 1.0, 41)
        for order in (4, 7, 12):
            series, doubts = drive.series_over(middle, half, order, car.drawing)
            values = np.polynomial.polynomial.polyval(s, series[0])
            exact = drive.series((middle + half * s)[:, None], car.drawing)[:, 0]
            # Both are rounded once more than what is bounded.
            assert np.abs(values - exact).max() <= doubts[0][0] + 1e-15
            if isinstance(drive, ArmAngle) and order == 4:
                assert np.abs(values - exact).max() >= 0.2 * doubts[0][0]
                assert doubts[0][0] < doubts[1][0] < doubts[2][0]


def test_the_start_of_a_series_is_the_pose_that_is_assembled() -> None:
    series = series_of(PAPER_STRUT)
    pose = assemble(series.mechanism, {"arm_angle": np.array(1.0), "rack": np.array(0.0)})
    np.testing.assert_allclose(series.series[0, 0], pose.y, rtol=0.0, atol=1e-14)
