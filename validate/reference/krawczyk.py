"""Newton's method for a candidate, and Krawczyk's proof that a box contains exactly one solution.

The equations F(x, t) = 0 are quadratic in x, as many as unknowns: F'(x + d) = F'(x) + F'' d. For a centre x,
half widths r and any matrix A (here nearly the inverse Jacobian), let

    eta >= |A F(x)|  and  M r >= |(I - A F'(x)) e - A (F'' d) e|  for all d, e in +- r.

If eta + M r < r, then F has exactly one zero in x +- r, it lies within eta + M r of x, and F' is regular on
the whole box (R. Krawczyk 1969; R. E. Moore 1977; Neumaier, Interval Methods, 5.1). For complex numbers the
box is a product of discs. If x, A and F are polynomials in a parameter u, A F and I - A F' are bounded for
|u| <= h term by term, and the proof holds for each u separately. Ball arithmetic includes all rounding.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

from flint import acb, acb_mat, arb, arb_mat, arb_poly, ctx

from validate.reference.errors import NotDecidedError
from validate.reference.vectors import Scalar

MOST_STEPS = 60  # quadratic convergence from double accuracy needs 5 steps; the rest is for a distant start
HOPELESS = 4  # growth of a Newton step or of a box width at which the iteration is given up
TRIES = 6  # number of widths tried for a box
SETTLED = 0.125  # terms of A's series that change A F' by less are left out: M stays small enough

Entries = Sequence[tuple[int, int, arb_poly]]
Matrix = Any
"""A matrix of balls, `arb_mat`, or of complex balls, `acb_mat`."""


class Curve(ABC):
    """Quadratic equations F(x, t) = 0, as many as unknowns x; t is a ball or a polynomial of balls."""

    @abstractmethod
    def rows(self, x: Sequence[Scalar], t: Scalar) -> list[Scalar]:
        """F(x, t)."""

    @abstractmethod
    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """Nonzero entries of F' as (row, column, entry)."""

    def matrix(self, x: Sequence[Scalar], t: Scalar) -> Matrix:
        """F' as a matrix of balls."""
        return matrix_of(len(x), self.entries(x, t))

    def bend(self, change: Sequence[Scalar]) -> Matrix:
        """F'' d, the change of F' for a change d of x; F' is linear in x."""
        return self.matrix(change, arb(0)) - self.matrix([x * 0 for x in change], arb(0))


