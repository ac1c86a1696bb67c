r"""Newton's method for a candidate, and Krawczyk's proof that one assembly is there.

For an exact centre x, a box X = x +- r and any matrix Y (here nearly the inverse Jacobian),

    K(X) = x - Y C(x) + (I - Y C'(X)) (X - x).

If K(X) lies inside X then C has exactly one zero in X, and it lies in K(X)
(R. Krawczyk 1969; R. E. Moore 1977; Neumaier, Interval Methods, 5.1). Everything is evaluated in
ball arithmetic, so the proof includes all rounding and the uncertainty of cos(theta).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

from flint import arb, arb_mat, ctx

from validate.reference.errors import NotDecidedError
from validate.reference.exact import as_ball
from validate.reference.linkage import Known
from validate.reference.vectors import minus, plus

MOST_STEPS = 60  # quadratic convergence needs 5 from float accuracy; the rest is for a far guess


@dataclass(frozen=True)
class Certificate:
    """A proof that exactly one assembly exists near `centre`; local coordinates.

    Attributes:
        centre: exact middle of the box.
        radius: half the box's width in each coordinate of the points.
        enclosure: balls that contain the zero, far inside the box.
        shift: its joints are at most so far from the centre's.
        condition: of the Jacobian, in the maximum norm, each row scaled to unit absolute sum.
    """

    centre: Sequence[arb]
    radius: Fraction
    enclosure: Sequence[arb]
    shift: arb
    condition: float


def refine(start: Sequence[arb], known: Known) -> list[arb]:
    """Newton's method to the present precision; returns exact centres, not yet a proof.

    Raises:
        NotDecidedError: it does not settle, or the Jacobian is singular to the present precision.
    """
    x = [number.mid() for number in start]
    good_enough = arb(2) ** (-ctx.prec // 2)  # the next step's error is the square of this one's
    for _ in range(MOST_STEPS):
        try:
            step = jacobian_matrix(x, known).mid().solve(_column(known.linkage.residual(x, known)))
        except ZeroDivisionError:
            raise NotDecidedError("Newton's method: the Jacobian has no inverse", "0", "not 0") from None
        corrections = step.entries()
        x = [(number - correction).mid() for number, correction in zip(x, corrections, strict=True)]
        largest = _largest(corrections)
        if largest < good_enough:
            return x
        if not largest < 2**ctx.prec:
            break
    raise NotDecidedError("Newton's method: the last correction (of the mechanism's size)", largest, "0")


def certify(centre: Sequence[arb], known: Known, radius: Fraction) -> Certificate:
    """Prove that exactly one assembly has its points within `radius` of the centre's (maximum norm).

    Raises:
        NotDecidedError: the proof fails, because the centre is wrong, the pose singular or digits few.
    """
    linkage, width = known.linkage, as_ball(radius).upper()
    box = [arb(number, width) for number in centre]
    # The other unknowns follow from the points, so they need not be searched: give them room for every
    # value that points near these can have. Then "one zero in the box" is "one assembly near the points".
    near = {
        n: p if n in linkage.chassis else plus(p, (arb(0, width),) * 3)
        for n, p in linkage.points_of(centre, known).items()
    }
    for place, value in enumerate(linkage.implied(near, known), start=linkage.coordinates):
        box[place] = arb(centre[place], abs(value - centre[place]).upper())

    at_centre = jacobian_matrix(centre, known).mid()
    try:
        inverse = at_centre.inv().mid()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian", "0", "not 0") from None
    newton = inverse * _column(linkage.residual(centre, known))
    contraction = _identity(linkage.size) - inverse * jacobian_matrix(box, known)
    spread = contraction * _column([side - number for side, number in zip(box, centre, strict=True)])
    enclosure = [number - newton[i, 0] + spread[i, 0] for i, number in enumerate(centre)]
    for number, side, image in zip(centre, box, enclosure, strict=True):
        if not side.contains_interior(image):
            reach = (image - number).abs_upper()
            raise NotDecidedError("Krawczyk's image inside its box, reach from the centre", reach, side.rad())
    there, here = (linkage.points_of(y, known) for y in (enclosure, centre))
    shift = _largest([x for n in linkage.joints for x in minus(there[n], here[n])])
    if not shift < width:
        raise NotDecidedError("the points of the zero within the radius of the centre's", shift, width)
    return Certificate(centre, radius, enclosure, shift, _condition(at_centre, inverse))


def jacobian_matrix(unknown: Sequence[arb], known: Known) -> arb_mat:
    """dC/dy as a square matrix of balls."""
    linkage = known.linkage
    matrix = arb_mat(linkage.size, linkage.size)
    for row, column, entry in linkage.jacobian(unknown, known):
        matrix[row, column] = entry
    return matrix


def _condition(matrix: arb_mat, inverse: arb_mat) -> float:
    """|D C'| |C'^-1 D^-1| with D such that the rows of D C' have unit absolute sum."""
    row_sums = [sum((abs(entry) for entry in row), arb(0)) for row in matrix.tolist()]
    return max(
        float(sum((abs(entry) * row_sums[i] for i, entry in enumerate(row)), arb(0)).mid())
        for row in inverse.tolist()
    )


def _column(numbers: Sequence[arb]) -> arb_mat:
    return arb_mat(len(numbers), 1, list(numbers))


def _identity(size: int) -> arb_mat:
    return arb_mat([[int(i == j) for j in range(size)] for i in range(size)])


def _largest(numbers: Sequence[arb]) -> arb:
    """Greatest upper bound; not finite if one of them is not."""
    return reduce(arb.max, (number.abs_upper() for number in numbers))
