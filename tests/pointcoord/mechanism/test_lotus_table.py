"""The built-in double wishbone against a third source: the table that Lotus' program printed for it."""

import numpy as np
import pytest
from lotus_front import BUMP, ROLLING_RADIUS

from pointcoord import Scene, simulate

PRINTED = 0.5e-4  # degrees: half of the last digit


@pytest.mark.parametrize(("angle", "column"), [("camber", 1), ("toe", 2), ("caster", 3), ("kingpin", 4)])
def test_the_angles_over_bump_are_the_printed_ones_to_the_last_digit(angle: str, column: int) -> None:
    content = Scene.load("double-wishbone").model_dump(exclude_none=True)
    content["mechanism"]["wheel_radius"] = ROLLING_RADIUS
    # The height of the contact point is the table's own input; the instant in seconds is the bump in mm.
    content["inputs"] = {"contact_travel": {"polynomial": [0.0, 1.0]}, "rack": {"constant": 0.0}}
    bumps = [row[0] for row in BUMP]
    content["time"] = {"start": min(bumps), "stop": max(bumps), "samples": 2}
    found = np.rad2deg(simulate(Scene.from_mapping(content)).at(np.array(bumps)).wheel[angle])
    assert np.abs(found - [row[column] for row in BUMP]).max() <= PRINTED
