"""Points carried by a body, for random rigid motions."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm

from pointcoord.linkage.carried_points import carried_series

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
seeds = st.integers(0, 2**32 - 1)


@settings(deadline=None)
@given(seed=seeds)
def test_carried_point_moves_with_its_carriers_and_keeps_its_distance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    order = 18
    carriers = rng.normal(size=(3, 3))
    e1, e2 = carriers[1] - carriers[0], carriers[2] - carriers[0]
    frame = np.stack([e1, e2, np.cross(e1, e2)], axis=1)
    if np.linalg.cond(frame) > 1e3:
        return
    rider = rng.normal(size=3)
    weights = np.linalg.solve(frame, rider - carriers[0])
    # A body that turns steadily about the origin: the k-th coefficient of a point is K^k p / k!.
    k = rng.normal(size=3) / 2
    cross = np.array([[0.0, -k[2], k[1]], [k[2], 0.0, -k[0]], [-k[1], k[0], 0.0]])

    def series(p: Array) -> Array:
        terms = [p]
        for i in range(1, order + 1):
            terms.append(cross @ terms[-1] / i)
        return np.array(terms)

    carried = carried_series(weights, *(series(p) for p in carriers))
    size = 1 + np.abs(weights).max() * (1 + np.abs(frame).max()) ** 2
    # Order by order, products of up to `order` pairs of terms below exp(|k|).
    assert np.abs(carried - series(rider)).max() <= 64 * order * EPS * size * 10 * np.linalg.cond(frame)
    turned = expm(cross)
    whole = carried.sum(axis=0)
    # |k|^19 / 19! and the coefficients of the products of truncated series are below 1e-10 here.
    assert np.abs(whole - turned @ rider).max() <= 1e-6 * size
    for p in carriers:
        kept = np.linalg.norm(whole - turned @ p)
        assert abs(kept - np.linalg.norm(rider - p)) <= 1e-6 * size
