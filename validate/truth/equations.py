r"""The paper's constraint equations, written once for every kind of number.

Points carry the paper's numbers (Table 1 and Fig. 3). The unknowns are

    y = (p5, p6, p7, p8, p9, mu, lambda),      17 numbers,

and the 17 equations C(y) = 0 are

    |p_i - p_j|^2 = d_ij^2                      eqs. (1)-(7), seven links
    p5 - p4 = mu     (p8 - p4)                  the strut: 4, 8, 7, 5 on one line,
    p7 - p4 = lambda (p8 - p4)                  in place of eqs. (8)-(11)
    (p5 - p1) . up = d_51 cos(theta)            eq. (12)
    p9 - p3 + S right = 0                       eqs. (13)-(15)

The printed rows (8)-(11) say that two cross products vanish and use two components of each, so they
lose rank when the strut lies flat. The ratios mu and lambda have no preferred axis.
Every equation is at most quadratic, so the Jacobian is linear in y.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validate.truth.vectors import Scalar, Vector, dot, minus, plus, times

NUMBER_OF = {
    "lower_arm_front": 1,
    "lower_arm_rear": 2,
    "rack_centre": 3,
    "strut_top": 4,
    "lower_ball_joint": 5,
    "tie_rod_outer": 6,
    "strut_lower": 7,
    "strut_rod_end": 8,
    "tie_rod_inner": 9,
    "wheel_centre": 10,
}
CHASSIS = (1, 2, 3, 4)
MOVING = (5, 6, 7, 8, 9)
LINKS = ((5, 1), (5, 2), (6, 5), (7, 5), (7, 6), (8, 4), (9, 6))
SIZE = 17  # unknowns, and equations
MU, LAMBDA = 15, 16  # their places in y


@dataclass(frozen=True)
class Known:
    """What the equations take as given at one instant; scalars may be balls, fractions or jets.

    Attributes:
        chassis: points 1 to 4.
        up: direction of z, a constant.
        right: direction of y, a constant.
        squared_length: d_ij^2 of every link.
        arm_height: d_51 cos(theta).
        rack: S.
    """

    chassis: Mapping[int, Vector]
    up: Vector
    right: Vector
    squared_length: Mapping[tuple[int, int], Scalar]
    arm_height: Scalar
    rack: Scalar


def points_of(unknown: Sequence[Scalar], known: Known) -> dict[int, Vector]:
    """Points 1 to 9 by number."""
    moving = {n: (unknown[3 * i], unknown[3 * i + 1], unknown[3 * i + 2]) for i, n in enumerate(MOVING)}
    return {**known.chassis, **moving}


def unknown_of(points: Mapping[int, Vector], known: Known) -> list[Scalar]:
    """The unknowns y of an assembly that is given by its points."""
    return [x for n in MOVING for x in points[n]] + list(strut_ratios(points, known))


def strut_ratios(points: Mapping[int, Vector], known: Known) -> tuple[Scalar, Scalar]:
    """mu and lambda of assembled points: mu = (p5 - p4) . (p8 - p4) / d_84^2, lambda the same with p7."""
    rod = minus(points[8], points[4])
    squared = known.squared_length[8, 4]
    return dot(minus(points[5], points[4]), rod) / squared, dot(minus(points[7], points[4]), rod) / squared


def residual(unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
    """C(y), 17 numbers: links, strut (mu, then lambda), arm angle, rack."""
    p = points_of(unknown, known)
    rows: list[Scalar] = []
    for i, j in LINKS:
        between = minus(p[i], p[j])
        rows.append(dot(between, between) - known.squared_length[i, j])
    rod = minus(p[8], p[4])
    for end, ratio in ((5, unknown[MU]), (7, unknown[LAMBDA])):
        rows.extend(minus(minus(p[end], p[4]), times(rod, ratio)))
    rows.append(dot(minus(p[5], p[1]), known.up) - known.arm_height)
    rows.extend(plus(minus(p[9], p[3]), times(known.right, known.rack)))
    return rows


def jacobian(unknown: Sequence[Scalar], known: Known) -> list[tuple[int, int, Scalar]]:
    """dC/dy as (row, column, entry), zeros left out; eq. (20) with the strut rows replaced."""
    p = points_of(unknown, known)
    entries: list[tuple[int, int, Scalar]] = []
    for row, (i, j) in enumerate(LINKS):
        for axis, component in enumerate(minus(p[i], p[j])):
            entries.append((row, _column(i, axis), 2 * component))
            if j in MOVING:
                entries.append((row, _column(j, axis), -2 * component))
    rod = minus(p[8], p[4])
    for first_row, end, ratio in ((7, 5, MU), (10, 7, LAMBDA)):
        for axis in range(3):
            row = first_row + axis
            entries.append((row, _column(end, axis), 1))
            entries.append((row, _column(8, axis), -unknown[ratio]))
            entries.append((row, ratio, -rod[axis]))
    for axis in range(3):
        entries.append((13, _column(5, axis), known.up[axis]))
        entries.append((14 + axis, _column(9, axis), 1))
    return entries


def _column(point: int, axis: int) -> int:
    return 3 * MOVING.index(point) + axis
