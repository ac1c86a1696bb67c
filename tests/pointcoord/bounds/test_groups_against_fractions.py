"""What is proven of groups of poses and their rates, against rational numbers.

A map of random terms has an assembly wherever it is wanted: each row has a driven coordinate of its own as a
constant term, which is what the rest of the row leaves, at every instant and with its rates.
"""

from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord.bounds.neighbouring_rates import (
    GroupState,
    _Factors,
    _twice_polar,
    neighbouring_poses,
    neighbouring_rates,
)
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosed_groups import EnclosedGroups
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.neighbours import Neighbours, Terms
from pointcoord.numerics.quadratic import Product, QuadraticMap, quadratic_map
from pointcoord.numerics.rounding import UNIT_ROUNDOFF as U

Array = NDArray[np.float64]
Exact = NDArray[np.object_]
fraction = np.vectorize(Fraction, otypes=[object])
GROUPS, COUNT, UNKNOWNS = 2, 5, 4
ZERO, ONE, STANDING = range(UNKNOWNS, UNKNOWNS + 3)
DRIVEN = range(UNKNOWNS + 3, 2 * UNKNOWNS + 4)  # one that terms read, and a constant of each row
SIZE = 2 * UNKNOWNS + 4
NEAR = 1e-3


def random_map(rng: np.random.Generator) -> QuadraticMap:
    """Squares, squares with a sign, products of what moves and what stands; rows of 4 to 8 terms."""

    def pair() -> tuple[int, int]:
        a, b = rng.choice([*range(UNKNOWNS), ZERO, ONE, STANDING, DRIVEN[0]], 2, replace=False)
        return int(a), int(b)

    rows = []
    for row in range(UNKNOWNS):
        square, turned = pair(), pair()
        terms = [
            Product(12.0 + float(rng.uniform()), (row, ZERO), (ONE, ZERO)),
            Product(float(rng.normal()), square, square),
            Product(float(rng.normal()), turned, turned[::-1]),
            *(Product(float(rng.normal()), pair(), pair()) for _ in range(rng.integers(1, 5))),
            Product(1.0, (DRIVEN[1 + row], ZERO), (ONE, ZERO)),
        ]
        rows.append(tuple(terms[place] for place in rng.permutation(len(terms))))
    return quadratic_map(rows, UNKNOWNS, SIZE)


def twice_polar(system: QuadraticMap, a: Exact, b: Exact) -> Exact:
    """2 B(a, b) of exact numbers, (rows, ...)."""
    found = []
    for row in system.rows:
        total = 0 * a[0]
        for p in row:
            (i, j), (k, m) = p.left, p.right
            total = total + Fraction(p.coefficient) * (
                (a[i] - a[j]) * (b[k] - b[m]) + (b[i] - b[j]) * (a[k] - a[m])
            )
        found.append(total)
    return np.stack(found)


def enclosed(exact: Exact, doubt: float, rng: np.random.Generator) -> EnclosedGroups:
    """Groups of numbers (G, m) that lie at an end of their radius, one of them as far off as `doubt`."""
    sizes = rng.uniform(size=exact.shape)
    sizes /= sizes.max(axis=-1, keepdims=True)
    about = exact + fraction(doubt * sizes * rng.choice([-1.0, 1.0], size=exact.shape))
    high = about.astype(float)
    low = (about - fraction(high)).astype(float)
    left = np.abs(exact - fraction(high) - fraction(low)).astype(float) * (1.0 + 4.0 * U)
    number = Enclosed(high.ravel(), low.ravel(), np.stack([left.ravel(), left.ravel()]))
    return EnclosedGroups.of_instants(number, exact.shape)


