r"""The assembly that a way leads to, followed with a proof of every step.

Along a way, 0 <= t <= 1, the numbers of the inputs run straight from one place to another,

    C(y, w(t)) - (1 - t) c = 0,          w(t) = w0 + t (w1 - w0),

and c, zero but for a drawing that does not close, is what the drawing misses. From a solution y(t0) follow
the terms of its power series one by one: the coefficient k of C needs the terms before k only, and
y_k = -C'^-1 C_k. Let q(u) be that polynomial about the middle of a step, |u| <= h, and A(u), one as well,
nearly the inverse of C'(q(u)). With these a box about q(u), for each u by itself, is proven to hold one
solution, and the Jacobian to be regular there (see `krawczyk`): a branch that meets no singular pose. A body
that hardly holds its turn turns far while the inputs hardly move. As q and A go along with it, the box need
be no wider than what q misses, and steps are as long as those of any other body. Where the next step starts,
a far smaller box is proven to hold one, and to lie inside the first: so it is the same one. All in balls.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, log

from flint import arb, arb_mat, arb_poly, ctx

from validate.reference.equations import Equations, matrix_of
from validate.reference.errors import NotDecidedError
from validate.reference.krawczyk import Contraction, System, column, largest, less, newton, within
from validate.reference.vectors import Scalar

LEAST_ORDER, MOST_ORDER = 7, 40  # of the series: more terms cost more than the longer steps save
PER_TERM = 1.4  # what a term more gains, as a logarithm: steps of e^-1.4, a quarter, of the series' radius
SHARE = 0.4  # of that radius at most, where the last terms have lost their weight: 0.4^8 is 1/1500
SHORTER = 0.6  # so much of a step that could not be proven is tried next
BOXES = (0.75, 0.5, 0.25)  # of the bits: how narrow the boxes about a pose are


class Curve(ABC):
    """Quadratic equations F(x, t) = 0 in x, as many as unknowns; t is a ball or a polynomial in balls."""

    @abstractmethod
    def rows(self, x: Sequence[Scalar], t: Scalar) -> list[Scalar]:
        """F(x, t)."""

    @abstractmethod
    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """F' as (row, column, entry), zeros left out."""

    @abstractmethod
    def bend(self, change: Sequence[arb]) -> arb_mat:
        """By how much a change of x changes F', which is linear in x."""

    def matrix(self, x: Sequence[arb], t: arb) -> arb_mat:
        """F' in balls."""
        return matrix_of(len(x), self.entries(x, t))

    def at(self, t: arb) -> System:
        """The equations at one t."""
        return System(lambda x: self.rows(x, t), lambda x: self.matrix(x, t), self.bend)


@dataclass(frozen=True)
class Way(Curve):
    """A straight way.

    Attributes:
        begin, end: the numbers w there.
        missed: c, or nothing.
    """

    equations: Equations
    begin: Sequence[arb]
    end: Sequence[arb]
    missed: Sequence[arb] = ()

    def numbers(self, t: Scalar) -> list[Scalar]:
        """w(t)."""
        return [a + (b - a) * t for a, b in zip(self.begin, self.end, strict=True)]

    def rows(self, x: Sequence[Scalar], t: Scalar) -> list[Scalar]:
        """C(y, w(t)) - (1 - t) c."""
        rows = self.equations.residual(x, self.numbers(t))
        if not self.missed:
            return rows
        return [row - (1 - t) * c for row, c in zip(rows, self.missed, strict=True)]

    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """C'(y, w(t))."""
        return self.equations.jacobian(x, self.numbers(t))

    def bend(self, change: Sequence[arb]) -> arb_mat:
        """C'' times a change of y."""
        return self.equations.bend(change)


@dataclass(frozen=True)
class Pose:
    """A solution on a curve: it lies within `error` of `unknown`, and no other within `reach`, by coordinate.

    Attributes:
        t: where on the curve.
        unknown: exact numbers.
        inverse: nearly, of the Jacobian.
    """

    t: arb
    unknown: Sequence[arb]
    error: Sequence[arb]
    reach: Sequence[arb]
    inverse: arb_mat

    @property
    def box(self) -> list[arb]:
        """The solution as balls."""
        return [arb(x, r) for x, r in zip(self.unknown, self.error, strict=True)]

    def holds(self, solution: Sequence[arb]) -> bool:
        """Whether a solution, enclosed, is this one."""
        return within(solution, self.unknown, self.reach)


@dataclass(frozen=True)
class Tube:
    """A step: each box of half width `width` about the series in t - `start` holds one solution.

    Attributes:
        all_along: a box about all of them.
    """

    start: arb
    series: Sequence[arb_poly]
    width: Sequence[arb]
    all_along: Sequence[arb]

    def at(self, t: arb) -> list[arb]:
        """The series there."""
        return [one(t - self.start) for one in self.series]

    def holds(self, t: arb, solution: Sequence[arb]) -> bool:
        """Whether a solution at t, given as a box, is the tube's."""
        return within(solution, self.at(t), self.width)


