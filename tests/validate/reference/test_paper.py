"""What the paper's own numbers say, and what they cannot."""

from __future__ import annotations

import mpmath
import pytest
from mpmath import mpf
from plain_mechanisms import solve_car

from validate.reference.vectors import dot, minus

Table = dict[str, tuple[int, int, int]]


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
