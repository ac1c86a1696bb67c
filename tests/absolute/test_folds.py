"""How much larger than to first order errors are near a fold: by a row whose fold is known."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from absolute.estimate import fold, further

Array = NDArray[np.float64]


def near_fold(slope: float, bend: float, doubts: list[float]) -> tuple[Array, Array, Array]:
    """Of a body whose first row is  c x - h x^2,  with other rows that stay zero, for doubts of that row."""

    def drift(placed: Any, rates: Array) -> Array:
        velocity = rates[:, :, 0]
        assert (velocity[:, 0] == 0.0).all()
        assert (rates[:, :, 1] == 0.0).all()
        second = np.zeros((len(doubts), 6))
        second[:, 0] = -2.0 * bend * velocity[:, 1, 0] ** 2
        return second

    mechanism: Any = SimpleNamespace(
        stack=SimpleNamespace(drift=drift), drawing=SimpleNamespace(bodies={"chassis": 0, "body": 1})
    )
    inverse = np.tile(np.diag([1.0 / slope, *[0.25] * 5]), (len(doubts), 1, 1))
    doubt = np.zeros((len(doubts), 6))
    doubt[:, 0] = doubts
    placed: Any = None
    return fold(mechanism, placed, inverse, doubt)


@pytest.mark.parametrize(("slope", "bend"), [(1.0, 1.0), (0.1, 3.0), (20.0, 0.5)])
def test_an_error_near_a_fold_grows_as_the_exact_answer_does(slope: float, bend: float) -> None:
    c, h = slope, bend
    shares = np.array([0.01, 0.3, 0.9, 0.999])
    # The fold is where the row turns, at a doubt of c^2 / (4 h).
    doubts = shares * c * c / (4.0 * h)
    pose, velocity, acceleration = near_fold(c, h, doubts.tolist())
    x = (c - np.sqrt(c * c - 4.0 * h * doubts)) / (2.0 * h)
    assert pose == pytest.approx(x / (doubts / c), rel=1e-10)
    # The velocity at unit rate is 1 / (c - 2 h x), which changes by 2 h / c^2 of x to first order.
    changed = 1.0 / (c - 2.0 * h * x) - 1.0 / c
    assert velocity == pytest.approx(changed / (2.0 * h / c**2 * doubts / c), rel=1e-10)
    # The acceleration is 2 h v^3, which changes by 12 h^2 / c^4 of x to first order.
    changed = 2.0 * h * (1.0 / (c - 2.0 * h * x) ** 3 - 1.0 / c**3)
    assert acceleration == pytest.approx(changed / (12.0 * h**2 / c**4 * doubts / c), rel=1e-10)


def test_beyond_a_fold_a_pose_is_within_twice_and_rates_are_anything() -> None:
    pose, velocity, acceleration = near_fold(1.0, 1.0, [0.25, 0.26, 10.0])
    assert pose.tolist() == [2.0, 2.0, 2.0]
    assert np.isinf(velocity).all()
    assert np.isinf(acceleration).all()


def test_higher_orders_lead_anywhere_and_nothing_stays_nothing() -> None:
    # Two points: the larger error of a point's components shows how far it may go in any.
    total = np.array([[[3.0, 1.0, 0.0, 0.0, 0.0, 0.0]], [[0.0, 0.0, 2.0, 1.0, 1.0, 1.0]], [[0.0] * 6]])
    grown = np.array([[1.5], [2.0], [np.inf]])
    assert further(total, grown).tolist() == [
        [[4.5, 2.5, 1.5, 0.0, 0.0, 0.0]],
        [[2.0, 2.0, 4.0, 2.0, 2.0, 2.0]],
        [[0.0] * 6],
    ]
