"""Which assembly is returned."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mechanism_drawings import CARS, ReferenceCar
from mpmath import mpf

from validate.reference import NoReferenceError
from validate.reference.route import closed
from validate.reference.vectors import Vector, minus, plus, times


def test_a_drawing_at_a_dead_point_is_ambiguous(car: ReferenceCar) -> None:
    level = {"lower_arm_front": (0, 0, 0), "lower_arm_rear": (200, 0, 0), "lower_ball_joint": (0, 0, -300)}
    with pytest.raises(NoReferenceError, match="drawn at a singular pose"):
        replace(car, moved=level).solve({"arm_angle": (3.0, 0, 0)})


@pytest.mark.parametrize("name", CARS)
@given(theta=st.floats(-10, 10), rack=st.floats(-1e3, 1e3), speed=st.floats(-1e3, 1e3))
@settings(max_examples=3, deadline=None)
def test_any_finite_input_gives_a_proven_instant_or_an_error_of_the_family(
    name: str, theta: float, rack: float, speed: float
) -> None:
    inputs = {"arm_angle": (theta, speed, 1), "rack": (rack, speed, 2), "heave": (speed, 3, 4)}
    try:
        reference = CARS[name].solve(inputs)
    except NoReferenceError:
        return
    assert reference.error_bound["position"] < mpf("1e-55")


def along(*parts: tuple[str, Fraction]) -> Vector:
    """The lower ball joint, moved by shares of the distances to other points."""
    points = CARS["double wishbone"].points
    place = ball = points["lower_ball_joint"]
    for name, share in parts:
        place = plus(place, times(minus(points[name], ball), share))
    return place


@pytest.mark.parametrize("share", [Fraction(1, 2), Fraction(1, 4)])
def test_a_drawing_in_the_plane_where_two_assemblies_meet_is_ambiguous(share: Fraction) -> None:
    car = CARS["double wishbone"]
    place = along(("upper_ball_joint", share), ("tie_rod_inner", share))
    for hair in (Fraction(1, 10**9), Fraction(-1, 10**9)):
        x, y, z = place
        near = replace(car, moved={"tie_rod_outer": (x + hair, y, z + hair)})
        with pytest.raises(NoReferenceError, match="from another assembly"):
            closed(near.design)
        closed(near.design, 0.0)
    with pytest.raises(NoReferenceError):
        closed(replace(car, moved={"tie_rod_outer": place}).design, 0.0)
