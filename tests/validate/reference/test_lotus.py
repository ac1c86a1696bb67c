"""A third source: what Lotus Suspension Analysis prints of a front double wishbone, to its last digit."""

from __future__ import annotations

import mpmath
import pytest
from lotus_front import BUMP, STEERING
from lotus_poses import at_bump, degrees

from validate.reference import Instant
from validate.reference.vectors import minus

HALF_BUMP, HALF_STEERING = 0.5e-4, 0.5e-2  # of the last printed digit, deg


def caster(instant: Instant) -> float:
    """Of the printed rule, from the positions."""
    top, foot = (instant.position[name] for name in ("upper_ball_joint", "lower_ball_joint"))
    axis = minus(top, foot)
    return float(mpmath.degrees(mpmath.atan2(axis[0], axis[2])))


def toe(instant: Instant) -> float:
    """Of the printed rule, from the positions."""
    axis = minus(instant.position["wheel_centre"], instant.position["wheel_axis_inner"])
    return float(mpmath.degrees(-mpmath.atan2(axis[0], axis[1])))


@pytest.mark.parametrize("row", BUMP, ids=lambda row: f"{row[0]} mm")
def test_camber_toe_caster_and_kingpin_over_bump_are_the_printed_ones(row: tuple[float, ...]) -> None:
    bump, camber, printed_toe, printed_caster, kingpin = row
    instant = at_bump(bump)
    assert degrees(instant, "camber") == pytest.approx(camber, abs=HALF_BUMP)
    assert degrees(instant, "kingpin") == pytest.approx(kingpin, abs=HALF_BUMP)
    assert caster(instant) == pytest.approx(printed_caster, abs=HALF_BUMP)
    assert toe(instant) == pytest.approx(printed_toe, abs=HALF_BUMP)


@pytest.mark.parametrize("row", STEERING, ids=lambda row: f"{row[0]} mm")
def test_toe_and_camber_over_rack_travel_are_the_printed_ones(row: tuple[float, ...]) -> None:
    travel, printed_toe, camber = row
    # The rack's travel is printed along y, which is `right`; S runs against it.
    instant = at_bump(0.0, -travel)
    assert toe(instant) == pytest.approx(printed_toe, abs=HALF_STEERING)
    assert degrees(instant, "camber") == pytest.approx(camber, abs=HALF_STEERING)
