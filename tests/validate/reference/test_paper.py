"""What the paper's own numbers say, and what they cannot; its printed equations hold."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from mpmath import mpf
from plain_mechanisms import solve_car

from validate.reference import Instant
from validate.reference.vectors import minus

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


# As the paper's Table 1 numbers them.
POINTS = (
    "lower_arm_front",
    "lower_arm_rear",
    "rack_centre",
    "strut_top",
    "lower_ball_joint",
    "tie_rod_outer",
    "strut_lower",
    "strut_rod_end",
    "tie_rod_inner",
    "wheel_centre",
)
NUMBER_OF = {name: number for number, name in enumerate(POINTS, start=1)}
LINKS = ((5, 1), (5, 2), (6, 5), (7, 5), (7, 6), (8, 4), (9, 6))  # eqs. (1)-(7)


def exact(number: mpf) -> Fraction:
    return Fraction(*(int(part) for part in number.as_integer_ratio()))


def printed_residual(
    reference: Instant, table: Table, theta: float, rack: float
) -> list[tuple[Fraction, int]]:
    """The printed equations (1)-(15) in exact arithmetic at the answer, each with its degree."""
    x, y, z = ({NUMBER_OF[k]: exact(p[i]) for k, p in reference.position.items()} for i in range(3))
    given = {NUMBER_OF[k]: p for k, p in table.items()}
    rows = []
    for i, j in LINKS:
        squared = sum((a - b) ** 2 for a, b in zip(given[i], given[j], strict=True))
        rows.append(((x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2 + (z[i] - z[j]) ** 2 - squared, 2))
    for c, (i, j) in ((y, (7, 5)), (x, (7, 5)), (y, (7, 4)), (x, (7, 4))):
        rows.append(((c[i] - c[j]) * (z[8] - z[4]) - (z[i] - z[j]) * (c[8] - c[4]), 2))
    d51 = mpmath.sqrt(sum((a - b) ** 2 for a, b in zip(given[5], given[1], strict=True)))
    rows.append((z[5] - z[1] - exact(d51 * mpmath.cos(mpf(theta))), 1))
    rows += [(x[9] - x[3], 1), (y[9] - y[3] + Fraction(rack), 1), (z[9] - z[3], 1)]
    return rows


@pytest.mark.parametrize(("theta", "rack"), [(0.8, 0.0), (1.5, 0.0), (1.5707963, 64.0), (2.4, -50.0)])
def test_the_printed_equations_hold_at_the_answer_to_its_error_bound(
    table: Table, theta: float, rack: float
) -> None:
    reference = solve_car(table, {"arm_angle": (theta, 0, 0), "rack": (rack, 0, 0)}, closure="collinear")
    bound = reference.error_bound["position"]
    for value, degree in printed_residual(reference, table, theta, rack):
        # A row changes by at most 12 coordinates' errors times differences below 700 mm.
        assert abs(value) <= exact(bound) * (12 * 700 if degree == 2 else 3) + Fraction(1, 10**140)
