"""Points carried by a body: where they are, and how far they may be off."""

from __future__ import annotations

import numpy as np
import pytest

from pointcoord import Scene, built_in_scenes
from pointcoord.linkage.carried_points import carried_gain, carried_place
from pointcoord.linkage.constraints.in_body import Normal, carrier_weights
from pointcoord.linkage.drawing import Drawing
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import scene_mechanism

EPS = np.finfo(float).eps
BODY = Normal("", "base", "first", "second")


@pytest.mark.parametrize(
    "batched", [("base",), ("first",), ("base", "second"), ("base", "first", "second", "rider")]
)
def test_cars_that_share_some_carriers_have_the_weights_that_they_have_alone(
    batched: tuple[str, ...],
) -> None:
    rng = np.random.default_rng(len(batched))
    names = ("base", "first", "second", "rider")
    vectors = {name: rng.normal(size=(6, 3) if name in batched else 3) for name in names}
    together = Drawing(vectors, np.ones(6))
    carriers = ("base", "first", "second")
    weights = carrier_weights(together, "rider", BODY)[0]
    assert weights.shape == (6, 3)
    gains = []
    for i in range(6):
        own = {name: place[i] if name in batched else place for name, place in vectors.items()}
        alone = carrier_weights(Drawing(own, np.array(1.0)), "rider", BODY)[0]
        # One solve of a system of the condition number of the frame.
        frame = np.stack([own["first"] - own["base"], own["second"] - own["base"]])
        spread = np.linalg.cond(np.vstack([frame, np.cross(*frame)]))
        np.testing.assert_allclose(weights[i], alone, rtol=0.0, atol=64 * EPS * spread * np.abs(alone).max())
        place = carried_place(alone, *(own[name] for name in carriers))
        size = max(np.abs(alone).max(), 1.0) * max(np.abs(v).max() for v in own.values()) ** 2
        np.testing.assert_allclose(place, own["rider"], rtol=0.0, atol=64 * EPS * spread * size)
        gains.append(carried_gain(alone, Drawing(own, np.array(1.0)), carriers))
    # Of a batch it is the largest.
    assert carried_gain(weights, together, carriers) == pytest.approx(max(gains), rel=1e-9)


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
