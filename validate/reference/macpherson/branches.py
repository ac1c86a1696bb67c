r"""Which assemblies can exist: yes-or-no choices, at most sixteen collinear and eight drawn assemblies.

With theta and S given the equations fall apart into steps, each with two answers. Of the collinear strut:

    arm   p5 is the point of the arm's circle at the height d_51 cos(theta): ahead or behind
    strut p7 lies d_75 from p5 on the line 4-5: towards the strut top, or away from it
    rod   p8 lies d_84 from p4 on the same line: towards the ball joint, or away from it
    tie   p6 is a common point of three spheres about p5, p7, p9: on one side of their plane

Of the strut as drawn, whose axis passes through k_7 along u in the knuckle's own frame:

    arm   as above
    strut |k_7 + s u| = |p4 - p5|, one quadratic for s: the strut top is on one side or the other of the
          point of the axis that is nearest to the ball joint
    tie   p6 is turned about the line 5-4, |p6 - p9| = d_96: on one side of the plane of 5, 4, 9

and the side of the rod is the drawing's: no equation can turn the rod's end over.

These closed forms only propose: what is returned is proven from the equations themselves (see `certificate`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from flint import arb

from validate.reference.carried import carried_by
from validate.reference.exact import as_ball
from validate.reference.intersection import meet
from validate.reference.linkage import Candidate, Known, Sides
from validate.reference.linkage import Choices as AnyChoices
from validate.reference.macpherson.collinear import KNUCKLE
from validate.reference.macpherson.drawn import AXIS, points_of_knuckle, turning
from validate.reference.macpherson.points import BALL, END, FRONT, INNER, LOWER, OUTER, RACK, REAR, TOP
from validate.reference.vectors import Vector, cross, dot, minus, plus, squares, times


@dataclass(frozen=True)
class Choices(AnyChoices):
    """The four choices that name an assembly, each +1 or -1.

    Attributes:
        arm: sign of det(p2 - p1, up, p5 - p1).
        strut: collinear: +1 if 7 lies from 5 towards the strut top; drawn: sign of (p4 - p5) . (R u).
        rod: +1 if 8 lies from 4 towards the ball joint (collinear), against R u (drawn).
        tie: sign of det(b, p9 - p5, p6 - p5), b = p7 - p5 (collinear), p4 - p5 (drawn).
    """

    arm: int
    strut: int
    rod: int
    tie: int


def collinear_combinations(known: Known) -> Iterator[Choices]:
    """All sixteen."""
    for signs in itertools.product((1, -1), repeat=4):
        yield Choices(*signs)


def drawn_combinations(known: Known) -> Iterator[Choices]:
    """All eight, with the rod on the side of the drawing."""
    rod = _drawn_rod(known)
    for arm, strut, tie in itertools.product((1, -1), repeat=3):
        yield Choices(arm, strut, rod, tie)


def collinear_candidate(known: Known, choices: Choices) -> Candidate:
    """The paper's strut: the strut's line, then the tie rod."""
    p, arm_gap = _arm_and_rack(known, choices)
    points, gaps = _in_line(p, known, choices)
    return Candidate(choices, points, {"arm": arm_gap, **gaps})


def drawn_candidate(known: Known, choices: Choices) -> Candidate:
    """The strut as drawn: how far the rod is out, then the turn about the line 5-4."""
    p, arm_gap = _arm_and_rack(known, choices)
    points, gaps = _as_drawn(p, known, choices)
    return Candidate(choices, points, {"arm": arm_gap, **gaps})


def _arm_and_rack(known: Known, choices: Choices) -> tuple[dict[str, Vector], arb]:
    """Points 5 and 9, which are the same of both struts."""
    length2 = known.squared_length
    p = dict(known.chassis)
    axis = minus(p[REAR], p[FRONT])
    along_axis = (length2[BALL, FRONT] + dot(axis, axis) - length2[BALL, REAR]) / 2
    height = known.driven["arm_angle"]
    from_1, gap = meet(axis, along_axis, known.up, height, length2[BALL, FRONT], choices.arm)
    p[BALL] = plus(p[FRONT], from_1)
    p[INNER] = minus(p[RACK], times(known.right, known.driven["rack"]))
    return p, gap


def _in_line(
    p: dict[str, Vector], known: Known, choices: Choices
) -> tuple[dict[str, Vector], dict[str, arb]]:
    """The collinear strut, the tie rod and what the knuckle carries."""
    length2 = known.squared_length
    strut = minus(p[TOP], p[BALL])
    to_top = times(strut, 1 / dot(strut, strut).sqrt())
    p[LOWER] = plus(p[BALL], times(to_top, choices.strut * length2[LOWER, BALL].sqrt()))
    p[END] = minus(p[TOP], times(to_top, choices.rod * length2[END, TOP].sqrt()))

    r7, r9 = minus(p[LOWER], p[BALL]), minus(p[INNER], p[BALL])
    along_7 = (length2[OUTER, BALL] + length2[LOWER, BALL] - length2[LOWER, OUTER]) / 2
    along_9 = (length2[OUTER, BALL] + dot(r9, r9) - length2[INNER, OUTER]) / 2
    from_5, tie_gap = meet(r7, along_7, r9, along_9, length2[OUTER, BALL], choices.tie)
    p[OUTER] = plus(p[BALL], from_5)
    return {**p, **carried_by(KNUCKLE, p, known.knuckle)}, {"tie_rod": tie_gap}


def _as_drawn(
    p: dict[str, Vector], known: Known, choices: Choices
) -> tuple[dict[str, Vector], dict[str, arb]]:
    """The knuckle that carries its strut axis: how far the rod is out, then the turn about the line 5-4."""
    k6, k7, u = known.knuckle[OUTER], known.knuckle[LOWER], known.knuckle[AXIS]
    strut = minus(p[TOP], p[BALL])
    uu, foot, squared = dot(u, u), dot(k7, u), dot(strut, strut)
    # s u + k_7 has the part s |u|^2 + k_7 . u along the axis, and the same distance from it for every s.
    beside = cross(k7, u)
    along2 = squared * uu - dot(beside, beside)
    along = along2.sqrt() if along2 > 0 else as_ball(0)
    # The distance from the axis less |strut|, written so that it keeps its digits when they are nearly equal.
    strut_gap = -along2 / (
        (dot(beside, beside).nonnegative_part().sqrt() + (squared * uu).sqrt()) * uu.sqrt()
    )
    k4 = plus(k7, times(u, (choices.strut * along - foot) / uu))

    r9 = minus(p[INNER], p[BALL])
    along_9 = (dot(k6, k6) + dot(r9, r9) - known.squared_length[INNER, OUTER]) / 2
    from_5, tie_gap = meet(strut, dot(k6, k4), r9, along_9, dot(k6, k6), choices.tie)
    frame = turning(k4, k6, strut, from_5)
    return points_of_knuckle(p[BALL], frame, known), {"strut": strut_gap, "tie_rod": tie_gap}


def collinear_drawn_sides(table: Mapping[str, Vector], up: Vector) -> Sides:
    """Of the points as drawn, for the paper's strut."""
    return _sides(table, up, None)


