r"""Newton's method for a candidate, and Krawczyk's proof that a box holds one solution and no other.

The equations F(x) = 0 are quadratic, as many as unknowns: F'(x + d) = F'(x) + F'' d. For a centre x, half
widths r and any matrix A (here nearly the inverse Jacobian), let

    eta >= |A F(x)|  and  M r >= |(I - A F'(x)) e - A (F'' d) e|  for all d, e in +- r.

If eta + M r < r then F has exactly one zero in x +- r, it lies within eta + M r of x, and F' is regular on
the whole box (R. Krawczyk 1969; R. E. Moore 1977; Neumaier, Interval Methods, 5.1). Where x, A and F are
polynomials in a parameter u, so are A F and I - A F'; they are bounded for |u| <= h term by term, and the
proof holds for each u by itself. Everything is evaluated in ball arithmetic, so it includes all rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce

from flint import arb, arb_mat, arb_poly, ctx

from validate.reference.errors import NotDecidedError

MOST_STEPS = 60  # quadratic convergence needs 5 from float accuracy; the rest is for a far guess
HOPELESS = 4  # so many times as large as before: a step of Newton's method, or a width that is to settle
TRIES = 6  # of the widths: they settle on what the equations make of them
SETTLED = 0.125  # a last term of A that changes A F' by no more leaves room in M

Entries = Sequence[tuple[int, int, arb_poly]]


@dataclass(frozen=True)
class System:
    """Quadratic equations, as many as unknowns: F(x), F'(x) and F'' d."""

    residual: Callable[[Sequence[arb]], list[arb]]
    matrix: Callable[[Sequence[arb]], arb_mat]
    bend: Callable[[Sequence[arb]], arb_mat]


@dataclass(frozen=True)
class Contraction:
    """What proves boxes about a centre, or along a curve.

    Attributes:
        missed: upper bounds on |A F|.
        defect, inverse: I - A F' and A, enclosed.
        bend: F'' d.
    """

    missed: Sequence[arb]
    defect: arb_mat
    inverse: arb_mat
    bend: Callable[[Sequence[arb]], arb_mat]

    @classmethod
    def at(cls, system: System, centre: Sequence[arb], inverse: arb_mat) -> Contraction:
        """About a centre."""
        missed = bounds(inverse * column(system.residual(centre)))
        return cls(missed, unit_matrix(len(centre)) - inverse * system.matrix(centre), inverse, system.bend)

    @classmethod
    def along(
        cls, rows: Sequence[arb_poly], entries: Entries, bend: Callable[[Sequence[arb]], arb_mat], span: arb
    ) -> Contraction:
        """Along a curve in u.

        Args:
            rows, entries: F and F' on the curve.
            span: of u, a ball about 0.
        Raises:
            NotDecidedError: F' is singular at u = 0, to the present precision.
        """
        size = len(rows)
        inverse = moving_inverse(entries, size, span.rad())
        missed = [reduce(arb_poly.__add__, map(arb_poly.__mul__, line, rows))(span) for line in inverse]
        defect = [[arb_poly([int(i == j)]) for j in range(size)] for i in range(size)]
        for line, left in zip(inverse, defect, strict=True):
            for row, j, entry in entries:
                left[j] -= line[row] * entry

        defects, inverses = (arb_mat([[x(span) for x in line] for line in of]) for of in (defect, inverse))
        return cls([x.abs_upper() for x in missed], defects, inverses, bend)

    def image(self, width: Sequence[arb]) -> list[arb]:
        """eta + M r."""
        box = [arb(0, r) for r in width]
        sides = column(box)
        spread = bounds(self.defect * sides - self.inverse * (self.bend(box) * sides))
        return [(eta + x).upper() for eta, x in zip(self.missed, spread, strict=True)]

    def settled(self, bits: float = 0.5) -> list[arb] | None:
        """Half widths of a box that is proven, not much wider than need be; None if none is found.

        Args:
            bits: share of the arithmetic's bits that the narrowest has.
        """
        width = [2 * x + arb(2) ** int(-bits * ctx.prec) for x in self.missed]
        for _ in range(TRIES):
            image = self.image(width)
            if less(image, width):
                return width
            if not largest(image) < HOPELESS * largest(width):
                return None
            width = [r if x < r else 2 * x for x, r in zip(image, width, strict=True)]
        return None


def newton(system: System, start: Sequence[arb], most: int = MOST_STEPS) -> tuple[list[arb], arb_mat]:
    """Newton's method to the present precision: exact numbers, not yet a proof, and nearly the inverse there.

    Args:
        most: steps.
    Raises:
        NotDecidedError: it does not settle, or the Jacobian is singular to the present precision.
    """
    x, last = [number.mid() for number in start], arb(2) ** ctx.prec
    good_enough = arb(2) ** (-ctx.prec // 2)  # the next step's error is the square of this one's
    for _ in range(most):
        inverse = middle_inverse(system.matrix(x))
        step = (inverse * column(system.residual(x))).entries()
        x = [(number - part).mid() for number, part in zip(x, step, strict=True)]
        size = largest(step)
        if size < good_enough:
            return x, inverse
        if not size < HOPELESS * last:
            break
        last = size
    raise NotDecidedError("Newton's method: the last correction (of the mechanism's size)", size, "0")


def moving_inverse(entries: Entries, size: int, reach: arb) -> list[list[arb_poly]]:
    """Nearly the inverse of a matrix of polynomials in u, of as many terms as |u| <= reach needs.

    From A J = I follow A_0 = J_0^-1 and A_k = -(A_0 J_k + ... + A_k-1 J_1) A_0.

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


def middle_inverse(matrix: arb_mat) -> arb_mat:
    """Nearly the inverse of a Jacobian, in exact numbers.

    Raises:
        NotDecidedError: it is singular to the present precision.
    """
    try:
        return matrix.mid().inv().mid()
    except ZeroDivisionError:
        raise NotDecidedError("the inverse of the Jacobian", "0", "not 0") from None


def column(numbers: Sequence[arb]) -> arb_mat:
    """Numbers as a matrix of one column."""
    return arb_mat(len(numbers), 1, list(numbers))


def unit_matrix(size: int) -> arb_mat:
    """I."""
    unit = arb_mat(size, size)
    for i in range(size):
        unit[i, i] = 1
    return unit


def bounds(matrix: arb_mat) -> list[arb]:
    """Upper bounds on the absolute values of the entries."""
    return [x.abs_upper() for x in matrix.entries()]


def largest(numbers: Sequence[arb]) -> arb:
    """Greatest upper bound on the absolute values; not finite if one of them is not."""
    return reduce(arb.max, (number.abs_upper() for number in numbers))


def less(image: Sequence[arb], width: Sequence[arb]) -> bool:
    """Whether each is less than its width, proven."""
    return all(x < r for x, r in zip(image, width, strict=True))


def within(solution: Sequence[arb], centre: Sequence[arb], width: Sequence[arb]) -> bool:
    """Whether a solution, enclosed, lies inside the box about a centre."""
    return less([(x - y).abs_upper() for x, y in zip(solution, centre, strict=True)], width)
