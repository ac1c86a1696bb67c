"""The proof that one assembly, and no other, has its points near those of a candidate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from validate.reference.design import Known
from validate.reference.errors import NotDecidedError
from validate.reference.exact import as_ball
from validate.reference.krawczyk import Contraction, bounds, column, largest, less, middle_inverse
from validate.reference.vectors import minus, plus


@dataclass(frozen=True)
class Certificate:
    """A proof that exactly one assembly exists near `centre`; local coordinates.

    Attributes:
        centre: exact middle of the box.
        radius: half the box's width in each coordinate of the points.
        enclosure: balls that contain the zero, far inside the box.
        shift: its points are at most so far from the centre's.
        condition: of the Jacobian in the maximum norm, each row scaled to unit absolute sum.
    """

    centre: Sequence[arb]
    radius: Fraction
    enclosure: Sequence[arb]
    shift: arb
    condition: float


def certify(centre: Sequence[arb], known: Known, radius: Fraction) -> Certificate:
    """Prove that exactly one assembly has its points within `radius` of the centre's (maximum norm).

    Raises:
        NotDecidedError: the proof fails, because the centre is wrong, the pose singular or digits few.
    """
    width = as_ball(radius).upper()
    # What turns follows from the points, so it need not be searched: give it room for every value that
    # points near these can have. Then "one zero in the box" is "one assembly near the points".
    there = known.equations.points_of(centre)
    fixed, off = known.mechanism.fixed, (arb(0, width),) * 3
    near = {name: place if name in fixed else plus(place, off) for name, place in there.items()}
    values = known.mechanism.unknown_of(near, known.numbers, as_ball)
    room = [abs(value - number).upper() for number, value in zip(centre, values, strict=True)]
    matrix = known.matrix(centre)
    inverse = middle_inverse(matrix)
    proof = Contraction.at(known.system, centre, inverse)
    image = proof.image(room)
    if not less(image, room):
        raise NotDecidedError("Krawczyk's image inside its box, reach from the centre", largest(image), width)
    # A step of Newton's method leads to the middle of the image, whose half width is M r.
    newton = (inverse * column(known.residual(centre))).entries()
    enclosure = [
        x - step + arb(0, (reach - missed).upper())
        for x, step, reach, missed in zip(centre, newton, image, proof.missed, strict=True)
    ]
    found = known.equations.points_of(enclosure)
    shift = largest([x for n, p in found.items() for x in minus(p, there[n])])
    if not shift < width:
        raise NotDecidedError("the points of the zero within the radius of the centre's", shift, width)
    # |D C'| |C'^-1 D^-1| with D such that the rows of D C' have unit absolute sum.
    sums = bounds(matrix.mid() * column([arb(0, 1)] * len(centre)))
    condition = max(float(x) for x in bounds(inverse * column([arb(0, x) for x in sums])))
    return Certificate(centre, radius, enclosure, shift, condition)
