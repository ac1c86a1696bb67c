"""The assembly at the end of a path, followed with a proof of every step.

Along a path, 0 <= t <= 1, the numbers of the inputs change linearly,

    C(y, w(t)) - (1 - t) c = 0,          w(t) = w0 + t (w1 - w0).

c is the residual of the drawing, zero if the drawing closes. The terms of the power series of a solution y
follow one by one: the coefficient C_k needs only the terms before y_k, and y_k = -C'^-1 C_k. Let q(u) be this
polynomial about the middle of a step, |u| <= h, and A(u) one that is nearly the inverse of C'(q(u)). It is
proven for each u that a box about q(u) contains one solution, with a regular Jacobian (see `krawczyk`): a
branch without singular poses. A body whose rotation is nearly undetermined turns far while the inputs hardly
move. As q and A follow this rotation, the box is only as wide as the error of q, and steps stay long. At the
start of the next step a far smaller box is proven to contain a solution and to lie inside the first box, so
both solutions are the same. All arithmetic is in balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat, arb_poly, ctx

from validate.reference.design import Equations
from validate.reference.errors import NotDecidedError
from validate.reference.krawczyk import Contraction, Curve, column, largest, less, newton, within
from validate.reference.vectors import Scalar

ORDER = 9  # order of the series: the error of a step goes with its length to the power ORDER + 1
SHARE = 0.4  # longest step as a share of the series' radius: 0.4^8 is 1/1500
SHORTER = 0.6  # a step that could not be proven is shortened by this factor
BOXES = (0.75, 0.5, 0.25)  # the boxes about a pose are 2^-(share of the bits) wide


@dataclass(frozen=True)
class StraightPath(Curve):
    """A straight path.

    Attributes:
        begin, end: the numbers w at its two ends.
        missed: c, or empty if it is zero.
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
        return [row - (1 - t) * c for row, c in zip(rows, self.missed, strict=True)] if self.missed else rows

    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """C'(y, w(t))."""
        return self.equations.jacobian(x, self.numbers(t))


@dataclass(frozen=True)
class Pose:
    """A proven solution on a curve: within `error` of `unknown`, and no other one within `reach`, by
    coordinate.

    Attributes:
        t: place on the curve.
        unknown: exact numbers.
        inverse: approximate inverse of the Jacobian.
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
        """Whether an enclosed solution is this one."""
        return within(solution, self.unknown, self.reach)


@dataclass(frozen=True)
class Tube:
    """A step: each box of half width `width` about the series in t - `start` holds one solution.

    Attributes:
        all_along: a box around all these boxes.
    """

    start: arb
    series: Sequence[arb_poly]
    width: Sequence[arb]
    all_along: Sequence[arb]

    def at(self, t: arb) -> list[arb]:
        """The series at t."""
        return [one(t - self.start) for one in self.series]

    def holds(self, t: arb, solution: Sequence[arb]) -> bool:
        """Whether an enclosed solution at t is the one in the tube."""
        return within(solution, self.at(t), self.width)


def start_pose(curve: Curve, near: Sequence[arb], t: arb) -> Pose:
    """The proven solution near a place.

    Raises:
        NotDecidedError: none is proven, or the Jacobian is singular to the present precision.
    """
    unknown, inverse = newton(curve, near, t)
    proof = Contraction.at(curve, unknown, t, inverse)
    # The narrowest box gives the place of the solution, the widest the distance of any other solution.
    proofs = []
    for share in BOXES:
        width = [2 * x + arb(2) ** int(-ctx.prec * share) for x in proof.missed]
        image = proof.image(width)
        if not less(image, width):
            break
        proofs.append((image, width))
    if not proofs:
        raise NotDecidedError("the image of the box about a solution", largest(image), largest(width))
    return Pose(t, unknown, proofs[0][0], proofs[-1][1], inverse)


def next_pose(curve: Curve, pose: Pose, longest: arb) -> Pose:
    """The pose one step further, proven to be on the same branch; the step is at most `longest`.

    Raises:
        NotDecidedError: the step becomes too small for the present digits.
    """
    series = series_of(curve, pose, ORDER)
    step = arb.min(arb(_reach(curve, pose, series)), longest).mid()
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
    raise NotDecidedError(f"the step at {float(pose.t):.6g} of the path", step, f"> {least.str(6)}")


def bending(curve: Curve, pose: Pose) -> float:
    """|A C''| at a pose, in doubles: Newton's method converges from all starts nearer than half its inverse
    (Kantorovich).
    """
    box = [arb(0, 1)] * len(pose.unknown)
    return float(largest((pose.inverse * (curve.bend(box) * column(box))).entries()))


def series_of(curve: Curve, pose: Pose, order: int) -> list[arb_poly]:
    """The unknowns as polynomials in t - pose.t."""
    terms, time = [[x] for x in pose.unknown], arb_poly([pose.t, 1])
    for k in range(1, order + 1):
        rows = curve.rows([arb_poly(one) for one in terms], time)
        for one, x in zip(terms, (pose.inverse * column([row[k] for row in rows])).entries(), strict=True):
            one.append(-x.mid())
    return [arb_poly(one) for one in terms]


def proven_tube(curve: Curve, start: arb, series: Sequence[arb_poly], begin: arb, stop: arb) -> Tube | None:
    """The step from `begin` to `stop` along a series about `start`; None if it cannot be proven."""
    middle = ((stop + begin) / 2).mid()
    span = arb(0, arb.max(abs(stop - middle), abs(middle - begin)).upper())
    about = [one(arb_poly([middle - start, 1])) for one in series]
    try:
        width = Contraction.along(curve, about, arb_poly([middle, 1]), span).settled()
    except NotDecidedError:
        return None
    if width is None:
        return None
    return Tube(start, series, width, [one(span) + arb(0, r) for one, r in zip(about, width, strict=True)])


def _reach(curve: Curve, pose: Pose, series: Sequence[arb_poly]) -> float:
    """Length of a step of a series, whose radius is estimated from its first and last two terms.

    The error of the series is about speed * radius * share^(ORDER + 1), and may change A C' by an eighth.
    """
    weights = [max(abs(float(one[k].mid())) for one in series) for k in (1, ORDER - 1, ORDER)]
    speed, guesses = weights[0], [1e6]
    if all(weights):
        guesses = [(speed / w) ** (1.0 / k) for w, k in zip(weights[1:], (ORDER - 2, ORDER - 1), strict=True)]
    radius = min(guesses)
    bend = max(1.0, 8.0 * speed * radius * bending(curve, pose))
    return radius * min(SHARE, float(bend ** (-1.0 / (ORDER + 1))))
