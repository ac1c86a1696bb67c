"""A third source: what Lotus Suspension Analysis prints of a front double wishbone, to its last digit."""

from __future__ import annotations

import pytest
from lotus_front import BUMP, STEERING
from lotus_poses import at_bump, degrees

HALF_BUMP, HALF_STEERING = 0.5e-4, 0.5e-2  # of the last printed digit, deg


@pytest.mark.parametrize("row", BUMP, ids=lambda row: f"{row[0]} mm")
def test_camber_toe_caster_and_kingpin_over_bump_are_the_printed_ones(row: tuple[float, ...]) -> None:
    bump, *printed = row
    instant = at_bump(bump)
    for name, angle in zip(("camber", "toe", "caster", "kingpin"), printed, strict=True):
        assert degrees(instant, name) == pytest.approx(angle, abs=HALF_BUMP)


@pytest.mark.parametrize("row", STEERING, ids=lambda row: f"{row[0]} mm")
def test_toe_and_camber_over_rack_travel_are_the_printed_ones(row: tuple[float, ...]) -> None:
    travel, *printed = row
    # The rack's travel is printed along y, which is `right`; S runs against it.
    instant = at_bump(0.0, -travel)
    for name, angle in zip(("toe", "camber"), printed, strict=True):
        assert degrees(instant, name) == pytest.approx(angle, abs=HALF_STEERING)
