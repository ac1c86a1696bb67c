"""Paths that one series proves: they lead where tangents lead, they stay regular, and folds stop them."""

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
from pointcoord.solve import proven_path
from pointcoord.solve.assembly import close_drawing
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_path import proven_end

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


def test_a_planted_fault_in_what_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    # Without it nothing but the Jacobian's change would bound the share, and a fold would be passed.
    right = proven_on_the_parabola(-1.0)
    monkeypatch.setattr(proven_path, "LEFT_OUT", 1e300)
    # However far a series is meant to reach, the condition cuts it where it no longer holds.
    assert 0.0 <= proven_on_the_parabola(-1.0) <= 0.5
    assert right < 0.5
