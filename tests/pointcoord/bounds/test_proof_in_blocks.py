"""The proof of many poses is taken in blocks, and must not know it."""

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest
from sample_cars import SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.bounds.proof import Proof

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
        for quantity in one:
            bounds, others = one[quantity], many[quantity]
            assert bounds.keys() == others.keys()
            assert bounds
            assert all(np.array_equal(bounds[name], others[name]) for name in bounds), quantity
    # Every instant is another pose, so that no block may stand for another one.
    assert len(np.unique(whole.condition)) == 30
    assert np.isfinite(whole.carried_bound).all()
