r"""The equations of a strut whose axis is fixed in the knuckle (closure "drawn").

The knuckle is one body. In its own frame, which has its origin in point 5 and stands as the car does in
the drawing, k_i is the place of point i, and the strut axis runs through k_7 along u, a vector from 7 to
4 as drawn. The unknowns are

    y = (p5, c1, c2, c3, s),                    13 numbers:

where point 5 is, how the knuckle is turned (R = (c1 c2 c3), a matrix by columns), and how far along its
axis the strut top is. The 13 equations C(y) = 0 are

    |p5 - p1|^2 = d_51^2                        the arm,
    |p5 - p2|^2 = d_52^2
    (p5 - p1) . up = d_51 cos(theta)
    c_i . c_j = 1 if i = j else 0               R turns and does not deform, six of i <= j
    p5 + R (k_7 + s u) - p4 = 0                 the strut top lies on the axis
    |p5 + R k_6 - p9|^2 = d_96^2                the tie rod, p9 = p3 - S right.

Then p_i = p5 + R k_i for what the knuckle carries, and p8 = p4 + R k_8 with k_8 along u, as long as d_84
and to the side on which it is drawn. Nothing here needs the ball joint off or on the axis, nor the points
5, 6 and 7 in a triangle. Every equation is at most quadratic, so the Jacobian is linear in y. The equations
also hold for the mirror image of the knuckle, det R = -1, which is no assembly: `implied` turns only, so no
certificate's box keeps to a mirrored zero.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from validate.reference.errors import BadInputError
from validate.reference.linkage import Known, Link
from validate.reference.macpherson.points import (
    BALL,
    CARRIED,
    END,
    FRONT,
    INNER,
    LOWER,
    OUTER,
    RACK,
    REAR,
    TOP,
)
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times

LINKS: tuple[Link, ...] = ((BALL, FRONT), (BALL, REAR), (END, TOP), (INNER, OUTER))
SIZE = 13  # unknowns, and equations
COORDINATES = 3  # of the unknowns are coordinates of points; the others follow from points
SLIDE = 12  # its place in y
PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # of columns of R
AXIS = TOP  # u is kept under the name of the point that it leads to

Frame = tuple[Vector, Vector, Vector]


def shape(table: Mapping[str, Vector]) -> dict[str, Vector]:
    """k_6, k_7 and those of the carried points, u, and the direction from 4 to 8 on the axis (as 8).

    u is 7-4 as drawn times a power of two, which makes it about as long as the mechanism: then s is no
    great number where 7 is drawn close to 4.

    Raises:
        BadInputError: the axis has no direction, the knuckle's points all lie on it, or the rod's end is
            drawn square to it.
    """
    places = {n: minus(table[n], table[BALL]) for n in (OUTER, LOWER, *CARRIED) if n in table}
    axis = minus(table[TOP], table[LOWER])
    longest = max(abs(x) for x in axis)
    if longest == 0:
        raise BadInputError("the strut's axis", f"{LOWER} and {TOP} in one place", f"{LOWER} below {TOP}")
    shorter = longest.denominator.bit_length() - longest.numerator.bit_length()
    axis = times(axis, Fraction(2) ** shorter)
    if all(_parallel(axis, minus(table[n], table[BALL])) for n in (OUTER, LOWER)):
        what = f"{BALL} and {OUTER} on the strut's axis"
        raise BadInputError("the knuckle", what, f"{BALL} or {OUTER} beside the axis")
    side = dot(minus(table[END], table[TOP]), axis)
    if side == 0:
        what = f"drawn square to the strut's axis at {TOP}"
        raise BadInputError(f"points[{END!r}]", what, f"a point above or below {TOP} along the axis")
    return {**places, AXIS: axis, END: axis if side > 0 else times(axis, -1)}


def points_of(unknown: Sequence[Scalar], known: Known) -> dict[str, Vector]:
    """All points."""
    return points_of_knuckle(_vector(unknown, 0), _frame(unknown), known)


def points_of_knuckle(p5: Vector, frame: Frame, known: Known) -> dict[str, Vector]:
    """All points where the knuckle has point 5 in p5 and is turned by the frame's columns."""
    carried = {n: plus(p5, turned(frame, k)) for n, k in known.knuckle.items() if n not in (AXIS, END)}
    along = known.knuckle[END]
    longer = (known.squared_length[END, TOP] / dot(along, along)).sqrt()
    p8 = plus(known.chassis[TOP], times(turned(frame, along), longer))
    return {**known.chassis, BALL: p5, **carried, END: p8, INNER: _rack_end(known)}


def turned(frame: Frame, k: Vector) -> Vector:
    """R k."""
    return plus(plus(times(frame[0], k[0]), times(frame[1], k[1])), times(frame[2], k[2]))


def knuckle_frame(unknown: Sequence[Scalar], known: Known) -> tuple[Vector, Vector]:
    """Two vectors that are fixed in the knuckle and not parallel: the first columns of R."""
    return _vector(unknown, 3), _vector(unknown, 6)


