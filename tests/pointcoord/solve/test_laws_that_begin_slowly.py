"""What a series leaves out, and is said to; inputs that begin as a high power of time lack most terms."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pointcoord import Motion, Scene, simulate
from pointcoord.bounds.solved_coordinates import Summed
from pointcoord.solve.step_rule import last_magnitudes

SLOW = {
    "t^3": [0.0, 0.0, 1.0],
    "t^13": [*[0.0] * 12, 1.0],
    "t^3, and t hardly": [2e-6, 0.0, 1.0],
    "t^8, and t^2 hardly": [0.0, 2e-8, *[0.0] * 5, 1.0],
}


def parts_of_the_claims(motion: Motion, exact: Motion) -> dict[str, float]:
    """The largest error of each quantity, in parts of what is claimed of both numbers."""
    mine, its = motion.proof(rates=True).expected, exact.proof(rates=True).expected
    found = {}
    for quantity in ("position", "velocity", "acceleration"):
        claimed = {name: mine[quantity][name] + its[quantity][name] for name in mine[quantity]}
        found[quantity] = max(
            float(np.max(np.abs(motion.numbers[quantity][name] - exact.numbers[quantity][name]) / claim))
            for name, claim in claimed.items()
            if claim.all()
        )
    return found


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9])
@pytest.mark.parametrize("law", SLOW)
def test_a_motion_from_rest_keeps_what_it_claims(
    make_scene: Callable[..., Scene], law: str, tolerance: float
) -> None:
    shape = np.array(SLOW[law])

    def moved(tolerance: float) -> Scene:
        arm, rack = [1.5, *(0.05 * shape)], [0.0, *(3.0 * shape)]
        effects = ("velocity", "acceleration")
        return make_scene(arm, rack, samples=21, stop=1.0, tolerance=tolerance, effects=effects)

    # Newton's method at each instant, as near as rounding allows, leaves nothing out.
    motion, exact = simulate(moved(tolerance), "series"), simulate(moved(1e-12), "newton")
    for quantity, part in parts_of_the_claims(motion, exact).items():
        assert part <= 1.0, quantity
    # And it is as near as was asked: rates to the part of themselves that the tolerance is of the car.
    fastest = max(float(np.abs(array).max()) for array in exact.acceleration.values())
    gap = max(float(np.abs(motion.acceleration[n] - exact.acceleration[n]).max()) for n in exact.acceleration)
    assert gap <= fastest * (tolerance / motion.unit + 1e-12)


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


def test_a_dip_at_the_end_is_not_taken_for_the_end() -> None:
    # Looked for: 24 times what is said if the fall is taken in this unit, in which terms rise.
    angle, phase, odd, order, part, at = (
        0.3531510656,
        0.0831998326,
        0.9315690877,
        23,
        0.6792952857,
        0.6663665443,
    )
    k = np.arange(MANY)
    swing = np.cos(k * angle + phase)
    every = (swing + odd * (-1.0) ** k * swing) * np.maximum(k, 1) ** -1.5 * 8.0**k
    left = abs(float(np.sum(every[order + 1 :] * (at / 8.0) ** k[order + 1 :])))
    assert left <= said(every[: order + 1], at / 8.0, part / 8.0)
