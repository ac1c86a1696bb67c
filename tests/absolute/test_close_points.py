"""A vector between two points of a body is as accurate as the coordinates given, however short it is."""

from collections.abc import Callable
from fractions import Fraction
from math import isqrt

import exact_form as exact
import numpy as np
import pytest
from flat import built_in
from numpy.typing import NDArray
from reach_of_accuracy import off

import absolute
from absolute import Axis
from absolute.drawing import Drawing
from absolute.mechanism import Mechanism
from absolute.newton import SMALLEST_RCOND

Array = NDArray[np.float64]
Table = dict[str, tuple[float, float, float]]
EPS = float(np.finfo(float).eps)
# Pairs of one body, and how much of their distance is left; below 1e-8 of the size a line is refused.
PAIRS = [
    ("lower_arm_front", "lower_arm_rear"),
    ("lower_arm_rear", "lower_arm_front"),
    ("lower_ball_joint", "strut_lower"),
    ("strut_lower", "lower_ball_joint"),
    ("strut_top", "strut_rod_end"),
    ("strut_rod_end", "strut_top"),
    ("lower_ball_joint", "lower_arm_front"),
    ("tie_rod_outer", "wheel_centre"),
]
SHARES = [1e-4, 1e-5, 1e-6, 1e-7]


def drawn_close(table: Table, fixed: str, moved: str, share: float, seed: int) -> dict[str, Array]:
    """A car of no round numbers, its strut drawn nearly on its line, with two points near each other."""
    random = np.random.default_rng(seed)
    car = {name: np.array(point) + random.uniform(-30, 30, 3) for name, point in table.items()}
    ball, top = car["lower_ball_joint"], car["strut_top"]
    for name, along in (("strut_lower", 0.12), ("strut_rod_end", 0.5)):
        car[name] = ball + along * (top - ball) + random.uniform(-2, 2, 3)
    car[moved] = car[fixed] + share * (car[moved] - car[fixed])
    return car


def fractions(point: Array) -> list[Fraction]:
    return [Fraction(float(value)) for value in point]


def exact_unit(start: Array, end: Array) -> list[Fraction]:
    """Unit vector between two points as given, to 40 digits."""
    line = [b - a for a, b in zip(fractions(start), fractions(end), strict=True)]
    square, scale = sum(x * x for x in line), 10**60
    length = Fraction(isqrt(square.numerator * scale**2 // square.denominator), scale)
    return [x / length for x in line]


def error_of(found: Array, wanted: list[Fraction]) -> float:
    return max(abs(float(a - b)) for a, b in zip(fractions(found), wanted, strict=True))


@pytest.mark.parametrize(("fixed", "moved"), PAIRS)
@pytest.mark.parametrize("share", SHARES)
def test_axes_are_drawn_with_the_digits_of_the_coordinates_given(
    table: Table, fixed: str, moved: str, share: float
) -> None:
    for seed in range(5):
        car = drawn_close(table, fixed, moved, share, seed)
        drawing = Drawing(built_in("macpherson", car, closure="collinear"))
        found = drawing.direction("axis", Axis(fixed, moved))
        # A subtraction, a division, a norm and a division: five roundings of eps / 2 at most.
        assert error_of(found, exact_unit(car[fixed], car[moved])) <= 2.5 * EPS


@pytest.mark.parametrize(("fixed", "moved"), PAIRS)
@pytest.mark.parametrize("share", SHARES)
def test_points_near_each_other_keep_their_vector_in_the_body_that_holds_them(
    table: Table, fixed: str, moved: str, share: float
) -> None:
    for seed in range(5):
        car = drawn_close(table, fixed, moved, share, seed)
        model = built_in("macpherson", car, closure="collinear")
        drawing = Drawing(model)
        for body in model.moving:
            if {fixed, moved} <= set(model.bodies[body]):
                vector = drawing.arm(body, moved) - drawing.arm(body, fixed)
                length = float(np.linalg.norm(vector))
                assert abs(length * drawing.size / np.linalg.norm(car[moved] - car[fixed]) - 1) <= 4 * EPS
                assert error_of(vector / length, exact_unit(car[fixed], car[moved])) <= 4 * EPS


@pytest.mark.parametrize("share", SHARES)
def test_the_drawn_angle_of_a_short_arm_is_that_of_the_coordinates_given(table: Table, share: float) -> None:
    car = drawn_close(table, "lower_ball_joint", "lower_arm_front", share, 3)
    angle = Mechanism(built_in("macpherson", car, closure="collinear")).drawn_inputs[0]
    # The arc cosine of a ratio with three roundings, at an angle whose sine is above a half.
    assert np.sin(angle) > 0.5
    assert abs(angle - exact.drawn_angle(car)) <= 4 * EPS


@pytest.mark.parametrize(("fixed", "moved"), PAIRS)
@pytest.mark.parametrize("share", SHARES)
def test_cars_with_points_near_each_other_stand_where_exact_circles_and_spheres_meet(
    table: Table, held: Callable[[float, float], dict[str, Array]], fixed: str, moved: str, share: float
) -> None:
    for seed in range(6):
        car = drawn_close(table, fixed, moved, share, seed)
        rack = float((car["rack_centre"] - car["tie_rod_inner"])[1]) + 5.0
        goal = exact.drawn_angle(car) + 0.05, rack
        expected = exact.exact_form(car, *goal)
        assert expected is not None
        model = built_in("macpherson", car, closure="collinear")
        try:
            motion = absolute.solve(model, held(*goal), rates=False, conditions=True)
        except absolute.SingularError as error:
            # An arm of a ten-millionth has half of its digits left.
            if share == 1e-7 and error.condition > 1.0 / SMALLEST_RCOND:
                continue
            raise
        assert motion.condition is not None
        # Size below 500 mm; rounding of the rows, magnified by the condition number.
        tolerance = 2 * EPS * 500 * motion.condition[0]
        for name, place in expected[0].items():
            assert exact.distance(place, motion.position[name][0]) <= tolerance, name
            assert exact.distance(place, motion.position[name][0]) <= off(motion)[0], name
