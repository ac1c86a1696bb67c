"""A strut whose axis is fixed in the knuckle, as its drawing says."""

from __future__ import annotations

from fractions import Fraction

from many_digits import number, size
from mpmath import mpf
from plain_mechanisms import close_car
from reference_cars import OFF_AXIS as CAR
from reference_cars import Points

from validate.reference.vectors import Vector, cross, dot, minus, plus, times


def numbers(vector: Vector) -> Vector:
    """Of many digits."""
    return number(vector[0]), number(vector[1]), number(vector[2])


def apart(one: Points, other: Points) -> mpf:
    """Greatest difference of a coordinate, mm."""
    return max(abs(x) for name in one for x in minus(one[name], numbers(other[name])))


def test_what_is_drawn_comes_back_with_strut_lower_above_the_strut_top_or_below_the_ball_joint() -> None:
    top, along = CAR["strut_top"], minus(CAR["strut_lower"], CAR["strut_top"])
    for share in (Fraction(-1, 4), Fraction(3, 2)):
        points = {**CAR, "strut_lower": plus(top, times(along, share))}
        assert apart(close_car(points, closure="drawn").instant.position, points) < mpf("1e-70")


def test_a_rod_end_drawn_beside_the_axis_moves_onto_it_and_nothing_else_moves() -> None:
    x, y, z = CAR["strut_rod_end"]
    beside = {**CAR, "strut_rod_end": (x + 7, y - 4, z)}
    closed = close_car(beside, closure="drawn")
    moved = {name: size(minus(place, beside[name])) for name, place in closed.instant.position.items()}
    assert 8 < moved.pop("strut_rod_end") < 9
    assert max(moved.values()) < mpf("1e-75")
    top, end, lower = (closed.instant.position[n] for n in ("strut_top", "strut_rod_end", "strut_lower"))
    rod = minus(end, top)
    drawn = size(numbers(minus(beside["strut_rod_end"], beside["strut_top"])))
    assert abs(size(rod) - drawn) < mpf("1e-75")
    assert size(cross(rod, minus(lower, top))) < mpf("1e-70")
    assert dot(rod, minus(lower, top)) > 0


def test_a_tie_rod_drawn_off_the_rack_line_turns_the_knuckle_about_its_steering_axis() -> None:
    x, y, z = CAR["tie_rod_inner"]
    off = {**CAR, "tie_rod_inner": (x + 9, y, z - 6)}
    closed = close_car(off, closure="drawn")
    p = closed.instant.position
    assert abs(closed.inputs["rack"] - 230) < mpf("1e-70")
    assert apart({"tie_rod_inner": p["tie_rod_inner"]}, CAR) < mpf("1e-75")
    tie = minus(p["tie_rod_outer"], p["tie_rod_inner"])
    drawn = size(numbers(minus(off["tie_rod_outer"], off["tie_rod_inner"])))
    assert abs(size(tie) - drawn) < mpf("1e-75")
    axis = minus(p["strut_top"], p["lower_ball_joint"])
    for name in ("lower_ball_joint", "strut_top"):
        assert apart({name: p[name]}, off) < mpf("1e-75")
    for name in ("tie_rod_outer", "strut_lower", "wheel_centre", "wheel_axis_inner", "strut_rod_end"):
        now, then = (minus(q[name], p["strut_top"]) for q in (p, {name: numbers(off[name])}))
        assert size(minus(now, then)) > mpf("0.01")
        assert abs(dot(now, axis) - dot(then, axis)) < mpf("1e-70")
        assert abs(dot(now, now) - dot(then, then)) < mpf("1e-70")
