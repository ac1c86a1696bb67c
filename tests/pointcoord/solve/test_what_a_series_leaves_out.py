"""What a series is said to leave out, held to what it does leave out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.solve.taylor import last_magnitudes

MANY = 200


def swinging(angle: float, radius: float, phase: float) -> np.ndarray:
    """Coefficients cos(k angle + phase) / radius^k of a pair of poles beside the axis, (MANY,)."""
    k = np.arange(MANY)
    return np.cos(k * angle + phase) / radius**k


def said(series: np.ndarray, at: float, length: float) -> float:
    """What the series is said to leave out at a place of its segment, rounding aside."""
    powers = at ** np.arange(len(series))
    last = (last_magnitudes(series[:, None], length)[:, 0] * powers[-2:]).sum()
    before = (np.abs(series) * powers)[-4:-2].sum()
    one = [np.array([[value]]) for value in (last, before, 0.0)]
    return float(Summed(*one).expected(np.zeros((1, 1)), np.ones(1), np.ones(1))[0, 0])


@given(
    angle=st.floats(0.05, 3.09),
    phase=st.floats(0.0, 6.28),
    order=st.integers(14, 40),
    part=st.floats(0.2, 0.6),
    place=st.floats(0.3, 1.0),
    unit=st.sampled_from([0.125, 1.0, 8.0]),
)
def test_terms_that_swing_leave_out_no_more_than_is_said(
    angle: float, phase: float, order: int, part: float, place: float, unit: float
) -> None:
    # Half a swing is seen in the last terms: what swings slower is at its end as smooth as no swing.
    if np.pi / angle > 4.0:
        angle = np.pi / 4.0
    every = swinging(angle, 1.0 / unit, phase)
    length = part / unit
    at = place * length
    left = abs(float(np.sum(every[order + 1 :] * at ** np.arange(order + 1, MANY))))
    assert left <= said(every[: order + 1], at, length)


@pytest.mark.parametrize("unit", [2.0**-6, 1.0, 2.0**6])
def test_the_unit_of_time_changes_nothing(unit: float) -> None:
    plain = swinging(0.4, 1.0, 0.3)[:25]
    scaled = plain * unit ** np.arange(25)
    at = 0.3
    assert said(scaled, at / unit, 0.4 / unit) == pytest.approx(said(plain, at, 0.4), rel=1e-12)


@pytest.mark.parametrize(
    ("angle", "phase", "odd", "order", "part", "at"),
    [
        # Looked for: 24 times what is said if the fall is taken in this unit, in which terms rise.
        (0.3531510656, 0.0831998326, 0.9315690877, 23, 0.6792952857, 0.6663665443),
    ],
)
def test_a_dip_at_the_end_is_not_taken_for_the_end(
    angle: float, phase: float, odd: float, order: int, part: float, at: float
) -> None:
    k = np.arange(MANY)
    swing = np.cos(k * angle + phase)
    every = (swing + odd * (-1.0) ** k * swing) * np.maximum(k, 1) ** -1.5 * 8.0**k
    left = abs(float(np.sum(every[order + 1 :] * (at / 8.0) ** k[order + 1 :])))
    assert left <= said(every[: order + 1], at / 8.0, part / 8.0)
