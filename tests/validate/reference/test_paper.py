"""What the paper's own numbers say, and what they cannot."""

from __future__ import annotations

import math
from fractions import Fraction

import mpmath
import pytest
from exact_time_functions import time_function_value
from mpmath import mpf
from plain_mechanisms import solve_car

from validate.paper.tables import TABLE_2, TABLE_3
from validate.reference import Instant
from validate.reference.vectors import cross, dot, minus

Table = dict[str, tuple[int, int, int]]

THETA = {"polynomial": [0.8, 0.25, 0.0625]}
RACK = {"polynomial": [0, 150, 25]}


def table_angle() -> mpf:
    """theta from Table 1's own z5 - z1 = -30 and d51."""
    return mpmath.acos(mpf(-30) / mpmath.sqrt(180**2 + 325**2 + 30**2))


def test_table_1_is_reached_at_94_617_degrees_in_all_but_the_strut(table: Table) -> None:
    assert mpmath.degrees(table_angle()) == pytest.approx(94.617, abs=5e-4)
    reference = solve_car(table, {"arm_angle": (table_angle(), 0, 0)}, closure="collinear")
    for name in ("lower_ball_joint", "tie_rod_inner"):
        assert max(abs(x) for x in minus(reference.position[name], table[name])) < mpf("1e-57")
    for name in ("strut_lower", "strut_rod_end", "tie_rod_outer"):
        assert max(abs(x) for x in minus(reference.position[name], table[name])) > 0.5


def test_table_1_bends_the_strut_by_7_94_degrees_and_the_assembly_does_not(table: Table) -> None:
    def bend(p: dict[str, tuple[mpf, mpf, mpf]]) -> mpf:
        a = minus(p["strut_lower"], p["lower_ball_joint"])
        b = minus(p["strut_top"], p["strut_rod_end"])
        return mpmath.degrees(mpmath.acos(dot(a, b) / mpmath.sqrt(dot(a, a) * dot(b, b))))

    given = {name: (mpf(x), mpf(y), mpf(z)) for name, (x, y, z) in table.items()}
    assert bend(given) == pytest.approx(7.94, abs=0.005)
    reference = solve_car(table, {"arm_angle": (table_angle(), 0, 0)}, closure="collinear")
    assert abs(bend(dict(reference.position))) < mpf("1e-35")


def test_the_printed_wheel_centres_differ_from_table_1_by_10_3_mm_mostly_in_y(table: Table) -> None:
    apart = []
    for row in (*TABLE_2, *TABLE_3):
        bounce = {"arm_angle": time_function_value(THETA, row.time)}
        steer = {"arm_angle": (math.pi / 2, 0, 0), "rack": time_function_value(RACK, row.time)}
        reference = solve_car(table, bounce if row.table == 2 else steer, closure="collinear")
        apart.append([float(x) for x in minus(row.wheel_centre, reference.position["wheel_centre"])])
    squares = [x * x for row in apart for x in row]
    assert math.sqrt(sum(squares) / len(squares)) == pytest.approx(10.3, abs=0.1)
    assert sum(row[1] for row in apart) / len(apart) == pytest.approx(-15, abs=2)


def steering(table: Table, t: Fraction) -> Instant:
    """The paper's steering scene."""
    inputs = {"arm_angle": (1.5707963267948966, 0, 0), "rack": time_function_value(RACK, t, 100)}
    return solve_car(table, inputs, digits=90, closure="collinear")


def test_the_printed_quotient_for_omega_is_0_over_0_in_the_steering_scene(table: Table) -> None:
    now = steering(table, Fraction(1, 5))
    v5 = now.velocity["lower_ball_joint"]
    v65, v75 = minus(now.velocity["tie_rod_outer"], v5), minus(now.velocity["strut_lower"], v5)
    r75 = minus(now.position["strut_lower"], now.position["lower_ball_joint"])
    assert abs(dot(v65, r75)) < mpf("1e-75")
    assert max(abs(x) for x in cross(v65, v75)) < mpf("1e-75")
    assert dot(now.angular_velocity["knuckle"], now.angular_velocity["knuckle"]) > 2
