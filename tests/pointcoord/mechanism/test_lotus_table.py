"""The built-in double wishbone against a third source: the table that Lotus' program printed for it."""

from collections.abc import Callable

import numpy as np
import pytest
from lotus_front import BUMP, ROLLING_RADIUS
from numpy.typing import NDArray
from sample_cars import WISHBONE

from pointcoord import Motion, Scene, simulate
from pointcoord.results.motion import Samples

Array = NDArray[np.float64]
PRINTED = 0.5e-4  # degrees: half of the last digit
# mm: the root below ends in steps of that size; the angles change by less than 0.06 degrees per mm.
FOUND = 1e-6


def contact_height(samples: Samples) -> Array:
    """Height of the wheel's lowest point: centre - R unit(z - (z . n) n)."""
    inner, centre = samples.position["wheel_axis_inner"], samples.position["wheel_centre"]
    spin = (centre - inner) / np.linalg.norm(centre - inner, axis=-1, keepdims=True)
    down = np.array([0.0, 0.0, 1.0]) - spin[..., 2:] * spin
    down /= np.linalg.norm(down, axis=-1, keepdims=True)
    return np.asarray(centre[..., 2] - ROLLING_RADIUS * down[..., 2])


@pytest.fixture(scope="module")
def bump(make_scene: Callable[..., Scene]) -> tuple[Motion, Array]:
    """The motion through the whole table, and the instants at which it has the table's bumps."""
    drawn = WISHBONE.drawn_inputs
    laws = [drawn["arm_angle"], -0.1], [drawn["rack"]]
    motion = simulate(make_scene(*laws, start=-1.0, stop=1.0, car=WISHBONE))
    still, wanted = contact_height(motion.at(0.0)), np.array([row[0] for row in BUMP])
    low, high = np.full(len(wanted), -1.0), np.full(len(wanted), 1.0)
    assert contact_height(motion.at(-1.0)) - still < wanted.min() < wanted.max()
    assert contact_height(motion.at(1.0)) - still > wanted.max()
    while ((high - low) * 50.0 > FOUND).any():  # the wheel rises by less than 50 mm in a second
        middle = 0.5 * (low + high)
        above = contact_height(motion.at(middle)) - still > wanted
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return motion, 0.5 * (low + high)


@pytest.mark.parametrize(("angle", "column"), [("camber", 1), ("toe", 2), ("caster", 3), ("kingpin", 4)])
def test_the_angles_over_bump_are_the_printed_ones_to_the_last_digit(
    bump: tuple[Motion, Array], angle: str, column: int
) -> None:
    motion, instants = bump
    found = np.rad2deg(motion.at(instants).wheel[angle])
    printed = np.array([row[column] for row in BUMP])
    assert np.abs(found - printed).max() <= PRINTED + 0.06 * FOUND
