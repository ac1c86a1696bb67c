"""A third source: what Lotus Suspension Analysis prints of a front double wishbone, to its last digit."""

from __future__ import annotations

from functools import cache

import mpmath
import pytest
from lotus_front import BUMP, POINTS, ROLLING_RADIUS, STEERING
from mpmath import mpf

from validate.reference import Instant, closed_drawing, solve_reference
from validate.reference.vectors import dot, minus, times

CAR = {"suspension": "double_wishbone", "side": "right"}
HALF_BUMP, HALF_STEERING = 0.5e-4, 0.5e-2  # of the last printed digit, deg
DIGITS = 20


def contact_height(instant: Instant) -> mpf:
    """Height of the lowest point of a thin disc of the rolling radius about the wheel centre."""
    centre, inner = (instant.position[name] for name in ("wheel_centre", "wheel_axis_inner"))
    axis = minus(centre, inner)
    n = times(axis, 1 / mpmath.sqrt(dot(axis, axis)))
    return centre[2] - ROLLING_RADIUS * mpmath.sqrt(1 - n[2] ** 2)


def posed(theta: mpf, rack: float) -> Instant:
    inputs = {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}
    return solve_reference(POINTS, inputs, digits=DIGITS, **CAR)


@cache
def drawn() -> tuple[mpf, mpf]:
    """The arm's angle and the contact point's height as drawn."""
    closed = closed_drawing(POINTS, digits=DIGITS, **CAR)
    return closed.inputs["arm_angle"], contact_height(closed.instant)


def at_bump(bump: float, rack: float = 0.0) -> Instant:
    """The pose whose contact point is so much higher than as drawn, found by the secant method."""
    theta, height = drawn()

    def beyond(angle: mpf) -> mpf:
        return contact_height(posed(angle, rack)) - height - mpf(bump)

    return posed(mpmath.findroot(beyond, (theta, theta + mpf("0.01")), tol=1e-20), rack)


def degrees(instant: Instant, name: str) -> float:
    return float(mpmath.degrees(instant.effects[name]))


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
