r"""The fold that a way leads into: proven, with the branch from a pose before it.

Where a way turns back, its Jacobian is singular. The fold is the zero of

    C(y, t) = 0,   C'(y, t) v = 0,   v_j = 1                            in y, v, t,

found and proven as in `krawczyk`. Past it t is no parameter of the branch, but s = y_j is: with the row
y_j = s the equations in (y, t) are a curve of their own, regular at the fold, and a tube about it (see `way`)
that holds both the pose and the fold makes the fold that pose's own. By the enclosures of dy/ds, dt/ds and
d2t/ds2 over the tube t has no other extreme there: every t between is met once before the fold, by a regular
pose, and no t beyond the fold is met.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from validate.reference.equations import matrix_of
from validate.reference.errors import NotDecidedError
from validate.reference.krawczyk import Contraction, System, column, middle_inverse, newton
from validate.reference.vectors import Scalar
from validate.reference.way import Curve, Pose, Tube, Way, proven_tube, series_of, start_pose

STEPS = 16  # of Newton's method: a guess that is good to two digits has 400 after eight
FOLD_ORDER = 3  # of the series about the fold: one of second order says which way t turns
BEYOND = 0.02  # of the way to the fold, at both ends of the tube, so that they lie inside


@dataclass(frozen=True)
class Bordered(Curve):
    """The rows C(y, t) and y_j - s in x = (y, t); s is the parameter."""

    way: Way
    index: int

    def rows(self, x: Sequence[Scalar], t: Scalar) -> list[Scalar]:
        """Both."""
        return [*self.way.rows(x[:-1], x[-1]), x[self.index] - t]

    def by_time(self, x: Sequence[Scalar]) -> list[Scalar]:
        """dC/dt: a central difference, exact as C is quadratic."""
        ahead, behind = (self.way.rows(x[:-1], x[-1] + step) for step in (1, -1))
        return [(a - b) * arb(0.5) for a, b in zip(ahead, behind, strict=True)]

    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """Of their Jacobian."""
        last = len(x) - 1
        by_time = [(i, last, one) for i, one in enumerate(self.by_time(x))]
        return [*self.way.entries(x[:-1], x[-1]), *by_time, (last, self.index, x[-1] * 0 + 1)]

    def bend(self, change: Sequence[arb]) -> arb_mat:
        """The change of a matrix that is linear in x."""
        return self.matrix(change, arb(0)) - self.matrix([arb(0)] * len(change), arb(0))


@dataclass(frozen=True)
class Fold:
    """A fold ahead of a pose, on its branch.

    Attributes:
        t: where on the way, a ball.
        unknown: there, balls.
        index: j, the unknown that is the parameter.
        tube: of (y, t) along s.
        before: s at the pose less that at the fold.
    """

    t: arb
    unknown: Sequence[arb]
    index: int
    tube: Tube
    before: arb


def fold_ahead(way: Way, pose: Pose) -> Fold | None:
    """The fold at which the branch of a pose ends, or None if none is proven."""
    try:
        start, index = _guess(way, pose)
        bordered = Bordered(way, index)
        y, t = _proven(bordered, start)
        middle = [*(x.mid() for x in y), t.mid()]
        series = series_of(bordered, start_pose(bordered, middle, middle[index]), FOLD_ORDER)
        before = (pose.unknown[index] - middle[index]).mid()
        begin, stop = middle[index] - before * BEYOND, pose.unknown[index] + before * BEYOND
        tube = proven_tube(bordered, middle[index], series, begin.mid(), stop.mid())
        ends = ([*pose.box, pose.t], [*y, t])
        held = tube is not None and all(tube.holds(x[index], x) for x in ends)
        if tube is None or not held or not t > pose.t or not _one_extreme(bordered, tube.all_along):
            return None
        return Fold(t, y, index, tube, before)
    except (ZeroDivisionError, NotDecidedError):
        return None


def pose_before(way: Way, fold: Fold, t: arb) -> Pose:
    """The pose at t on the branch before the fold, which lies beyond t.

    Raises:
        NotDecidedError: it cannot be proven with the present digits.
    """
    squared = ((fold.t - t) / -fold.tube.series[-1][2]).mid()
    if not squared > 0:
        raise NotDecidedError("the distance to the fold", squared, "> 0")
    sign = 1 if fold.before > 0 else -1
    near = fold.tube.at((fold.tube.start + sign * squared.sqrt()).mid())
    pose = start_pose(way, [x.mid() for x in near[:-1]], t)
    s = pose.box[fold.index]
    left = sign * (s - fold.unknown[fold.index])
    if not (left > 0 and left < abs(fold.before) and fold.tube.holds(s, [*pose.box, t])):
        raise NotDecidedError("the pose on the branch before the fold", left, fold.before)
    return pose


def _guess(way: Way, pose: Pose) -> tuple[list[arb], int]:
    """From the series: near a fold y = y* - A sqrt(t* - t), so t* - t = c1 / (4 c2)."""
    series = series_of(way, pose, 2)
    first = [one[1] for one in series]
    index = max(range(len(first)), key=lambda i: abs(float(first[i])))
    left = (first[index] / (4 * series[index][2])).mid()
    if not left > 0:
        raise NotDecidedError("a fold ahead", left, "> 0")
    y = [x + 2 * c * left for x, c in zip(pose.unknown, first, strict=True)]
    return [*y, *(c / first[index] for c in first), pose.t + left], index


def _proven(bordered: Bordered, start: Sequence[arb]) -> tuple[list[arb], arb]:
    """The fold: balls y, t, and v with them, that hold one and only one zero of C, C' v and v_j - 1."""
    way, size = bordered.way, bordered.way.equations.size

    def residual(x: Sequence[arb]) -> list[arb]:
        y, v, t = x[:size], x[size:-1], x[-1]
        return [*way.rows(y, t), *(way.matrix(y, t) * column(v)).entries(), v[bordered.index] - 1]

    def matrix(x: Sequence[arb]) -> arb_mat:
        y, v, t = x[:size], x[size:-1], x[-1]
        entries = bordered.entries([*y, t], t)
        # C' v is linear in y and t: its derivatives are those of the bordered rows along v.
        turned = bordered.bend([*v, arb(0)])
        place = [*range(size), 2 * size]  # of the columns of y and t
        found = [(i, place[j], one) for i, j, one in entries if i < size]
        found += [(size + i, size + j, one) for i, j, one in entries if i < size and j < size]
        found += [(size + i, k, turned[i, j]) for i in range(size) for j, k in enumerate(place)]
        return matrix_of(2 * size + 1, [*found, (2 * size, size + bordered.index, arb(1))])

    none = matrix([arb(0)] * len(start))
    rows = System(residual, matrix, lambda change: matrix(change) - none)
    centre, inverse = newton(rows, start, STEPS)
    proof = Contraction.at(rows, centre, inverse)
    width = proof.settled(0.75)
    if width is None:
        raise NotDecidedError("the fold in its box", "none", "one")
    solved = [arb(x, r) for x, r in zip(centre, proof.image(width), strict=True)]
    return solved[:size], solved[-1]


def _one_extreme(bordered: Bordered, box: Sequence[arb]) -> bool:
    """Whether d2t/ds2 is negative on the whole box.

    With B the Jacobian of the bordered rows x' = B^-1 e and x'' = -B^-1 (B'' x') x', e the last unit vector.
    """
    matrix = bordered.matrix(box, box[-1])
    inverse = middle_inverse(matrix)
    product, last = inverse * matrix, len(box) - 1
    first = product.solve(inverse * column([*([arb(0)] * last), arb(1)]))
    second = product.solve(inverse * -(bordered.bend(first.entries()) * first))
    return bool(second[last, 0] < 0)
