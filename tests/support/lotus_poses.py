"""Poses of the Lotus front suspension where its printed tables have them."""

from __future__ import annotations

from functools import cache

import mpmath
from lotus_front import POINTS, ROLLING_RADIUS
from mpmath import mpf
from plain_mechanisms import close_car, solve_car

from validate.reference import Instant
from validate.reference.vectors import dot, minus, times

CAR = {"suspension": "double_wishbone", "side": "right"}
DIGITS = 20


def contact_height(instant: Instant) -> mpf:
    """Height of the lowest point of a thin disc of the rolling radius about the wheel centre."""
    centre, inner = (instant.position[name] for name in ("wheel_centre", "wheel_axis_inner"))
    axis = minus(centre, inner)
    n = times(axis, 1 / mpmath.sqrt(dot(axis, axis)))
    return centre[2] - ROLLING_RADIUS * mpmath.sqrt(1 - n[2] ** 2)


def posed(theta: mpf, rack: float) -> Instant:
    inputs = {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}
    return solve_car(POINTS, inputs, digits=DIGITS, **CAR)


@cache
def drawn() -> tuple[mpf, mpf]:
    """The arm's angle and the contact point's height as drawn."""
    closed = close_car(POINTS, digits=DIGITS, **CAR)
    return closed.inputs["arm_angle"], contact_height(closed.instant)


def at_bump(bump: float, rack: float = 0.0) -> Instant:
    """The pose whose contact point is so much higher than as drawn, found by the secant method."""
    theta, height = drawn()

    def beyond(angle: mpf) -> mpf:
        return contact_height(posed(angle, rack)) - height - mpf(bump)

    return posed(mpmath.findroot(beyond, (theta, theta + mpf("0.01")), tol=1e-20), rack)


def degrees(instant: Instant, name: str) -> float:
    """An effect, deg."""
    return float(mpmath.degrees(instant.effects[name]))
