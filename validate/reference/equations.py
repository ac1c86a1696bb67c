r"""The paper's constraint equations (closure "collinear"), written once for every kind of number.

Points carry the paper's numbers (Table 1 and Fig. 3); 11 is the inner point of the wheel's spin axis.
The unknowns are

    y = (p5, p6, p7, p8, p9, mu, lambda),      17 numbers,

and the 17 equations C(y) = 0 are

    |p_i - p_j|^2 = d_ij^2                      eqs. (1)-(7), seven links
    p5 - p4 = mu     (p8 - p4)                  the strut: 4, 8, 7, 5 on one line,
    p7 - p4 = lambda (p8 - p4)                  in place of eqs. (8)-(11)
    (p5 - p1) . up = d_51 cos(theta)            eq. (12)
    p9 - p3 + S right = 0                       eqs. (13)-(15)

The printed rows (8)-(11) say that two cross products vanish and use two components of each, so they
lose rank when the strut lies flat. The ratios mu and lambda have no preferred axis.
Every equation is at most quadratic, so the Jacobian is linear in y. What the knuckle carries (the wheel
centre and the spin axis) follows from p5, p6 and p7, with the handedness of the drawing:

    p = p5 + a r6 + b r7 + c r6 x r7,           r_i = p_i - p5.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from validate.reference.errors import BadInputError
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times

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
    "wheel_axis_inner": 11,
}
CHASSIS = (1, 2, 3, 4)
MOVING = (5, 6, 7, 8, 9)
LINKS: tuple[tuple[int, int], ...] = ((5, 1), (5, 2), (6, 5), (7, 5), (7, 6), (8, 4), (9, 6))
CARRIED = (10, 11)
SIZE = 17  # unknowns, and equations
COORDINATES = 15  # of the unknowns are coordinates of points; the others follow from points
MU, LAMBDA = 15, 16  # their places in y
KINGPIN_TOP = 7  # the steering axis runs from 5 to this point, eq. (16)


@dataclass(frozen=True)
class Known:
    """What the equations take as given at one instant; scalars may be balls, fractions or jets.

    Attributes:
        closure: which strut, "drawn" or "collinear".
        chassis: points 1 to 4.
        up: direction of z, a constant.
        right: direction of y, a constant.
        squared_length: d_ij^2 of every link.
        arm_height: d_51 cos(theta).
        rack: S.
        knuckle: its shape, in the numbers that the equations of the closure use.
    """

    closure: str
    chassis: Mapping[int, Vector]
    up: Vector
    right: Vector
    squared_length: Mapping[tuple[int, int], Scalar]
    arm_height: Scalar
    rack: Scalar
    knuckle: Mapping[int, Vector]


def knuckle_of(table: Mapping[int, Vector]) -> dict[int, Vector]:
    """(a, b, c) of each point that is carried; exact, as the triangle 5, 6, 7 keeps its side lengths.

    Raises:
        BadInputError: points 5, 6 and 7 lie on one line.
    """
    r6, r7 = minus(table[6], table[5]), minus(table[7], table[5])
    normal = cross(r6, r7)
    area = dot(normal, normal)  # also the Gram determinant |r6|^2 |r7|^2 - (r6 . r7)^2
    if area == 0:
        raise BadInputError("the knuckle", "points 5, 6 and 7 on one line", "a triangle 5, 6, 7")
    shape = {}
    for n in CARRIED:
        if n in table:
            r = minus(table[n], table[5])
            shape[n] = (
                dot(cross(r, r7), normal) / area,
                dot(cross(r6, r), normal) / area,
                dot(r, normal) / area,
            )
    return shape


def points_of(unknown: Sequence[Scalar], known: Known) -> dict[int, Vector]:
    """All points by number."""
    p = joints_of(unknown, known)
    return {**p, **carried_points(p, known)}


def carried_points(points: Mapping[int, Vector], known: Known) -> dict[int, Vector]:
    """The wheel centre, and the spin axis where it is given, from points 5, 6 and 7."""
    r6, r7 = minus(points[6], points[5]), minus(points[7], points[5])
    places = {}
    for n, factors in known.knuckle.items():
        places[n] = points[5]
        for vector, factor in zip((r6, r7, cross(r6, r7)), factors, strict=True):
            places[n] = plus(places[n], times(vector, factor))
    return places


def knuckle_frame(unknown: Sequence[Scalar], known: Known) -> tuple[Vector, Vector]:
    """Two vectors that are fixed in the knuckle and not parallel: r6 and r7."""
    p = joints_of(unknown, known)
    return minus(p[6], p[5]), minus(p[7], p[5])


def handedness(unknown: Sequence[Scalar]) -> Scalar:
    """+1: what is carried is placed with the handedness of the drawing, whatever the unknowns are."""
    return 1


def joints_of(unknown: Sequence[Scalar], known: Known) -> dict[int, Vector]:
    """Points 1 to 9 by number."""
    moving = {n: (unknown[3 * i], unknown[3 * i + 1], unknown[3 * i + 2]) for i, n in enumerate(MOVING)}
    return {**known.chassis, **moving}


def unknown_of(points: Mapping[int, Vector], known: Known) -> list[Scalar]:
    """The unknowns y of an assembly that is given by its points."""
    return [x for n in MOVING for x in points[n]] + implied(points, known)


def implied(points: Mapping[int, Vector], known: Known) -> list[Scalar]:
    """mu and lambda of assembled points: mu = (p5 - p4) . (p8 - p4) / d_84^2, lambda the same with p7."""
    rod = minus(points[8], points[4])
    squared = known.squared_length[8, 4]
    return [dot(minus(points[n], points[4]), rod) / squared for n in (5, 7)]


def residual(unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
    """C(y), 17 numbers: links, strut (mu, then lambda), arm angle, rack."""
    p = joints_of(unknown, known)
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
    p = joints_of(unknown, known)
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
