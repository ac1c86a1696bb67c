"""Caster by its meaning: where the steering axis pierces a level plane, against a higher one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from lotus_front import BUMP
from lotus_poses import at_bump, degrees
from mpmath import mpf
from reference_cars import CARS, ReferenceCar

from validate.reference import Instant
from validate.reference.vectors import Vector, minus, plus, times

# The steering axis of each linkage, from below; x rearward, y right, z up.
AXIS = {
    "strut as drawn": ("lower_ball_joint", "strut_top"),
    "collinear strut": ("lower_ball_joint", "strut_lower"),
    "double wishbone": ("lower_ball_joint", "upper_ball_joint"),
}


def pierced(instant: Instant, foot: str, head: str, height: mpf) -> Vector:
    """The point of the steering axis at a height."""
    low, high = instant.position[foot], instant.position[head]
    along = minus(high, low)
    return plus(low, times(along, (height - low[2]) / along[2]))


@pytest.mark.parametrize("name", AXIS)
@pytest.mark.parametrize("turn", [Fraction(-1, 5), Fraction(0), Fraction(1, 5)])
def test_a_steering_axis_that_leans_rearward_is_farther_back_at_the_top_by_the_tangent(
    name: str, turn: Fraction
) -> None:
    car: ReferenceCar = CARS[name]
    instant = car.solve({**car.still, "arm_angle": (car.inputs["arm_angle"][0] + turn, 0, 0)})
    ground, above = (pierced(instant, *AXIS[name], mpf(height)) for height in (-500, 500))
    back = above[0] - ground[0]
    caster = instant.effects["caster"]
    assert abs(mpmath.tan(caster) - back / 1000) < mpf("1e-55")
    assert abs(caster) < mpmath.pi / 2
    assert (caster > 0) == (back > 0)


def test_a_top_moved_rearward_by_5_in_12_leans_by_that_angle_whatever_its_lean_inboard() -> None:
    car = CARS["double wishbone"]
    x, y, z = car.points["lower_ball_joint"]
    for inboard in (0, 20, 60):
        moved = replace(car, points={**car.points, "upper_ball_joint": (x + 100, y - inboard, z + 240)})
        assert abs(moved.close().instant.effects["caster"] - mpmath.atan(mpf(5) / 12)) < mpf("1e-70")


@pytest.mark.parametrize("row", BUMP, ids=lambda row: f"{row[0]} mm")
def test_caster_over_bump_is_the_printed_one(row: tuple[float, ...]) -> None:
    assert degrees(at_bump(row[0]), "caster") == pytest.approx(row[3], abs=0.5e-4)
