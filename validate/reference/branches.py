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

A motion can change a choice only through a singular pose (the two answers meet), so an assembly
keeps its four signs along every regular motion. That is how "the same assembly as the design" is
meant here, and why no path has to be followed. These closed forms only propose: what is returned
is proven from the equations themselves (see `certificate`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from flint import arb

from validate.reference.closures import DEFAULT
from validate.reference.equations import Known, carried_points
from validate.reference.errors import AmbiguousAssemblyError, InfeasibleError, NotDecidedError
from validate.reference.exact import as_ball
from validate.reference.knuckle_equations import AXIS, points_of_knuckle, turning
from validate.reference.vectors import Scalar, Vector, cross, dot, minus, plus, times

CLEAR_SIGN = 1e-9  # a given table is rounded to a float and need not be assembled: closer is noise


@dataclass(frozen=True)
class Choices:
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


@dataclass(frozen=True)
class Candidate:
    """One combination of choices, worked out with balls in local coordinates.

    Attributes:
        choices: the combination.
        points: all; where a closure cannot be met, the flat position that comes nearest.
        gaps: per closure, how far the link is too short: proven feasible if the ball is negative.
    """

    choices: Choices
    points: Mapping[int, Vector]
    gaps: Mapping[str, arb]

    def require_feasible(self, unit: float) -> None:
        """Pass if every closure is proven to be met.

        Raises:
            InfeasibleError: one is proven not to be; the gap is given in mm, from `unit` in mm.
            NotDecidedError: neither is proven with the present digits.
        """
        for closure, gap in self.gaps.items():
            if gap > 0:
                raise InfeasibleError(closure, float(gap.mid()) * unit)
            if not gap < 0:
                raise NotDecidedError(f"the {closure} closure, how far its link is short", gap, "< 0")


def every_candidate(known: Known) -> Iterator[Candidate]:
    """All combinations of the choices: sixteen, or eight where the rod's side is the drawing's."""
    rods = (drawn_rod(known.knuckle),) if known.closure == "drawn" else (1, -1)
    for arm, strut, rod, tie in itertools.product((1, -1), (1, -1), rods, (1, -1)):
        yield candidate(known, Choices(arm, strut, rod, tie))


def candidate(known: Known, choices: Choices) -> Candidate:
    """The points of one combination of choices."""
    length2 = known.squared_length
    p = dict(known.chassis)
    axis = minus(p[2], p[1])
    along_axis = (length2[5, 1] + dot(axis, axis) - length2[5, 2]) / 2
    from_1, arm_gap = _meet(axis, along_axis, known.up, known.arm_height, length2[5, 1], choices.arm)
    p[5] = plus(p[1], from_1)
    p[9] = minus(p[3], times(known.right, known.rack))
    complete = _as_drawn if known.closure == "drawn" else _in_line
    points, gaps = complete(p, known, choices)
    return Candidate(choices, points, {"arm": arm_gap, **gaps})


def _in_line(
    p: dict[int, Vector], known: Known, choices: Choices
) -> tuple[dict[int, Vector], dict[str, arb]]:
    """The collinear strut, the tie rod and what the knuckle carries."""
    length2 = known.squared_length
    strut = minus(p[4], p[5])
    to_top = times(strut, 1 / dot(strut, strut).sqrt())
    p[7] = plus(p[5], times(to_top, choices.strut * length2[7, 5].sqrt()))
    p[8] = minus(p[4], times(to_top, choices.rod * length2[8, 4].sqrt()))

    r7, r9 = minus(p[7], p[5]), minus(p[9], p[5])
    along_7 = (length2[6, 5] + length2[7, 5] - length2[7, 6]) / 2
    along_9 = (length2[6, 5] + dot(r9, r9) - length2[9, 6]) / 2
    from_5, tie_gap = _meet(r7, along_7, r9, along_9, length2[6, 5], choices.tie)
    p[6] = plus(p[5], from_5)
    return {**p, **carried_points(p, known)}, {"tie_rod": tie_gap}


def _as_drawn(
    p: dict[int, Vector], known: Known, choices: Choices
) -> tuple[dict[int, Vector], dict[str, arb]]:
    """The knuckle that carries its strut axis: how far the rod is out, then the turn about the line 5-4."""
    k6, k7, u = known.knuckle[6], known.knuckle[7], known.knuckle[AXIS]
    strut = minus(p[4], p[5])
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

    r9 = minus(p[9], p[5])
    along_9 = (dot(k6, k6) + dot(r9, r9) - known.squared_length[9, 6]) / 2
    from_5, tie_gap = _meet(strut, dot(k6, k4), r9, along_9, dot(k6, k6), choices.tie)
    frame = turning(k4, k6, strut, from_5)
    return points_of_knuckle(p[5], frame, known), {"strut": strut_gap, "tie_rod": tie_gap}


def drawn_rod(knuckle: Mapping[int, Vector]) -> int:
    """The side of the rod's end that is drawn, which is the only one of the drawn strut."""
    return 1 if dot(knuckle[8], knuckle[AXIS]) < 0 else -1


def choices_of(points: Mapping[int, Vector], known: Known) -> Choices:
    """The proven choices of an assembly given as balls.

    Raises:
        NotDecidedError: a sign is not certain with the present digits.
    """
    # At a pose R u is read from the rod: 7 may have passed through 4, and 8 is always on its side.
    to_top = (
        times(minus(points[8], points[4]), -drawn_rod(known.knuckle)) if known.closure == "drawn" else None
    )
    signs = {}
    for name, (value, _) in _sign_values(points, known.up, to_top).items():
        if not (value > 0 or value < 0):
            raise NotDecidedError(f"the sign of the {name} choice", value, "not 0")
        signs[name] = 1 if value > 0 else -1
    return Choices(**signs)


def choices_of_table(
    table: Mapping[int, Vector], up: Vector, closure: str = DEFAULT, clearness: float = CLEAR_SIGN
) -> Choices:
    """The choices that the given points make, which need not be assembled; fractions.

    Args:
        clearness: how far from where two assemblies meet the table must be, as a sine; 0 takes every
            sign that is not exactly zero.
    Raises:
        AmbiguousAssemblyError: the table lies (nearly) at a dead point or toggle.
    """
    to_top = minus(table[4], table[7]) if closure == "drawn" else None
    signs = {}
    for name, (value, scale2) in _sign_values(table, up, to_top).items():
        clear = float(value * value / scale2) ** 0.5 if scale2 else 0.0
        if value == 0 or clear < clearness:
            remedy = "the given points lie at a singular pose; say which assembly is wanted by a guess"
            raise AmbiguousAssemblyError(f"the sign of the {name} choice", clear, clearness, remedy)
        signs[name] = 1 if value > 0 else -1
    return Choices(**signs)


def _sign_values(
    p: Mapping[int, Vector], up: Vector, to_top: Vector | None
) -> dict[str, tuple[Scalar, Scalar]]:
    """Per choice the number whose sign it is, and the square of its scale; `to_top` is along a drawn axis."""
    axis, arm, strut = minus(p[2], p[1]), minus(p[5], p[1]), minus(p[4], p[5])
    r6, r7, r9, r8 = minus(p[6], p[5]), minus(p[7], p[5]), minus(p[9], p[5]), minus(p[8], p[4])
    along, line, base = (r7, strut, r7) if to_top is None else (to_top, to_top, strut)

    def squares(*vectors: Vector) -> Scalar:
        product = dot(vectors[0], vectors[0])
        for vector in vectors[1:]:
            product = product * dot(vector, vector)
        return product

    return {
        "arm": (dot(cross(axis, up), arm), squares(axis, up, arm)),
        "strut": (dot(along, strut), squares(along, strut)),
        "rod": (-dot(r8, line), squares(r8, line)),
        "tie": (dot(cross(base, r9), r6), squares(base, r9, r6)),
    }


def _meet(a: Vector, along_a: arb, b: Vector, along_b: arb, squared: arb, sign: int) -> tuple[Vector, arb]:
    """The x with x . a = along_a, x . b = along_b, |x|^2 = squared, det(a, b, x) of the given sign.

    x = alpha a + beta b + sign gamma (a x b). Returns x and by how much the flat part is too long;
    the square root is left out unless it is proven to be real.
    """
    aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
    determinant = aa * bb - ab * ab
    alpha = (along_a * bb - along_b * ab) / determinant
    beta = (along_b * aa - along_a * ab) / determinant
    flat = plus(times(a, alpha), times(b, beta))
    flat2 = dot(flat, flat)
    gamma2 = (squared - flat2) / determinant
    gamma = gamma2.sqrt() if gamma2 > 0 else as_ball(0)
    # |flat| - L written so that it keeps its digits when the two are nearly equal.
    gap = (flat2 - squared) / (flat2.nonnegative_part().sqrt() + squared.sqrt())
    return plus(flat, times(cross(a, b), gamma * sign)), gap
