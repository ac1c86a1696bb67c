"""Where three spheres, or two planes and a sphere, meet."""

from __future__ import annotations

from flint import arb

from validate.reference.exact import as_ball
from validate.reference.vectors import Vector, cross, dot, plus, times


def meet(a: Vector, along_a: arb, b: Vector, along_b: arb, squared: arb, sign: int) -> tuple[Vector, arb]:
    """The x with x . a = along_a, x . b = along_b, |x|^2 = squared, det(a, b, x) of the given sign.

    x = alpha a + beta b + sign gamma (a x b). Of three spheres a and b lead from one centre to the others,
    and along_a = (squared + |a|^2 - r_a^2) / 2.

    Returns:
        x, and by how much the flat part is too long; the square root is left out unless it is proven to be
        real.
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