@dataclass(frozen=True)
class Case:
    """A map with exact states, and all that a proof is told of them."""

    mechanism: Mechanism
    terms: Terms
    exact: list[Exact]
    computed: list[Array]
    driven: list[dict[int, EnclosedGroups]]

    @classmethod
    def of(cls, seed: int, off: float, doubt: float, near: float = NEAR) -> "Case":
        """With coordinates that are computed to `off`, and driven ones that are known to `doubt`.

        Poses that lie nearer to one another than they are off are off alike.
        """
        rng = np.random.default_rng(seed)
        system = random_map(rng)
        shape = (SIZE, GROUPS, COUNT)
        lacks = np.zeros(SIZE)
        lacks[STANDING] = 0.4 * U
        exact = []
        for d in range(3):
            state = fraction(rng.normal(size=(SIZE, GROUPS, 1)) + near * rng.normal(size=shape))
            # Digits below those of doubles.
            state = state + fraction(U * rng.uniform(-1.0, 1.0, size=shape))
            state[[ZERO, ONE, STANDING]] = Fraction(0)
            if d == 0:
                state[ONE] = Fraction(1)
                state[STANDING] = Fraction(0.7) + Fraction(lacks[STANDING])
            state[DRIVEN[1:]] = Fraction(0)
            exact.append(state)
        y, v, a = exact
        left = (
            twice_polar(system, y, y) / 2,
            twice_polar(system, y, v),
            twice_polar(system, y, a) + twice_polar(system, v, v),
        )
        computed = []
        for state, rest in zip(exact, left, strict=True):
            state[DRIVEN[1:]] = -rest
            known = state[[ZERO, ONE, STANDING]].astype(float)
            wrong = off * rng.uniform(-1.0, 1.0, size=shape)
            computed.append(state.astype(float) + (wrong[..., :1] if near < off else wrong))
            computed[-1][[ZERO, ONE, STANDING]] = known
        driven = [{k: enclosed(state[k], doubt, rng) for k in DRIVEN} for state in exact]
        mechanism = SimpleNamespace(map=system, drawn_lacks=lacks, drawn_doubt=np.zeros(SIZE))
        terms = Terms.of(system, np.array([*range(UNKNOWNS), *DRIVEN]))
        return cls(cast(Mechanism, mechanism), terms, exact, computed, driven)

    @property
    def poses(self) -> Neighbours:
        """What is proven of the poses."""
        return neighbouring_poses(self.mechanism, self.terms, self.computed[0], self.driven[0])

    @property
    def states(self) -> list[GroupState]:
        """Where the coordinates and their rates are proven to be."""
        nothing = np.zeros(GROUPS)
        found = neighbouring_rates(
            self.mechanism, self.terms, self.poses, self.computed, self.driven, nothing
        )
        return list(found.states)


def off_and_radius(state: GroupState, terms: Terms, exact: Exact) -> tuple[Exact, Array]:
    """How far each exact number is from the enclosed one, and the radius of that, (moving, G, m)."""
    anchor, moving = state.anchor, terms.moving
    middle = (fraction(anchor.high) + fraction(anchor.low)).T[moving, :, None]
    off = np.abs(middle + fraction(state.change[:-1]) - exact[moving])
    return off, np.broadcast_to(anchor.radius[0].T[moving, :, None], off.shape)


SEEDS = range(24)
# How far coordinates are computed off, how far driven ones are uncertain, and how far poses lie apart.
OFF = ((U, 0.0, NEAR), (1e-9, 0.0, NEAR), (1e-5, 0.0, NEAR), (U, 1e-9, NEAR), (1e-4, 0.0, 1e-8))
# Radii of y, v, a over the largest of these and of the rounding of a change: some terms of each row times
# |X|, about 1/4; a rate's come to those of what it is made of.
MOST = (3e2, 1e3, 1e4)


@pytest.mark.parametrize(("off", "doubt", "near"), OFF)
def test_rates_of_neighbours_lie_within_their_radii(off: float, doubt: float, near: float) -> None:
    closest = np.zeros(3)
    for seed in SEEDS:
        case = Case.of(seed, off, doubt, near)
        for d, (state, exact) in enumerate(zip(case.states, case.exact, strict=True)):
            distance, radius = off_and_radius(state, case.terms, exact)
            assert (distance <= fraction(radius)).all(), (seed, d)
            assert (np.abs(state.change) <= state.reach.T[..., None]).all()
            assert radius.max() <= MOST[d] * (NEAR * (U + off) + doubt)
            closest[d] = max(closest[d], (distance[:UNKNOWNS] / fraction(radius[:UNKNOWNS])).max())
    # Some of them all but reach it; of what is rounded, where that is all, a few per cent.
    assert (closest > (0.5 if off + doubt > 1e-12 else 0.02)).all()