def collinear_posed_sides(points: Mapping[str, Vector], known: Known) -> Sides:
    """Of an assembly of the paper's strut."""
    return _sides(points, known.up, None)


def drawn_drawn_sides(table: Mapping[str, Vector], up: Vector) -> Sides:
    """Of the points as drawn, for the strut as drawn."""
    return _sides(table, up, minus(table[TOP], table[LOWER]))


def drawn_posed_sides(points: Mapping[str, Vector], known: Known) -> Sides:
    """Of an assembly of the strut as drawn."""
    # R u is read from the rod: 7 may have passed through 4, and 8 is always on its side.
    return _sides(points, known.up, times(minus(points[END], points[TOP]), -_drawn_rod(known)))


def _drawn_rod(known: Known) -> int:
    """The side of the rod's end that is drawn, which is the only one of the drawn strut."""
    return 1 if dot(known.knuckle[END], known.knuckle[AXIS]) < 0 else -1


def _sides(p: Mapping[str, Vector], up: Vector, to_top: Vector | None) -> Sides:
    """Of each choice; `to_top` is along a drawn axis."""
    axis, arm, strut = minus(p[REAR], p[FRONT]), minus(p[BALL], p[FRONT]), minus(p[TOP], p[BALL])
    r6, r7, r9 = (minus(p[n], p[BALL]) for n in (OUTER, LOWER, INNER))
    r8 = minus(p[END], p[TOP])
    along, line, base = (r7, strut, r7) if to_top is None else (to_top, to_top, strut)
    return {
        "arm": (dot(cross(axis, up), arm), squares(axis, up, arm)),
        "strut": (dot(along, strut), squares(along, strut)),
        "rod": (-dot(r8, line), squares(r8, line)),
        "tie": (dot(cross(base, r9), r6), squares(base, r9, r6)),
    }
