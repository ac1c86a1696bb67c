r"""The paper's constraint equations (closure "collinear"), written once for every kind of number.

Points carry the paper's numbers (Table 1 and Fig. 3, see `points`). The unknowns are

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
centre and the spin axis) follows from p5, p6 and p7, with the handedness of the drawing (see `carried`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validate.reference.carried import Triangle, carried_by, shape_on
from validate.reference.linkage import Known, Link
from validate.reference.macpherson.points import (
    BALL,
    CARRIED,
    END,
    FRONT,
    INNER,
    JOINTS,
    LOWER,
    OUTER,
    RACK,
    REAR,
    TOP,
)
from validate.reference.vectors import Scalar, Vector, dot, minus, plus, times

LINKS: tuple[Link, ...] = (
    (BALL, FRONT),
    (BALL, REAR),
    (OUTER, BALL),
    (LOWER, BALL),
    (LOWER, OUTER),
    (END, TOP),
    (INNER, OUTER),
)
SIZE = 17  # unknowns, and equations
COORDINATES = 15  # of the unknowns are coordinates of points; the others follow from points
MU, LAMBDA = 15, 16  # their places in y
KNUCKLE: Triangle = (BALL, OUTER, LOWER)


def shape(table: Mapping[str, Vector]) -> dict[str, Vector]:
    """The places of the points that the knuckle carries, on the triangle 5, 6, 7."""
    return shape_on(KNUCKLE, table, CARRIED)


def points_of(unknown: Sequence[Scalar], known: Known) -> dict[str, Vector]:
    """All points."""
    p = joints_of(unknown, known)
    return {**p, **carried_by(KNUCKLE, p, known.knuckle)}


def knuckle_frame(unknown: Sequence[Scalar], known: Known) -> tuple[Vector, Vector]:
    """Two vectors that are fixed in the knuckle and not parallel: r6 and r7."""
    p = joints_of(unknown, known)
    return minus(p[OUTER], p[BALL]), minus(p[LOWER], p[BALL])


def handedness(unknown: Sequence[Scalar]) -> Scalar:
    """+1: what is carried is placed with the handedness of the drawing, whatever the unknowns are."""
    return 1


def joints_of(unknown: Sequence[Scalar], known: Known) -> dict[str, Vector]:
    """Points 1 to 9."""
    moving = {n: (unknown[3 * i], unknown[3 * i + 1], unknown[3 * i + 2]) for i, n in enumerate(JOINTS)}
    return {**known.chassis, **moving}


def unknown_of(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """The unknowns y of an assembly that is given by its points."""
    return [x for n in JOINTS for x in points[n]] + implied(points, known)


def implied(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """mu and lambda of assembled points: mu = (p5 - p4) . (p8 - p4) / d_84^2, lambda the same with p7."""
    rod = minus(points[END], points[TOP])
    squared = known.squared_length[END, TOP]
    return [dot(minus(points[n], points[TOP]), rod) / squared for n in (BALL, LOWER)]


def residual(unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
    """C(y), 17 numbers: links, strut (mu, then lambda), arm angle, rack."""
    p = joints_of(unknown, known)
    rows: list[Scalar] = []
    for i, j in LINKS:
        between = minus(p[i], p[j])
        rows.append(dot(between, between) - known.squared_length[i, j])
    rod = minus(p[END], p[TOP])
    for end, ratio in ((BALL, unknown[MU]), (LOWER, unknown[LAMBDA])):
        rows.extend(minus(minus(p[end], p[TOP]), times(rod, ratio)))
    rows.append(dot(minus(p[BALL], p[FRONT]), known.up) - known.driven["arm_angle"])
    rows.extend(plus(minus(p[INNER], p[RACK]), times(known.right, known.driven["rack"])))
    return rows


def jacobian(unknown: Sequence[Scalar], known: Known) -> list[tuple[int, int, Scalar]]:
    """dC/dy as (row, column, entry), zeros left out; eq. (20) with the strut rows replaced."""
    p = joints_of(unknown, known)
    entries: list[tuple[int, int, Scalar]] = []
    for row, (i, j) in enumerate(LINKS):
        for axis, component in enumerate(minus(p[i], p[j])):
            entries.append((row, _column(i, axis), 2 * component))
            if j in JOINTS:
                entries.append((row, _column(j, axis), -2 * component))
    rod = minus(p[END], p[TOP])
    for first_row, end, ratio in ((7, BALL, MU), (10, LOWER, LAMBDA)):
        for axis in range(3):
            row = first_row + axis
            entries.append((row, _column(end, axis), 1))
            entries.append((row, _column(END, axis), -unknown[ratio]))
            entries.append((row, ratio, -rod[axis]))
    for axis in range(3):
        entries.append((13, _column(BALL, axis), known.up[axis]))
        entries.append((14 + axis, _column(INNER, axis), 1))
    return entries


def _column(point: str, axis: int) -> int:
    return 3 * JOINTS.index(point) + axis
