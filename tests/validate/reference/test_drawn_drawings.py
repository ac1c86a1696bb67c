"""What a drawing of a strut may be, what is refused of it, and on which side it lies."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from closed_forms import Points
from mpmath import mpf
from off_axis_cars import BASE
from reference_cars import CARS
from reference_cars import OFF_AXIS as POINTS

from validate.reference import AmbiguousAssemblyError, BadInputError, closed_drawing, solve_reference
from validate.reference.design import Design
from validate.reference.vectors import cross, dot, minus, plus, times

STILL = {"arm_angle": (1.5, 0, 0), "rack": (230, 0, 0)}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"strut_lower": BASE["strut_top"]}, "strut_lower below strut_top"),
        ({"strut_rod_end": BASE["strut_top"]}, "distance from strut_rod_end to strut_top"),
        ({"strut_rod_end": plus(BASE["strut_top"], (80, -12, 0))}, "drawn square to the strut's axis"),
        (
            {
                "strut_lower": plus(BASE["lower_ball_joint"], (5, 40, 150)),
                "strut_top": plus(BASE["lower_ball_joint"], (20, 160, 600)),
                "tie_rod_outer": plus(BASE["lower_ball_joint"], (1, 8, 30)),
            },
            "beside the axis",
        ),
    ],
)
def test_a_strut_that_is_none_is_refused_by_name(change: Points, message: str) -> None:
    with pytest.raises(BadInputError, match=message):
        solve_reference({**POINTS, **change}, STILL, closure="drawn")


def test_a_point_that_the_car_does_not_have_is_no_guess() -> None:
    short = {name: place for name, place in POINTS.items() if name != "wheel_axis_inner"}
    with pytest.raises(BadInputError, match="names among"):
        solve_reference(short, STILL, guess={"wheel_axis_inner": (0, 0, 0)}, closure="drawn")
    found = solve_reference(POINTS, STILL, guess=POINTS, closure="drawn")
    assert found.position == solve_reference(POINTS, STILL, closure="drawn").position


def test_points_5_6_and_7_on_one_line_are_no_harm_to_a_strut_whose_axis_passes_beside_them() -> None:
    ball, lower = POINTS["lower_ball_joint"], POINTS["strut_lower"]
    line = {**POINTS, "tie_rod_outer": plus(ball, times(minus(lower, ball), Fraction(1, 2)))}
    closed = closed_drawing(line, closure="drawn")
    assert closed.farthest[1] < 1e-75
    with pytest.raises(BadInputError, match="a triangle of these points"):
        solve_reference(line, STILL, closure="collinear")


@pytest.mark.parametrize("small", [Fraction(1, 10**3), Fraction(1, 10**12), Fraction(1, 10**30)])
def test_strut_lower_drawn_next_to_the_strut_top_costs_nothing(small: Fraction) -> None:
    top = POINTS["strut_top"]
    near = {**POINTS, "strut_lower": plus(top, times(minus(POINTS["strut_lower"], top), small))}
    there, here = (solve_reference(p, STILL, closure="drawn") for p in (near, POINTS))
    assert there.digits == here.digits
    assert there.condition < 3 * here.condition
    same = set(POINTS) - {"strut_lower"}  # the axis is the same line
    for name in same:
        assert all(
            abs(x) <= there.radius + here.radius for x in minus(there.position[name], here.position[name])
        )


def test_a_side_that_is_clear_only_in_exact_numbers_is_taken_when_asked_for() -> None:
    # The tie rod is drawn a hair above and below the plane in which its two assemblies meet.
    ball, top, inner = (POINTS[n] for n in ("lower_ball_joint", "strut_top", "tie_rod_inner"))
    middle = plus(
        ball, plus(times(minus(top, ball), Fraction(1, 8)), times(minus(inner, ball), Fraction(1, 4)))
    )
    signs = []
    for hair in (Fraction(1, 10**9), Fraction(-1, 10**9)):
        points = {**POINTS, "tie_rod_outer": plus(middle, (hair, 0, 0))}
        with pytest.raises(AmbiguousAssemblyError, match="tie choice"):
            closed_drawing(points, closure="drawn")
        signs.append(closed_drawing(points, closure="drawn", clearness=0).instant.choices.tie)
    assert sorted(signs) == [-1, 1]
    with pytest.raises(AmbiguousAssemblyError, match="tie choice"):
        closed_drawing({**POINTS, "tie_rod_outer": middle}, closure="drawn", clearness=0)


@pytest.mark.parametrize("apart", [Fraction(1, 10**30), Fraction(1, 3), Fraction(90), Fraction(700)])
def test_the_axis_of_the_knuckle_is_as_long_as_the_mechanism_however_far_apart_it_is_drawn(
    apart: Fraction,
) -> None:
    top, bottom = POINTS["strut_top"], POINTS["strut_lower"]
    way = minus(bottom, top)
    share = apart / max(abs(x) for x in way)
    points = {**POINTS, "strut_lower": plus(top, times(way, share))}
    axis = Design.from_points(points, (0, 0, 1), (0, 1, 0), "left", "drawn", "macpherson").knuckle[
        "strut_top"
    ]
    # In units of the mechanism; the largest component to a power of two.
    assert Fraction(1, 2) <= max(abs(x) for x in axis) <= 2
    assert cross(axis, way) == (0, 0, 0)
    assert dot(axis, way) < 0


def test_the_farthest_point_is_the_one_that_closing_the_drawing_moves_most() -> None:
    closed = CARS["collinear strut"].close()
    name, far = closed.farthest
    assert closed.movement[name] == far > 10
    assert all(moved <= far for moved in closed.movement.values())
    assert replace(closed, movement={"a": mpf(3), "b": mpf(5), "c": mpf(4)}).farthest == ("b", 5)
