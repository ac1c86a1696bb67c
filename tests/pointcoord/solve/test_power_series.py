"""The power series of a motion: its equations order by order."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.power_series import expand
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.time_functions import Polynomial, Sine

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
N = 17
ARM, RACK = Polynomial((1.1, 0.4, -0.1)), Sine(30.0, 1.5, 0.2)
few = settings(deadline=None, max_examples=max(10, settings.default.max_examples // 4))


def known_at(mechanism: Mechanism, t: float, order: int) -> Array:
    return mechanism.known_series({"arm_angle": ARM.series(t, order), "rack": RACK.series(t, order)})


def pose_at(mechanism: Mechanism, t: float) -> Pose:
    return assemble(mechanism, {"arm_angle": ARM.series(t, 0)[..., 0], "rack": RACK.series(t, 0)[..., 0]})


@few
@given(t=st.floats(-0.5, 2.0), order=st.integers(1, 24))
def test_coefficients_solve_the_constraints_at_every_order(strut: Mechanism, t: float, order: int) -> None:
    pose = pose_at(strut, t)
    series = expand(strut.map, pose.factors, pose.y, known_at(strut, t, order))
    assert series.shape == (order + 1, strut.layout.size)
    condition = float(pose.condition)
    size = np.abs(series).max(axis=-1)
    for k in range(order + 1):
        total = sum(strut.map.polar(series[i], series[k - i]) for i in range(k + 1))
        # Each order is a sum of k + 1 products in at most four terms per row, of differences of two, and
        # one solve, whose backward error is n eps of the row times the solution; C_u at the pose was
        # factorised a step of noise earlier, which is eps times the condition number.
        products = sum(size[i] * size[k - i] for i in range(k + 1))
        tolerance = (16 * (k + 1) + 4 * N + 4 * condition) * EPS * 4 * products
        assert np.abs(total).max() <= tolerance
