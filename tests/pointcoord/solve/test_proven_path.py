"""Paths that are proven step by step: they lead on one branch, and folds stop them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sample_cars import CARS

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import Pose, assemble, close_drawing
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_step import ROOM, Proof, prove_segment

MECHANISMS = {car: scene_mechanism(Scene.load(car)) for car in CARS}
by_mechanism = pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS.keys())
few = settings(deadline=None, max_examples=max(10, settings.default.max_examples // 4))


def known_at(mechanism: Mechanism, angle: float, rack: float) -> Array:
    return mechanism.known_series({"arm_angle": np.array([angle]), "rack": np.array([rack])})[0]


def at(mechanism: Mechanism, angle: object, rack: object) -> Pose:
    return assemble(mechanism, {"arm_angle": np.asarray(angle, float), "rack": np.asarray(rack, float)})


def proven(mechanism: Mechanism, pose: Pose, target: Array) -> tuple[Array, float, Proof]:
    """The series of the straight path from a pose that may be off, and how far it is proven."""
    system, n, y = mechanism.map, mechanism.layout.unknowns, pose.y[None]
    known = np.zeros((1, 9, system.size - n))
    known[:, 0], known[:, 1] = y[:, n:], target - y[:, n:]
    series = expand(system, factorise(system.jacobian(y)), y, known, system.residual(y))
    tried = ((float(s), prove_segment(system, series, s, parts=(1,))) for s in 0.9 ** np.arange(60.0))
    length, proof = next((s, proof) for s, proof in tried if proof.holds.all())
    return series[0], length, proof


@by_mechanism
@few
@given(
    angle=st.floats(0.5, 2.4),
    rack=st.floats(-80.0, 100.0),
    off=st.sampled_from([0.0, 1e-6, 1e-3, 1e-2]),
    seed=st.integers(0, 2**32 - 1),
)
def test_what_is_proven_of_a_step_holds_all_along_it(
    mechanism: Mechanism, angle: float, rack: float, off: float, seed: int
) -> None:
    """What is left of C contracts to a pose, which is nearer than any other, and C_u is regular."""
    system, start, n = mechanism.map, at(mechanism, 1.5, 0.0), mechanism.layout.unknowns
    y = start.y.copy()
    y[:n] += off * np.random.default_rng(seed).uniform(-1.0, 1.0, n)
    series, length, proof = proven(mechanism, replace(start, y=y), known_at(mechanism, angle, rack))
    shares = np.linspace(0.0, length, 31)
    places = shares[:, None] ** np.arange(len(series)) @ series
    signs = np.linalg.slogdet(system.jacobian(places))[0]
    assert (signs == signs[0]).all()
    lacking = (1.0 - shares)[:, None] * system.residual(y)
    reached = newton_refine(system, places, lacking)
    assert reached.converged.all()
    assert proof.within(np.abs(reached.y - places)[-1:, :n]).all()
    # eta and z of a step, by their definition from the series alone, are what the proof finds.
    g, inverse = proof.weights[0], np.linalg.inv(system.jacobian(places[15]))
    omega = float(system.lipschitz(inverse, g))
    eta = (np.abs((system.residual(places) - lacking) @ inverse.T) / g).max(axis=-1)
    z = (np.abs(np.eye(n) - inverse @ system.jacobian(places)) @ g / g).max(axis=-1)
    assert (z + np.sqrt(2.0 * omega * eta) <= ROOM + 1e-6).all()
    assert float(proof.alone[0]) <= (1.0 - z.max()) / omega * (1.0 + 1e-6)


@by_mechanism
def test_most_paths_inside_the_range_take_a_few_steps(mechanism: Mechanism) -> None:
    rng = np.random.default_rng(0)
    closed = close_drawing(mechanism)
    n = mechanism.layout.unknowns
    for angle, rack in zip(rng.uniform(1.0, 2.0, 40), rng.uniform(-30.0, 40.0, 40), strict=True):
        path = follow(mechanism.map, closed.y, known_at(mechanism, angle, rack), steps=8)
        assert path.done == 1.0
        assert np.abs(path.y[n:] - known_at(mechanism, angle, rack)).max() == 0.0
