"""Newton's method on the strut: its rate, where it stops, and what a failing member does to others."""

import numpy as np
import pytest

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics import newton
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.newton import newton_refine
from pointcoord.solve.assembly import Pose, assemble

EPS = np.finfo(float).eps


@pytest.fixture(scope="module")
def pose(strut: Mechanism) -> Pose:
    return assemble(strut, {"arm_angle": np.array(1.3), "rack": np.array(20.0)})


def displaced(pose: Pose, seed: int, by: float) -> Array:
    y = pose.y.copy()
    y[:17] += by * np.random.default_rng(seed).uniform(-1.0, 1.0, size=17)
    return y


@pytest.mark.parametrize("seed", range(5))
def test_error_of_a_step_is_the_square_of_the_error_before(
    strut: Mechanism, pose: Pose, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    monkeypatch.setattr(newton, "LIMIT", 1)
    omega = float(strut.map.lipschitz(pose.factors.preconditioner, np.ones(17)))
    before, after = [], []
    for power in range(8, 14):
        start = displaced(pose, seed, 2.0**-power / omega)
        before.append(np.abs(start - pose.y).max())
        after.append(np.abs(newton_refine(strut.map, start).y - pose.y).max())
    # Newton and Kantorovich: e' <= omega e^2 / (2 (1 - omega e)), here with 1 - omega e > 1/2.
    assert omega * before[0] < 0.5
    assert (np.array(after) <= omega * np.array(before) ** 2).all()
    # The direction is the same each time, so e' = c e^2 (1 + a e + ...) with |a| e below 3 * 2^-8: over a
    # factor of 2^5 in e the fitted order is off two by less than log2(1 + 3 / 256) / 5 twice.
    assert min(after) > 1000 * EPS
    assert abs(np.polyfit(np.log(before), np.log(after), 1)[0] - 2.0) < 0.01
