"""The equations of the collinear strut are the paper's, and better where the printed ones lose their rank."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import pytest
from mpmath import mpf
from plain_mechanisms import solve_car

from validate.reference import Instant

Table = dict[str, tuple[int, int, int]]
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


def test_a_strut_lying_flat_costs_these_equations_nothing(table: Table) -> None:
    # The printed rows (8)-(11) lose their rank there.
    inputs = {"arm_angle": (1.5, 0.25, 0.125), "rack": (10.0, 150.0, 50.0)}
    upright = solve_car(table, inputs, closure="collinear")
    # Turn the car by 90 degrees about x: (x, y, z) -> (x, -z, y).
    turned_table = {name: (x, -z, y) for name, (x, y, z) in table.items()}
    turned = solve_car(turned_table, inputs, up=(0, -1, 0), right=(0, 0, 1), closure="collinear")
    bound = upright.radius + turned.radius
    for name in table:
        x, y, z = upright.position[name]
        assert max(abs(a - b) for a, b in zip((x, -z, y), turned.position[name], strict=True)) <= bound
    assert turned.digits == upright.digits
    assert abs(turned.effects["camber"] - upright.effects["camber"]) < mpf("1e-60")