def test_of_every_coordinate_of_a_group_its_own_rounding_is_expected() -> None:
    """Also of the poses whose coordinate is larger than the one of the pose that they are seen from."""
    for seed in SEEDS:
        case = Case.of(seed, U, 0.0)
        state, moving = case.states[0], case.terms.moving
        expected = state.anchor.radius[1].T[moving, :, None]
        size = np.abs(case.exact[0][moving]).astype(float)
        assert (expected >= U * size).all(), seed
        # Of what is driven, and exact, no more: once for where it is seen from, twice for how far from there.
        driven = np.isin(moving, DRIVEN)
        far = np.abs(state.change[:-1]).max(axis=-1, keepdims=True)
        most = U * (size.min(axis=-1, keepdims=True) + 3.1 * far)
        assert (expected <= most)[driven].all(), seed


@pytest.mark.parametrize("off", [1e-9, 1e-5])
def test_poses_lie_within_what_is_left_of_them(off: float) -> None:
    closest = 0.0
    for seed in SEEDS:
        case = Case.of(seed, off, 1e-2 * off)
        poses, error = case.poses, (fraction(case.computed[0]) - case.exact[0])[:UNKNOWNS]
        assert (np.abs(error) <= fraction(poses.radius)).all()
        rest, bound = np.abs(error - fraction(poses.step)), fraction(poses.spread + poses.tail)
        assert (rest <= bound).all()
        closest = max(closest, (rest / bound).max())
    assert closest > 0.5


@pytest.mark.parametrize("off", [U, 1e-5])
def test_an_inverse_is_off_by_no_more_than_its_defect_at_every_pose(off: float) -> None:
    closest = 0.0
    units = np.where(np.eye(SIZE)[:UNKNOWNS, :, None, None] > 0.0, Fraction(1), Fraction(0))
    for seed in SEEDS:
        case = Case.of(seed, off, 1e-3)
        poses, y = case.poses, fraction(case.computed[0])
        y[[*DRIVEN, STANDING]] = case.exact[0][[*DRIVEN, STANDING]]
        jacobian = np.stack([twice_polar(case.mechanism.map, y, unit + 0 * y) for unit in units], axis=1)
        for g, i in np.ndindex(GROUPS, COUNT):
            left = np.abs(fraction(np.eye(UNKNOWNS)) - fraction(poses.inverse[g]) @ jacobian[..., g, i])
            assert (left <= fraction(poses.defect[g])).all()
            closest = max(closest, (left / fraction(poses.defect[g] + 1e-300)).max())
    assert closest > 0.9


def test_what_rates_leave_of_the_equations_is_known_to_a_rounding_of_how_it_changes() -> None:
    """2 B(a, b) of states that lie far apart, of which one coordinate or none is uncertain."""
    closest = 0.0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        terms = Terms.of(random_map(rng), np.array([*range(UNKNOWNS), *DRIVEN]))
        doubtful = rng.integers(0, UNKNOWNS) if seed % 3 else None
        (a, x), (b, y) = (uncertain(rng, terms, doubtful if seed % 3 == which else None) for which in (1, 2))
        for (one, own), (other, its) in (((a, x), (b, y)), ((a, x), (a, x))):
            rest, change = _twice_polar(terms, _Factors.of(terms, one), _Factors.of(terms, other))
            middle = (fraction(rest.high) + fraction(rest.low)).T[..., None] + fraction(change)
            off = np.abs(middle - twice_polar(terms.system, own, its))
            radius = np.broadcast_to(rest.radius[0].T[..., None], off.shape)
            assert (off <= fraction(radius)).all(), seed
            if doubtful is None:
                assert radius.max() <= 1e4 * U
            closest = max(closest, (off / fraction(radius)).max())
    assert closest > 0.99


def uncertain(rng: np.random.Generator, terms: Terms, doubtful: int | None) -> tuple[GroupState, Exact]:
    """A state whose poses lie far apart; the exact one is at an end of the radius of a coordinate."""
    high = rng.normal(size=(GROUPS, SIZE))
    change = np.zeros((len(terms.moving) + 1, GROUPS, COUNT))
    change[:-1] = 0.5 * rng.normal(size=(len(terms.moving), GROUPS, COUNT))
    change[..., COUNT // 2] = 0.0
    radius = np.zeros((2, GROUPS, SIZE))
    exact = fraction(np.repeat(high.T[..., None], COUNT, axis=-1))
    exact[terms.moving] += fraction(change[:-1])
    if doubtful is not None:
        radius[:, :, doubtful] = 1e-3
        exact[doubtful] += Fraction(1e-3) * rng.choice([-1, 1], size=(GROUPS, COUNT))
    return GroupState(Enclosed(high, 0.0 * high, radius), change, np.abs(change).max(axis=-1).T), exact
