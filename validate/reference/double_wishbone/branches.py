r"""Which assemblies can exist: three yes-or-no choices, eight assemblies at most.

With theta and S given the equations fall apart into steps, each with two answers:

    arm        the lower ball joint is the point of the lower arm's circle at the height d cos(theta): ahead
    or
               behind
    upper_arm  the upper ball joint is a common point of three spheres about the upper arm's pivots and the
    lower
               ball joint: on one side of their plane
    tie        the tie rod's outer end is a common point of three spheres about the ball joints and the rack's
               end: on one side of their plane

These closed forms only propose: what is returned is proven from the equations themselves (see `certificate`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from validate.reference.carried import carried_by
from validate.reference.double_wishbone.equations import KNUCKLE
from validate.reference.double_wishbone.points import (
    INNER,
    LOWER_BALL,
    LOWER_FRONT,
    LOWER_REAR,
    OUTER,
    RACK,
    UPPER_BALL,
    UPPER_FRONT,
    UPPER_REAR,
)
from validate.reference.intersection import meet
from validate.reference.linkage import Candidate, Known, Sides
from validate.reference.linkage import Choices as AnyChoices
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, squares, times


@dataclass(frozen=True)
class Choices(AnyChoices):
    """The three choices that name an assembly, each +1 or -1.

    Attributes:
        arm: sign of det(b - a, up, l - a), a and b the lower arm's pivots, l the lower ball joint.
        upper_arm: sign of det(d - c, l - c, u - c), c and d the upper arm's pivots, u the upper ball joint.
        tie: sign of det(u - l, r - l, t - l), r and t the tie rod's inner and outer end.
    """

    arm: int
    upper_arm: int
    tie: int


def combinations(known: Known) -> Iterator[Choices]:
    """All eight."""
    for signs in itertools.product((1, -1), repeat=3):
        yield Choices(*signs)


def candidate(known: Known, choices: Choices) -> Candidate:
    """The points of one combination of choices; its closures are "arm", "upper_arm" and "tie_rod"."""
    length2, p = known.squared_length, dict(known.chassis)
    axis = minus(p[LOWER_REAR], p[LOWER_FRONT])
    reach = length2[LOWER_BALL, LOWER_FRONT]
    along = _along(reach, axis, length2[LOWER_BALL, LOWER_REAR])
    from_front, arm = meet(axis, along, known.up, known.driven["arm_angle"], reach, choices.arm)
    p[LOWER_BALL] = plus(p[LOWER_FRONT], from_front)

    axis, across = (minus(p[n], p[UPPER_FRONT]) for n in (UPPER_REAR, LOWER_BALL))
    reach = length2[UPPER_BALL, UPPER_FRONT]
    along = _along(reach, axis, length2[UPPER_BALL, UPPER_REAR])
    up_to = _along(reach, across, length2[UPPER_BALL, LOWER_BALL])
    from_front, upper_arm = meet(axis, along, across, up_to, reach, choices.upper_arm)
    p[UPPER_BALL] = plus(p[UPPER_FRONT], from_front)

    p[INNER] = minus(p[RACK], times(known.right, known.driven["rack"]))
    kingpin, inner = (minus(p[n], p[LOWER_BALL]) for n in (UPPER_BALL, INNER))
    reach = length2[OUTER, LOWER_BALL]
    along = _along(reach, kingpin, length2[OUTER, UPPER_BALL])
    up_to = _along(reach, inner, length2[OUTER, INNER])
    from_ball, tie = meet(kingpin, along, inner, up_to, reach, choices.tie)
    p[OUTER] = plus(p[LOWER_BALL], from_ball)
    points = {**p, **carried_by(KNUCKLE, p, known.knuckle)}
    return Candidate(choices, points, {"arm": arm, "upper_arm": upper_arm, "tie_rod": tie})


def drawn_sides(table: Mapping[str, Vector], up: Vector) -> Sides:
    """Of the points as drawn."""
    lower, arm = (minus(table[n], table[LOWER_FRONT]) for n in (LOWER_REAR, LOWER_BALL))
    upper, across, ball = (minus(table[n], table[UPPER_FRONT]) for n in (UPPER_REAR, LOWER_BALL, UPPER_BALL))
    kingpin, inner, outer = (minus(table[n], table[LOWER_BALL]) for n in (UPPER_BALL, INNER, OUTER))
    return {
        "arm": (dot(cross(lower, up), arm), squares(lower, up, arm)),
        "upper_arm": (dot(cross(upper, across), ball), squares(upper, across, ball)),
        "tie": (dot(cross(kingpin, inner), outer), squares(kingpin, inner, outer)),
    }


def posed_sides(points: Mapping[str, Vector], known: Known) -> Sides:
    """Of an assembly."""
    return drawn_sides(points, known.up)


def _along(reach: Scalar, to: Vector, other: Scalar) -> Scalar:
    """x . to of the points x with |x|^2 = reach and |x - to|^2 = other."""
    return (reach + dot(to, to) - other) / 2
