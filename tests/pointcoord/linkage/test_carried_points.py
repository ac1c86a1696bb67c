"""Points carried by a body, for random rigid motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.linalg import expm

from pointcoord.linkage.carried_points import carried_gain, carried_place, carried_series
from pointcoord.linkage.constraints.in_body import Normal, carrier_weights
from pointcoord.linkage.drawing import Drawing

Array = NDArray[np.float64]
EPS = np.finfo(float).eps
BODY = Normal("", "base", "first", "second")
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


@pytest.mark.parametrize(
    ("weights", "gain"),
    [
        ((0.0, 0.0, 0.0), 1.0),  # in the base
        ((0.25, 0.5, 0.0), 1.0),  # inside the triangle
        ((1.0, 1.0, 0.0), 3.0),  # |1 - 2| + 1 + 1
        ((0.25, 0.5, -0.125), 1.75),  # and 2 / 8 of the largest sum of two sides, 3
    ],
)
def test_the_gain_is_the_sum_of_what_each_carrier_may_move_the_point(
    weights: tuple[float, ...], gain: float
) -> None:
    places = {"base": (0.0, 0.0, 0.0), "first": (1.0, 0.0, 0.0), "second": (0.0, -2.0, 0.0)}
    drawing = Drawing({name: np.array(place) for name, place in places.items()}, np.array(1.0))
    assert carried_gain(np.array(weights), drawing, ("base", "first", "second")) == gain
