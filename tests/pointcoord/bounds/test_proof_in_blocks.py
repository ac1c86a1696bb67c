"""The proof of many poses is taken in blocks, and must not know it."""

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.bounds.certified_poses import SHARED
from pointcoord.bounds.proof import Proof
from pointcoord.numerics.rounding import EPS

SINE = {"sine": {"amplitude": 0.3, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}
HEAVE = {"sine": {"amplitude": 40.0, "angular_frequency": 3.1, "phase": -0.2}}


@by_car
@pytest.mark.parametrize("block", [7, 1, 30])
def test_a_proof_in_blocks_is_the_proof_in_one(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, block: int, car: SampleCar
) -> None:
    # Newton's states are looked up, so that a block changes no bit of them: every array must be the same.
    motion = simulate(make_scene(SINE, [0.0, 5.0], car=car, heave=HEAVE, samples=30), "newton")
    whole = motion.proof(rates=True)
    monkeypatch.setattr("pointcoord.bounds.proof.BLOCK", block)
    parts = motion.proof(rates=True)
    for field in fields(Proof):
        one, many = getattr(whole, field.name), getattr(parts, field.name)
        if isinstance(one, np.ndarray):
            assert np.array_equal(one, many), field.name
            continue
        assert one.keys() == many.keys()
        assert all(one[quantity] for quantity in ("position", "velocity", "wheel", "dimension"))
        for quantity in one:
            bounds, others = one[quantity], many[quantity]
            assert bounds.keys() == others.keys()
            assert all(np.array_equal(bounds[name], others[name]) for name in bounds), quantity
    # Every instant is another pose, so that no block may stand for another one.
    assert len(np.unique(whole.condition)) == 30
    assert np.isfinite(whole.carried_bound).all()


@by_car
@pytest.mark.parametrize("rates", [False, True])
def test_neighbours_that_share_an_inverse_are_as_well_proven_as_each_alone_in_any_order(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, car: SampleCar, rates: bool
) -> None:
    motion = simulate(make_scene(SINE, [0.0, 5.0], car=car, heave=HEAVE))
    instants = np.linspace(motion.times[0], motion.times[-1], 4500)
    mixed = np.random.default_rng(1).permutation(4500)
    together, other = (motion.proof_of(motion.at(each), rates) for each in (instants, instants[mixed]))
    monkeypatch.setattr("pointcoord.bounds.certified_poses.LARGEST", 1)
    alone = motion.proof_of(motion.at(instants), rates)
    assert not np.array_equal(together.pose_bound, alone.pose_bound)  # they were proven together
    # Sharing may cost this part of the pose's error, of the step and of what it leaves; a carried point is
    # off by that times its gain.
    cost = 2.0 * SHARED * alone.pose_bound * alone.carried_gain + 2.0 * EPS
    for name in ("pose_bound", "bound", "carried_bound"):
        found, plain = getattr(together, name), getattr(alone, name)
        assert np.array_equal(found[mixed], getattr(other, name)), name
        assert (np.abs(found - plain) <= cost).all(), name
    for quantity, part in together.proven.items():
        for name, bound in part.items():
            assert np.array_equal(bound[mixed], other.proven[quantity][name]), (quantity, name)
            assert (bound <= together.expected[quantity][name] + 1e-24).all(), (quantity, name)
