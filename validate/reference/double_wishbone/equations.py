r"""The equations of a double wishbone: each joint of the knuckle lies on three surfaces.

The unknowns are the knuckle's three joints, l at the lower arm, u at the upper arm and t at the tie rod,

    y = (l, u, t),                              9 numbers,

and the 9 equations C(y) = 0 are

    |l - a|^2 = d_la^2,  |l - b|^2 = d_lb^2     the lower arm, pivots a (front) and b (rear)
    (l - a) . up = d_la cos(theta)              its angle
    |u - c|^2 = d_uc^2,  |u - d|^2 = d_ud^2     the upper arm, pivots c and d
    |u - l|^2 = d_ul^2                          the knuckle, as a triangle
    |t - l|^2 = d_tl^2,  |t - u|^2 = d_tu^2
    |t - r|^2 = d_tr^2                          the tie rod, r = rack centre - S right.

Every equation is at most quadratic, so the Jacobian is linear in y. The wheel centre and the inner point of
the spin axis follow from the triangle with the handedness of the drawing (see `carried`), so no zero mirrors
them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from validate.reference.carried import Triangle, carried_by, shape_on
from validate.reference.double_wishbone.points import (
    CARRIED,
    INNER,
    JOINTS,
    LOWER_BALL,
    LOWER_FRONT,
    LOWER_REAR,
    OUTER,
    RACK,
    UPPER_BALL,
    UPPER_FRONT,
    UPPER_REAR,
)
from validate.reference.errors import BadInputError
from validate.reference.linkage import Known, Link
from validate.reference.vectors import Scalar, Vector, dot, minus, times

LINKS: tuple[Link, ...] = (
    (LOWER_BALL, LOWER_FRONT),
    (LOWER_BALL, LOWER_REAR),
    (UPPER_BALL, UPPER_FRONT),
    (UPPER_BALL, UPPER_REAR),
    (UPPER_BALL, LOWER_BALL),
    (OUTER, LOWER_BALL),
    (OUTER, UPPER_BALL),
    (OUTER, INNER),
)
SIZE = 9  # unknowns, all of them coordinates of points, and equations
KNUCKLE: Triangle = (LOWER_BALL, UPPER_BALL, OUTER)


def shape(table: Mapping[str, Vector]) -> dict[str, Vector]:
    """The places of the points that the knuckle carries, on the triangle of its joints.

    Raises:
        BadInputError: the joints lie on one line, or the upper arm has one pivot only.
    """
    if table[UPPER_FRONT] == table[UPPER_REAR]:
        what = f"the upper arm's axis from {UPPER_FRONT} to {UPPER_REAR}"
        raise BadInputError(what, "without length", "two pivots that lie apart")
    return shape_on(KNUCKLE, table, CARRIED)


def joints_of(unknown: Sequence[Scalar], known: Known) -> dict[str, Vector]:
    """All points but those that the knuckle carries."""
    moving = {n: (unknown[3 * i], unknown[3 * i + 1], unknown[3 * i + 2]) for i, n in enumerate(JOINTS)}
    inner = minus(known.chassis[RACK], times(known.right, known.driven["rack"]))
    return {**known.chassis, **moving, INNER: inner}


def points_of(unknown: Sequence[Scalar], known: Known) -> dict[str, Vector]:
    """All points."""
    p = joints_of(unknown, known)
    return {**p, **carried_by(KNUCKLE, p, known.knuckle)}


def unknown_of(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """The unknowns y of an assembly that is given by its points."""
    return [x for name in JOINTS for x in points[name]]


def implied(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """Nothing: all unknowns are coordinates."""
    return []


def knuckle_frame(unknown: Sequence[Scalar], known: Known) -> tuple[Vector, Vector]:
    """Two vectors that are fixed in the knuckle and not parallel: from the lower ball joint to the others."""
    p = joints_of(unknown, known)
    return minus(p[UPPER_BALL], p[LOWER_BALL]), minus(p[OUTER], p[LOWER_BALL])


def handedness(unknown: Sequence[Scalar]) -> Scalar:
    """+1: what is carried is placed with the handedness of the drawing, whatever the unknowns are."""
    return 1


def residual(unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
    """C(y), 9 numbers: the links, then the lower arm's angle."""
    p = joints_of(unknown, known)
    rows: list[Scalar] = []
    for a, b in LINKS:
        between = minus(p[a], p[b])
        rows.append(dot(between, between) - known.squared_length[a, b])
    rows.append(dot(minus(p[LOWER_BALL], p[LOWER_FRONT]), known.up) - known.driven["arm_angle"])
    return rows


def jacobian(unknown: Sequence[Scalar], known: Known) -> list[tuple[int, int, Scalar]]:
    """dC/dy as (row, column, entry), zeros left out."""
    p = joints_of(unknown, known)
    entries: list[tuple[int, int, Scalar]] = []
    for row, (a, b) in enumerate(LINKS):
        for axis, component in enumerate(minus(p[a], p[b])):
            entries.append((row, _column(a, axis), 2 * component))
            if b in JOINTS:
                entries.append((row, _column(b, axis), -2 * component))
    entries.extend((len(LINKS), _column(LOWER_BALL, axis), known.up[axis]) for axis in range(3))
    return entries


def _column(point: str, axis: int) -> int:
    return 3 * JOINTS.index(point) + axis