def start_pose(curve: Curve, near: Sequence[arb], t: arb) -> Pose:
    """The solution next to a place, proven.

    Raises:
        NotDecidedError: there is none so near, or the Jacobian is singular to the present precision.
    """
    system = curve.at(t)
    unknown, inverse = newton(system, near)
    proof = Contraction.at(system, unknown, inverse)
    # The narrowest box tells where the solution is, the widest how far it is from any other.
    proofs = []
    for share in BOXES:
        width = [2 * x + arb(2) ** int(-ctx.prec * share) for x in proof.missed]
        image = proof.image(width)
        if not less(image, width):
            break
        proofs.append((image, width))
    if not proofs:
        raise NotDecidedError("a solution in its box on the way, reach", largest(image), largest(width))
    return Pose(t, unknown, proofs[0][0], proofs[-1][1], inverse)


def next_pose(curve: Curve, pose: Pose, longest: arb) -> Pose:
    """One step on, proven to lead along the branch; at most so long.

    Raises:
        NotDecidedError: a step falls below the least that the present digits can carry.
    """
    series, share = _ahead(curve, pose, float(arb.min(longest, 1 - pose.t)))
    step = arb.min(arb(share), longest).mid()
    least = arb(2) ** (-ctx.prec // 3)
    while step > least:
        stop = arb.min((pose.t + step).mid(), arb(1)).mid()
        tube = proven_tube(curve, pose.t, series, pose.t, stop)
        try:
            there = None if tube is None else start_pose(curve, tube.at(stop), stop)
        except NotDecidedError:
            there = None
        if tube is not None and there is not None and tube.holds(stop, there.box):
            return there
        step = ((stop - pose.t) * SHORTER).mid()
    raise NotDecidedError(f"the way: a step at {float(pose.t):.6g} of it", step, least)


def bending(curve: Curve, pose: Pose) -> float:
    """|A C''| at a pose, in doubles: within half of its inverse Newton's method cannot leave the solution
    (Kantorovich).
    """
    box = [arb(0, 1)] * len(pose.unknown)
    return float(largest((pose.inverse * (curve.bend(box) * column(box))).entries()))


def series_of(curve: Curve, pose: Pose, order: int, begun: Sequence[arb_poly] = ()) -> list[arb_poly]:
    """The unknowns as polynomials in t less the pose's t; `begun` are their first terms, if there are any."""
    terms = [one.coeffs() for one in begun] or [[x] for x in pose.unknown]
    time = arb_poly([pose.t, 1])
    for k in range(max(map(len, terms)), order + 1):
        rows = curve.rows([arb_poly(one) for one in terms], time)
        for one, x in zip(terms, (pose.inverse * column([row[k] for row in rows])).entries(), strict=True):
            one += [arb(0)] * (k - len(one)) + [-x.mid()]
    return [arb_poly(one) for one in terms]


def proven_tube(curve: Curve, start: arb, series: Sequence[arb_poly], begin: arb, stop: arb) -> Tube | None:
    """The step from `begin` to `stop` along a series about `start`, or None if it cannot be proven."""
    middle = ((stop + begin) / 2).mid()
    span = arb(0, arb.max(abs(stop - middle), abs(middle - begin)).upper())
    about, time = [one(arb_poly([middle - start, 1])) for one in series], arb_poly([middle, 1])
    rows, entries = curve.rows(about, time), curve.entries(about, time)
    try:
        width = Contraction.along(rows, entries, curve.bend, span).settled()
    except NotDecidedError:
        return None
    if width is None:
        return None
    return Tube(start, series, width, [one(span) + arb(0, r) for one, r in zip(about, width, strict=True)])


def _ahead(curve: Curve, pose: Pose, wanted: float) -> tuple[list[arb_poly], float]:
    """The series of as many terms as it pays to have, and how far it leads.

    To `order` it misses some speed * radius * share^(order + 1), and that may bend A C' by an eighth.
    """
    series = series_of(curve, pose, LEAST_ORDER)
    speed, radius = max(abs(float(one[1])) for one in series), _radius(series)
    bend = max(1.0, 8.0 * speed * radius * bending(curve, pose))

    def reach(order: int) -> float:
        return radius * min(SHARE, float(bend ** (-1.0 / (order + 1))))

    order = LEAST_ORDER
    if reach(order) < wanted:
        order = max(order, ceil(min(log(bend) / PER_TERM, MOST_ORDER)))
        series = series_of(curve, pose, order, series)
    return series, reach(order)


def _radius(series: Sequence[arb_poly]) -> float:
    """How far the series reaches, from its last two terms against its first."""
    weights = [max(abs(float(one[k].mid())) for one in series) for k in range(LEAST_ORDER + 1)]
    guesses = [
        (weights[1] / weights[k]) ** (1.0 / (k - 1))
        for k in (LEAST_ORDER - 1, LEAST_ORDER)
        if weights[k] > 0.0 and weights[1] > 0.0
    ]
    return min(guesses, default=1e6)
