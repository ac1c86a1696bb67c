"""Inputs that begin as a high power of time: most terms of their series are missing, and no claim breaks."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import Motion, Scene, simulate
from pointcoord.solve.taylor import last_magnitudes

SLOW = {
    "t^3": [0.0, 0.0, 1.0],
    "t^5": [0.0, 0.0, 0.0, 0.0, 1.0],
    "t^9": [*[0.0] * 8, 1.0],
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


def test_the_last_two_of_three_terms_are_themselves() -> None:
    series = np.array([[1.0, -2.0], [0.5, 0.25], [0.125, -0.0625]])
    # To the rounding of a logarithm, twice.
    assert last_magnitudes(series) == pytest.approx(np.abs(series[1:]), rel=1e-14)
