"""Paths that are proven, by one series or step by step: they lead on one branch, and folds stop them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from sample_cars import SAMPLES

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import Product, quadratic_map
from pointcoord.solve import assembly, proven_path
from pointcoord.solve.assembly import Pose, assemble, close_drawing
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_path import proven_end
from pointcoord.solve.proven_step import ROOM, straight_way

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
MECHANISMS = {car.name: car.mechanism() for car in SAMPLES}
by_mechanism = pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS.keys())
few = settings(deadline=None, max_examples=max(10, settings.default.max_examples // 4))
# u^2 = w in y = (u, w, 0, 1): the branches meet at w = 0, and along w = 1 - s the series of u is that of
# sqrt(1 - s).
PARABOLA = quadratic_map([(Product(1.0, (0, 2), (0, 2)), Product(-1.0, (1, 2), (3, 2)))], unknowns=1, size=4)
AT_ONE = np.array([1.0, 1.0, 0.0, 1.0])


def known_at(mechanism: Mechanism, angle: float, rack: float) -> Array:
    return mechanism.known_series({"arm_angle": np.array([angle]), "rack": np.array([rack])})[0]


@by_mechanism
@few
@given(angle=st.floats(0.76, 2.2), rack=st.floats(-40.0, 60.0))
def test_a_path_that_a_series_proves_ends_where_the_tangents_end(
    mechanism: Mechanism, angle: float, rack: float
) -> None:
    closed, target = close_drawing(mechanism), known_at(mechanism, angle, rack)
    end = proven_end(mechanism.map, closed.y, target, closed.factors, 0.0)
    plainly = follow(mechanism.map, closed.y, target, closed.factors)
    if end is None:
        return
    assert plainly.done == 1.0
    # Both end with a Newton step that has shrunk to rounding, the condition number times eps of coordinates
    # up to 2.
    assert np.abs(end.y - plainly.y).max() <= 4 * EPS * float(plainly.factors.condition)


@by_mechanism
def test_most_paths_inside_the_range_take_series_only(mechanism: Mechanism) -> None:
    rng = np.random.default_rng(0)
    closed = close_drawing(mechanism)
    ends = [
        proven_end(mechanism.map, closed.y, known_at(mechanism, angle, rack), closed.factors, 0.0)
        for angle, rack in zip(rng.uniform(1.0, 2.0, 40), rng.uniform(-30.0, 40.0, 40), strict=True)
    ]
    assert sum(end is None for end in ends) <= 4


@by_mechanism
@few
@given(angle=st.floats(0.5, 2.4), rack=st.floats(-80.0, 100.0))
def test_where_a_share_is_proven_the_jacobian_keeps_its_sign_and_newton_finds_the_tangents_place(
    mechanism: Mechanism, angle: float, rack: float
) -> None:
    system, closed = mechanism.map, close_drawing(mechanism)
    n = system.unknowns
    change = known_at(mechanism, angle, rack) - closed.y[n:]
    begun = proven_path._begun(system, closed.y, closed.factors, change)
    series, share, _ = proven_path._proven_series(system, begun, closed.factors)
    shares = np.linspace(0.0, share, 30)
    places = shares[:, None] ** np.arange(len(series)) @ series
    signs = np.linalg.slogdet(system.jacobian(places))[0]
    assert (signs == signs[0]).all()
    path = follow(system, np.tile(closed.y, (30, 1)), closed.y[n:] + shares[:, None] * change)
    assert (path.done == 1.0).all()
    # No other assembly lies within 2 / omega of one: a place within half of that is nearest to this one.
    omega = system.lipschitz(path.factors.preconditioner)
    assert (np.abs(path.y - places)[:, :n].max(axis=-1) < 1.0 / omega).all()


def proven_on_the_parabola(w: float) -> float:
    factors = factorise(PARABOLA.jacobian(AT_ONE))
    change = np.array([w - 1.0, 0.0, 0.0])
    begun = proven_path._begun(PARABOLA, AT_ONE, factors, change)
    return proven_path._proven_series(PARABOLA, begun, factors)[1]


@pytest.mark.parametrize("w", [-1.0, -1e-3, 0.0, 1e-9])
def test_no_series_is_proven_up_to_a_fold(w: float) -> None:
    # The radius of convergence is the way to the fold, 1 / (1 - w) of the path.
    assert 0.3 / (1.0 - w) < proven_on_the_parabola(w) < 1.0 / (1.0 - w)


def test_what_is_left_out_is_the_residual_of_the_cut_series(strut: Mechanism) -> None:
    system, closed = strut.map, close_drawing(strut)
    n, order = system.unknowns, 6
    known = np.zeros((order + 1, system.size - n))
    known[0], known[1] = closed.y[n:], known_at(strut, 1.2, 20.0) - closed.y[n:]
    series = expand(system, closed.factors, closed.y, known)
    left, right = system.factors(series)
    first, second, starts = proven_path._beyond(order)
    rest = system.gather(np.add.reduceat(left[first] * right[second], starts, axis=0))
    for s in (0.1, 0.5, 1.0):
        exact = system.residual(s ** np.arange(order + 1) @ series)
        found = s ** np.arange(order + 1, 2 * order + 1) @ rest
        # Rows are sums of some ten products of coordinates up to 4, and lower orders are solved to rounding.
        assert np.abs(exact - found).max() <= 1e3 * EPS * float(closed.factors.condition)


def at(mechanism: Mechanism, angle: object, rack: object) -> Pose:
    return assemble(mechanism, {"arm_angle": np.asarray(angle, float), "rack": np.asarray(rack, float)})


def driven(mechanism: Mechanism, y: Array, coordinate: str, by: float) -> Array:
    """Known coordinates of which one is moved."""
    target = y[..., mechanism.layout.unknowns :].copy()
    target[..., mechanism.layout.scalar(coordinate) - mechanism.layout.unknowns] += by
    return target


@by_mechanism
@pytest.mark.parametrize("off", [0.0, 1e-5, 1e-3, 10.0])
def test_a_way_is_proven_where_the_condition_holds_in_one_of_three_norms(
    mechanism: Mechanism, off: float
) -> None:
    pose, rng = at(mechanism, 1.3, 10.0), np.random.default_rng(4)
    system, n, y = mechanism.map, mechanism.layout.unknowns, pose.y.copy()
    y[:n] += off * rng.uniform(-1.0, 1.0, n)
    inverse = np.linalg.inv(system.jacobian(y))
    proven = set()
    for length in (1e-9, 1e-4, 1e-2, 0.3, 3.0):
        target = driven(mechanism, y, "arm_angle rise", length)
        way = straight_way(system, inverse, y, target)
        proof = way.best_proof(system, inverse)
        tangent, lacking = way.tangent, system.residual(y)
        # Newton's way to the target, to rounding.
        assert np.abs(lacking + 2.0 * system.polar(y, tangent)).max() <= 1e-9 * (1.0 + np.abs(tangent).max())
        bend = np.abs(inverse @ system.residual(tangent))
        eta = np.abs(inverse @ lacking) + bend
        turned = np.abs(inverse @ system.jacobian(tangent))
        margins = []
        for plain, much in ((1.0, 0.0), (0.3, 1.0), (0.02, 1.0)):
            g = plain * (bend.max() if much else 1.0) + much * bend
            omega, z = float(system.lipschitz(inverse, g)), float((turned @ g / g).max())
            margins.append(z + float(np.sqrt(2.0 * omega * (eta / g).max())))
        # Rounding of the inverse and of the end of the tangent counts besides.
        assert float(proof.used) == pytest.approx(min(margins), rel=1e-3, abs=1e-6)
        assert bool(proof.holds) == (float(proof.used) <= ROOM)
        proven.add(bool(proof.holds))
    assert proven == ({False} if off > 1.0 else {True, False})


@by_mechanism
@pytest.mark.parametrize("moved", ["arm_angle", "rack"])
def test_the_input_that_goes_on_is_the_one_to_bring_back(mechanism: Mechanism, moved: str) -> None:
    start, held = at(mechanism, 1.5, 20.0), {"arm_angle": 1.5, "rack": 20.0}
    far = {"arm_angle": (0.1, 3.0, 0.01, 3.13), "rack": (1000.0,)}[moved]
    stopped = 0
    for value in far:
        wanted = {**held, moved: value}
        known = mechanism.known_series({name: np.array([v]) for name, v in wanted.items()})[0]
        path = follow(mechanism.map, start.y, known, start.factors)
        if path.done < 1.0:
            stopped += 1
            status = assembly.blocked(mechanism, "no way", path, known, path.done < 1.0, None)
            assert status.reduce == moved
            assert status.wanted == pytest.approx(wanted, abs=1e-9)
    assert stopped > 0


@by_mechanism
@pytest.mark.parametrize("bow", [0.0, 0.05])
@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_a_law_leads_where_the_straight_path_leads(mechanism: Mechanism, bow: float, off: float) -> None:
    """Also from a pose that is not closed: what it lacks is taken back along either path."""
    start, end = at(mechanism, 1.5, 0.0), at(mechanism, 1.2, 20.0)
    n, y = mechanism.layout.unknowns, start.y.copy()
    y[:n] += off * np.random.default_rng(8).uniform(-1.0, 1.0, n)
    first, last = y[n:], end.y[n:]

    def law(members: NDArray[np.intp], shares: Array) -> Array:
        assert set(members.tolist()) == {0}
        share = shares[:, None]
        return np.where(share == 1.0, last, first + (share + bow * share * (1.0 - share)) * (last - first))

    for path in (follow(mechanism.map, y, last), follow(mechanism.map, y, law, longest=0.3)):
        assert path.done == 1.0
        assert np.abs(path.y - end.y).max() <= 4 * np.finfo(float).eps * float(end.condition)


PARTS = st.floats(1e-3, 1.0)


@given(w=PARTS, p=PARTS, a=PARTS, b=PARTS, d=PARTS, e=PARTS)
def test_what_is_proven_of_a_strip_beside_a_way_is_reached_in_its_corner(
    w: float, p: float, a: float, b: float, d: float, e: float
) -> None:
    """Of u = w p what is left at the end beside the way is all of eta; of u p = w the change is all of z."""
    zero, one = 3, 4
    product_of_known = quadratic_map(
        [(Product(1.0, (0, zero), (one, zero)), Product(-1.0, (1, zero), (2, zero)))], 1, 5
    )
    beside, end = np.array([d, e, 0.0, 0.0]), np.array([w + a, p + b, 0.0, 1.0])
    way = straight_way(product_of_known, np.eye(1), np.array([w * p, w, p, 0.0, 1.0]), end, beside)
    assert way.norms(np.ones(1))[0] == pytest.approx(a * b + w * e + p * d + a * e + b * d + d * e, rel=1e-12)
    quotient = quadratic_map(
        [(Product(1.0, (0, zero), (2, zero)), Product(-1.0, (1, zero), (one, zero)))], 1, 5
    )
    # With an inverse that is a tenth off.
    inverse = np.array([[0.9 / p]])
    way = straight_way(quotient, inverse, np.array([w / p, w, p, 0.0, 1.0]), end, beside)
    assert way.norms(np.ones(1))[1] == pytest.approx(0.1 + 0.9 / p * (b + e), rel=1e-12)