def unknown_of(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """The unknowns y of an assembly that is given by its points."""
    return [*points[BALL], *implied(points, known)]


def implied(points: Mapping[str, Vector], known: Known) -> list[Scalar]:
    """R by columns, and s, of assembled points.

    Two vectors a, b of the knuckle that are k, m in its own frame give R: it takes k, m, k x m to a, b,
    a x b. Of the pairs of r6, r7 and the rod the one is taken that errors of the points harm least.
    """
    along = known.knuckle[END]
    shorter = (dot(along, along) / known.squared_length[END, TOP]).sqrt()
    vectors = [(known.knuckle[n], minus(points[n], points[BALL])) for n in (OUTER, LOWER)]
    vectors.append((along, times(minus(points[END], points[TOP]), shorter)))
    (k, a), (m, b) = max(combinations(vectors, 2), key=lambda pair: _spread(pair[0][0], pair[1][0]))
    frame = turning(k, m, a, b)
    axis = known.knuckle[AXIS]
    slide = dot(minus(points[TOP], points[LOWER]), turned(frame, axis)) / dot(axis, axis)
    return [x for column in frame for x in column] + [slide]


def turning(k: Vector, m: Vector, a: Vector, b: Vector) -> Frame:
    """The columns of the matrix that takes k, m, k x m to a, b, a x b; the first two are not parallel."""
    normal = cross(k, m)
    area = dot(normal, normal)
    # Rows that give 1 with k, m and the normal, each 0 with the others.
    rows = [times(g, 1 / area) for g in (cross(m, normal), cross(normal, k), normal)]
    images = (a, b, cross(a, b))
    first, second, third = (
        plus(plus(times(images[0], rows[0][i]), times(images[1], rows[1][i])), times(images[2], rows[2][i]))
        for i in range(3)
    )
    return first, second, third


def residual(unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
    """C(y), 13 numbers: arm, turning, strut top, tie rod."""
    p5, frame, k = _vector(unknown, 0), _frame(unknown), known.knuckle
    rows: list[Scalar] = []
    for n in (FRONT, REAR):
        arm = minus(p5, known.chassis[n])
        rows.append(dot(arm, arm) - known.squared_length[BALL, n])
    rows.append(dot(minus(p5, known.chassis[FRONT]), known.up) - known.driven["arm_angle"])
    rows.extend(dot(frame[i], frame[j]) - int(i == j) for i, j in PAIRS)
    along = plus(turned(frame, k[LOWER]), times(turned(frame, k[AXIS]), unknown[SLIDE]))
    rows.extend(minus(plus(p5, along), known.chassis[TOP]))
    tie = minus(plus(p5, turned(frame, k[OUTER])), _rack_end(known))
    rows.append(dot(tie, tie) - known.squared_length[INNER, OUTER])
    return rows


def jacobian(unknown: Sequence[Scalar], known: Known) -> list[tuple[int, int, Scalar]]:
    """dC/dy as (row, column, entry), zeros left out."""
    p5, frame, k, slide = _vector(unknown, 0), _frame(unknown), known.knuckle, unknown[SLIDE]
    entries: list[tuple[int, int, Scalar]] = []
    for row, n in enumerate((FRONT, REAR)):
        for axis, component in enumerate(minus(p5, known.chassis[n])):
            entries.append((row, axis, 2 * component))
    for axis in range(3):
        entries.append((2, axis, known.up[axis]))
    for row, (i, j) in enumerate(PAIRS, start=3):
        for axis in range(3):
            if i == j:
                entries.append((row, _column(i, axis), 2 * frame[i][axis]))
            else:
                entries.append((row, _column(i, axis), frame[j][axis]))
                entries.append((row, _column(j, axis), frame[i][axis]))
    place, direction = plus(k[LOWER], times(k[AXIS], slide)), turned(frame, k[AXIS])
    tie = minus(plus(p5, turned(frame, k[OUTER])), _rack_end(known))
    for axis in range(3):
        entries.append((9 + axis, axis, 1))
        entries.append((9 + axis, SLIDE, direction[axis]))
        entries.append((12, axis, 2 * tie[axis]))
        for i in range(3):
            entries.append((9 + axis, _column(i, axis), place[i]))
            entries.append((12, _column(i, axis), 2 * tie[axis] * k[OUTER][i]))
    return entries


def handedness(unknown: Sequence[Scalar]) -> Scalar:
    """det R, +1 for an assembly and -1 for a mirror image of the knuckle."""
    first, second, third = _frame(unknown)
    return dot(cross(first, second), third)


def _frame(unknown: Sequence[Scalar]) -> Frame:
    return _vector(unknown, 3), _vector(unknown, 6), _vector(unknown, 9)


def _vector(unknown: Sequence[Scalar], start: int) -> Vector:
    return unknown[start], unknown[start + 1], unknown[start + 2]


def _column(i: int, axis: int) -> int:
    """The place in y of a component of a column of R."""
    return 3 + 3 * i + axis


def _rack_end(known: Known) -> Vector:
    """p9."""
    return minus(known.chassis[RACK], times(known.right, known.driven["rack"]))


def _parallel(a: Vector, b: Vector) -> bool:
    normal = cross(a, b)
    return bool(dot(normal, normal) == 0)


def _spread(k: Vector, m: Vector) -> float:
    """|k x m|^2 / (|k|^2 + |m|^2): errors of two vectors turn a body the less the greater this is."""
    normal = cross(k, m)
    return float(dot(normal, normal)) / float(dot(k, k) + dot(m, m))
