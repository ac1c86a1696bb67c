r"""Which assemblies can exist: four yes-or-no choices, at most sixteen assemblies.

With theta and S given the equations fall apart into steps, each with two answers:

    arm   p5 is the point of the arm's circle at the height d_51 cos(theta): ahead or behind
    strut p7 lies d_75 from p5 on the line 4-5: towards the strut top, or away from it
    rod   p8 lies d_84 from p4 on the same line: towards the ball joint, or away from it
    tie   p6 is a common point of three spheres about p5, p7, p9: on one side of their plane

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

from validate.truth.equations import Known
from validate.truth.errors import AmbiguousAssemblyError, InfeasibleError, NotDecidedError
from validate.truth.exact import as_ball
from validate.truth.vectors import Scalar, Vector, cross, dot, minus, plus, times

CLEAR_SIGN = 1e-9  # a given table is rounded to a float and need not be assembled: closer is noise


@dataclass(frozen=True)
class Choices:
    """The four choices that name an assembly, each +1 or -1.

    Attributes:
        arm: sign of det(p2 - p1, up, p5 - p1).
        strut: +1 if 7 lies from 5 towards the strut top.
        rod: +1 if 8 lies from 4 towards the ball joint.
        tie: sign of det(p7 - p5, p9 - p5, p6 - p5).
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
        points: 1 to 9; where a closure cannot be met, the flat position that comes nearest.
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
    """All sixteen combinations of the choices."""
    for signs in itertools.product((1, -1), repeat=4):
        yield candidate(known, Choices(*signs))


def candidate(known: Known, choices: Choices) -> Candidate:
    """The points of one combination of choices."""
    length2 = known.squared_length
    p = dict(known.chassis)

    axis = minus(p[2], p[1])
    along_axis = (length2[5, 1] + dot(axis, axis) - length2[5, 2]) / 2
    from_1, arm_gap = _meet(axis, along_axis, known.up, known.arm_height, length2[5, 1], choices.arm)
    p[5] = plus(p[1], from_1)

    strut = minus(p[4], p[5])
    to_top = times(strut, 1 / dot(strut, strut).sqrt())
    p[7] = plus(p[5], times(to_top, choices.strut * length2[7, 5].sqrt()))
    p[8] = minus(p[4], times(to_top, choices.rod * length2[8, 4].sqrt()))

    p[9] = minus(p[3], times(known.right, known.rack))
    r7, r9 = minus(p[7], p[5]), minus(p[9], p[5])
    along_7 = (length2[6, 5] + length2[7, 5] - length2[7, 6]) / 2
    along_9 = (length2[6, 5] + dot(r9, r9) - length2[9, 6]) / 2
    from_5, tie_gap = _meet(r7, along_7, r9, along_9, length2[6, 5], choices.tie)
    p[6] = plus(p[5], from_5)
    return Candidate(choices, p, {"arm": arm_gap, "tie_rod": tie_gap})


def choices_of(points: Mapping[int, Vector], up: Vector) -> Choices:
    """The proven choices of an assembly given as balls.

    Raises:
        NotDecidedError: a sign is not certain with the present digits.
    """
    signs = {}
    for name, (value, _) in _sign_values(points, up).items():
        if not (value > 0 or value < 0):
            raise NotDecidedError(f"the sign of the {name} choice", value, "not 0")
        signs[name] = 1 if value > 0 else -1
    return Choices(**signs)


def choices_of_table(table: Mapping[int, Vector], up: Vector) -> Choices:
    """The choices that the given points make, which need not be assembled; fractions.

    Raises:
        AmbiguousAssemblyError: the table lies (nearly) at a dead point or toggle.
    """
    signs = {}
    for name, (value, scale2) in _sign_values(table, up).items():
        clearness = float(value * value / scale2) ** 0.5 if scale2 else 0.0
        if clearness < CLEAR_SIGN:
            remedy = "the given points lie at a singular pose; say which assembly is wanted by a guess"
            raise AmbiguousAssemblyError(f"the sign of the {name} choice", clearness, CLEAR_SIGN, remedy)
        signs[name] = 1 if value > 0 else -1
    return Choices(**signs)


def _sign_values(p: Mapping[int, Vector], up: Vector) -> dict[str, tuple[Scalar, Scalar]]:
    """Per choice the number whose sign it is, and the square of its scale."""
    axis, arm, strut = minus(p[2], p[1]), minus(p[5], p[1]), minus(p[4], p[5])
    r6, r7, r9, r8 = minus(p[6], p[5]), minus(p[7], p[5]), minus(p[9], p[5]), minus(p[8], p[4])

    def squares(*vectors: Vector) -> Scalar:
        product = dot(vectors[0], vectors[0])
        for vector in vectors[1:]:
            product = product * dot(vector, vector)
        return product

    return {
        "arm": (dot(cross(axis, up), arm), squares(axis, up, arm)),
        "strut": (dot(r7, strut), squares(r7, strut)),
        "rod": (-dot(r8, strut), squares(r8, strut)),
        "tie": (dot(cross(r7, r9), r6), squares(r7, r9, r6)),
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