@dataclass(frozen=True)
class Contraction:
    """Data for the proof of boxes about a centre, or along a curve.

    Attributes:
        missed: eta, upper bounds on |A F|.
        defect, inverse: enclosures of I - A F' and of A.
        bend: function of d that gives F'' d.
    """

    missed: Sequence[arb]
    defect: Matrix
    inverse: Matrix
    bend: Callable[[Sequence[Scalar]], Matrix]

    @classmethod
    def at(cls, curve: Curve, centre: Sequence[Scalar], t: Scalar, inverse: Matrix) -> Contraction:
        """For boxes about a centre."""
        missed = bounds(inverse * column(curve.rows(centre, t)))
        unit = matrix_of(len(centre), ((i, i, x * 0 + 1) for i, x in enumerate(centre)))
        return cls(missed, unit - inverse * curve.matrix(centre, t), inverse, curve.bend)

    @classmethod
    def along(cls, curve: Curve, about: Sequence[arb_poly], time: arb_poly, span: arb) -> Contraction:
        """For boxes along a curve, a polynomial in u.

        Args:
            about, time: x and t as polynomials in u.
            span: range of u, a ball about 0.
        Raises:
            NotDecidedError: F' is singular at u = 0, to the present precision.
        """
        rows, entries, size = curve.rows(about, time), curve.entries(about, time), len(about)
        inverse = _moving_inverse(entries, size, span.rad())
        missed = [reduce(arb_poly.__add__, map(arb_poly.__mul__, line, rows))(span) for line in inverse]
        defect = [[arb_poly([int(i == j)]) for j in range(size)] for i in range(size)]
        for line, left in zip(inverse, defect, strict=True):
            for row, j, entry in entries:
                left[j] -= line[row] * entry

        defects, inverses = (arb_mat([[x(span) for x in line] for line in of]) for of in (defect, inverse))
        return cls([x.abs_upper() for x in missed], defects, inverses, curve.bend)

    def image(self, width: Sequence[arb]) -> list[arb]:
        """eta + M r, for half widths r."""
        box: list[Scalar] = [arb(0, r) for r in width]
        if isinstance(self.inverse, acb_mat):
            box = [acb(side, side) for side in box]
        sides = column(box)
        spread = bounds(self.defect * sides - self.inverse * (self.bend(box) * sides))
        return [(eta + x).upper() for eta, x in zip(self.missed, spread, strict=True)]

    def settled(self) -> list[arb] | None:
        """Half widths of a proven box, little wider than necessary; None if none is found."""
        width = [2 * x + arb(2) ** (-ctx.prec // 2) for x in self.missed]
        for _ in range(TRIES):
            image = self.image(width)
            if less(image, width):
                return width
            if not largest(image) < HOPELESS * largest(width):
                return None
            width = [r if x < r else 2 * x for x, r in zip(image, width, strict=True)]
        return None


def newton(curve: Curve, start: Sequence[Scalar], t: Scalar) -> tuple[list[Scalar], Matrix]:
    """Newton's method to the present precision, without a proof.

    Returns:
        The solution in exact numbers, and the approximate inverse of the Jacobian there.
    Raises:
        NotDecidedError: it does not converge, or the Jacobian is singular to the present precision.
    """
    x, last = [number.mid() for number in start], arb(2) ** ctx.prec
    good_enough = arb(2) ** (-ctx.prec // 2)  # the error after this step is about its square
    for _ in range(MOST_STEPS):
        inverse = middle_inverse(curve.matrix(x, t))
        step = (inverse * column(curve.rows(x, t))).entries()
        x = [(number - part).mid() for number, part in zip(x, step, strict=True)]
        size = largest(step)
        if size < good_enough:
            return x, inverse
        if not size < HOPELESS * last:
            break
        last = size
    raise NotDecidedError("Newton's method: the last correction (of the mechanism's size)", size, "0")


def _moving_inverse(entries: Entries, size: int, reach: arb) -> list[list[arb_poly]]:
    """Approximate inverse of a matrix of polynomials in u, with the terms that |u| <= reach needs.

    A J = I gives A_0 = J_0^-1 and A_k = -(A_0 J_k + ... + A_k-1 J_1) A_0.

    Raises:
        NotDecidedError: J_0 is singular to the present precision.
    """
    count = max(entry.length() for *_, entry in entries)
    matrices = [arb_mat(size, size) for _ in range(count)]
    for i, j, entry in entries:
        for k, coefficient in enumerate(entry.coeffs()):
            matrices[k][i, j] = coefficient.mid()
    terms = [middle_inverse(matrices[0])]
    for k in range(1, count):
        turn = reduce(arb_mat.__add__, (terms[i] * matrices[k - i] for i in range(k)))
        if largest((turn * column([arb(0, reach**k)] * size)).entries()) < SETTLED:
            break
        terms.append(-(turn * terms[0]).mid())
    flat = [arb_poly(list(one)) for one in zip(*(term.entries() for term in terms), strict=True)]
    return [flat[i : i + size] for i in range(0, size * size, size)]


def middle_inverse(matrix: Matrix) -> Matrix:
    """Approximate inverse of a Jacobian, in exact numbers.

    Raises:
        NotDecidedError: the Jacobian is singular to the present precision.
    """
    try:
        return matrix.mid().inv().mid()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian", "0", "not 0") from None


def matrix_of(size: int, entries: Iterable[tuple[int, int, Scalar]]) -> Matrix:
    """A square matrix from its nonzero entries."""
    rows: list[list[Scalar]] = [[0] * size for _ in range(size)]
    for i, j, entry in entries:
        rows[i][j] = entry
    return (acb_mat if any(isinstance(x, acb) for row in rows for x in row) else arb_mat)(rows)


def column(numbers: Sequence[Scalar]) -> Matrix:
    """Numbers as a matrix of one column."""
    kind = acb_mat if any(isinstance(x, acb) for x in numbers) else arb_mat
    return kind(len(numbers), 1, list(numbers))


def bounds(matrix: Matrix) -> list[arb]:
    """Upper bounds on the absolute values of the entries."""
    return [x.abs_upper() for x in matrix.entries()]


def largest(numbers: Sequence[Scalar]) -> arb:
    """Largest of the upper bounds on the absolute values; not finite if one bound is not."""
    found: arb = reduce(arb.max, [number.abs_upper() for number in numbers])
    return found


def less(image: Sequence[arb], width: Sequence[arb]) -> bool:
    """Whether each number is proven to be less than its width."""
    return all(x < r for x, r in zip(image, width, strict=True))


def within(solution: Sequence[Scalar], centre: Sequence[Scalar], width: Sequence[arb]) -> bool:
    """Whether an enclosed solution is proven to lie inside the box about a centre."""
    return less([(x - y).abs_upper() for x, y in zip(solution, centre, strict=True)], width)
