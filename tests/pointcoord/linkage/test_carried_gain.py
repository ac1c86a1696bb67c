"""How far a carried point may be off is bounded by how far its carriers are."""

from __future__ import annotations

import numpy as np
import pytest

from pointcoord import Scene, built_in_scenes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import scene_mechanism

OFF = 1e-6  # of the unit: what is quadratic in it, some 1e-12, is far below the slack


def moved_by(mechanism: Mechanism, off: np.ndarray) -> float:
    """Largest coordinate that a carried point moves by where the solved ones are off, in parts of that."""
    exact, moved = (mechanism.places(y) for y in (mechanism.drawn, mechanism.drawn + OFF * off))
    carried = mechanism.topology.carried
    return max(float(np.abs(moved[name] - exact[name]).max()) for name in carried) / OFF


CARRYING = [name for name in built_in_scenes() if Scene.load(name).mechanism.topology.carried]


@pytest.mark.parametrize("scene", CARRYING)
def test_no_error_of_the_carriers_moves_a_carried_point_farther_than_the_gain(scene: str) -> None:
    mechanism = scene_mechanism(Scene.load(scene))
    signs = np.random.default_rng(5).choice([-1.0, 1.0], size=(2000, len(mechanism.drawn)))
    farthest = moved_by(mechanism, signs)
    # Among 2,000 corners of the cube of errors some come near the farthest.
    assert 0.5 * mechanism.carried_gain < farthest <= mechanism.carried_gain * (1.0 + 1e-4)
