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

from pointcoord.bounds.neighbouring_rates import GroupState, neighbouring_poses, neighbouring_rates
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
    def of(cls, seed: int, off: float, doubt: float) -> "Case":
        """With coordinates that are computed to `off`, and driven ones that are known to `doubt`."""
        rng = np.random.default_rng(seed)
        system = random_map(rng)
        shape = (SIZE, GROUPS, COUNT)
        lacks = np.zeros(SIZE)
        lacks[STANDING] = 0.4 * U
        exact = []
        for d in range(3):
            state = fraction(rng.normal(size=(SIZE, GROUPS, 1)) + NEAR * rng.normal(size=shape))
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
            computed.append(state.astype(float) + off * rng.uniform(-1.0, 1.0, size=shape))
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
# How far coordinates are computed off, and how far driven ones are uncertain.
OFF = ((U, 0.0), (1e-9, 0.0), (1e-5, 0.0), (U, 1e-9))
# Radii of y, v, a over the largest of these and of the rounding of a change: some terms of each row times
# |X|, about 1/4; a rate's come to those of what it is made of.
MOST = (3e2, 1e3, 1e4)


@pytest.mark.parametrize(("off", "doubt"), OFF)
def test_rates_of_neighbours_lie_within_their_radii(off: float, doubt: float) -> None:
    closest = np.zeros(3)
    for seed in SEEDS:
        case = Case.of(seed, off, doubt)
        for d, (state, exact) in enumerate(zip(case.states, case.exact, strict=True)):
            distance, radius = off_and_radius(state, case.terms, exact)
            assert (distance <= fraction(radius)).all(), (seed, d)
            assert (np.abs(state.change) <= state.reach.T[..., None]).all()
            assert radius.max() <= MOST[d] * (NEAR * (U + off) + doubt)
            closest[d] = max(closest[d], (distance[:UNKNOWNS] / fraction(radius[:UNKNOWNS])).max())
    # Some of them all but reach it; of what is rounded, where that is all, a few per cent.
    assert (closest > (0.5 if off + doubt > 1e-12 else 0.02)).all()


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
