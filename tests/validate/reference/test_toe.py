"""Toe by its meaning: where the front and the rear edge of the wheel are."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import mpmath
import pytest
from closed_forms import unit
from lotus_front import BUMP, STEERING
from lotus_poses import at_bump, degrees
from mpmath import mpf
from reference_cars import CARS, ReferenceCar

from validate.reference import Instant
from validate.reference.vectors import cross, minus, plus, times


def edges(car: ReferenceCar, instant: Instant) -> tuple[tuple[mpf, ...], tuple[mpf, ...]]:
    """The foremost and the rearmost point of the wheel's level diameter; x rearward, y right, z up."""
    inner, centre = car.wheel_axis
    p = instant.position
    axis = minus(p[centre], p[inner])
    level = times(unit(cross(axis, (0, 0, 1))), 300)
    one, other = plus(p[centre], level), minus(p[centre], level)
    return (one, other) if one[0] < other[0] else (other, one)


@pytest.mark.parametrize("turn", [Fraction(-1, 5), Fraction(0), Fraction(1, 5)])
@pytest.mark.parametrize("travel", [-25, 0, 25])
def test_the_front_edge_of_a_wheel_that_toes_in_is_nearer_the_middle_by_the_tangent(
    car: ReferenceCar, turn: Fraction, travel: int
) -> None:
    theta, rack = car.inputs["arm_angle"][0] + turn, car.inputs["rack"][0] + travel
    instant = car.solve({"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)})
    front, rear = edges(car, instant)
    out = 1 if car.side == "right" else -1
    nearer = out * (rear[1] - front[1])  # how much nearer the car's middle the front edge is
    toe = instant.effects["toe"]
    assert abs(mpmath.tan(toe) - nearer / (rear[0] - front[0])) < mpf("1e-55")
    assert abs(toe) < mpmath.pi / 2
    assert (toe > 0) == (nearer > 0)


def test_a_tie_rod_ahead_of_the_axle_that_is_pulled_inboard_toes_the_wheel_in() -> None:
    car = CARS["double wishbone"]
    assert car.points["tie_rod_outer"][0] < car.points["wheel_centre"][0]
    # The right wheel's: S moves the rack to the left.
    toes = [car.solve({**car.still, "rack": (travel, 0, 0)}).effects["toe"] for travel in (-20, 0, 20)]
    assert toes == sorted(toes)
    assert toes[0] < 0 < toes[2]


def test_a_level_spin_axis_that_points_forward_by_3_in_4_toes_in_by_its_angle() -> None:
    car = CARS["double wishbone"]
    x, y, z = car.points["wheel_centre"]
    known = replace(car, points={**car.points, "wheel_axis_inner": (x + 3, y - 4, z)})
    assert abs(known.close().instant.effects["toe"] - mpmath.atan(mpf(3) / 4)) < mpf("1e-70")


@pytest.mark.parametrize("row", BUMP, ids=lambda row: f"{row[0]} mm")
def test_toe_over_bump_is_the_printed_one(row: tuple[float, ...]) -> None:
    assert degrees(at_bump(row[0]), "toe") == pytest.approx(row[2], abs=0.5e-4)


@pytest.mark.parametrize("row", STEERING, ids=lambda row: f"{row[0]} mm")
def test_toe_over_rack_travel_is_the_printed_one(row: tuple[float, ...]) -> None:
    assert degrees(at_bump(0.0, -row[0]), "toe") == pytest.approx(row[1], abs=0.5e-2)
