"""The fold at the end of a path, proven together with the branch that leads to it.

Where a path turns back, its Jacobian is singular. There t cannot be the parameter of the branch, but s = y_j
can: with the row y_j = s the equations in (y, t) define a curve that is regular at the fold, where dt/ds = 0.
Newton's method finds this s. If a tube about this curve (see `path`) contains the pose and the fold, the fold
is on the pose's branch. If d2t/ds2 < 0 on the whole tube, t has no other extremum there: each t between them
belongs to one regular pose before the fold, and there is no pose beyond the fold. With d2t/ds2 <= -m and
dt/ds = e at some s, the fold is at most |e| / m from this s, and its t is higher by at most e^2 / 2m.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, ctx

from validate.reference.errors import NotDecidedError
from validate.reference.krawczyk import Curve, column, middle_inverse
from validate.reference.path import Pose, StraightPath, Tube, proven_tube, series_of, start_pose
from validate.reference.vectors import Scalar

STEPS = 16  # of Newton's method: from a guess with two correct digits, eight steps give 400
FOLD_ORDER = 3  # of the series about the fold: the second order gives the sense in which t turns
BEYOND = 0.02  # share of the distance to the fold added at both ends of the tube, so that both lie inside


@dataclass(frozen=True)
class Bordered(Curve):
    """The rows C(y, t) and y_j - s in x = (y, t), with the parameter s."""

    path: StraightPath
    index: int

    def rows(self, x: Sequence[Scalar], t: Scalar) -> list[Scalar]:
        """C(y, t) and y_j - s."""
        return [*self.path.rows(x[:-1], x[-1]), x[self.index] - t]

    def entries(self, x: Sequence[Scalar], t: Scalar) -> list[tuple[int, int, Scalar]]:
        """Entries of the Jacobian; dC/dt is a central difference, exact because C is quadratic."""
        last = len(x) - 1
        ahead, behind = (self.path.rows(x[:-1], x[-1] + step) for step in (1, -1))
        by_time = [(i, last, (a - b) * arb(0.5)) for i, (a, b) in enumerate(zip(ahead, behind, strict=True))]
        return [*self.path.entries(x[:-1], x[-1]), *by_time, (last, self.index, x[-1] * 0 + 1)]

    def rates(self, box: Sequence[arb]) -> tuple[arb, arb]:
        """dt/ds and d2t/ds2 in a box.

        With B the Jacobian x' = B^-1 e and x'' = -B^-1 (B'' x') x', e the last unit vector.
        """
        matrix, last = self.matrix(box, box[-1]), len(box) - 1
        inverse = middle_inverse(matrix)
        product = inverse * matrix
        first = product.solve(inverse * column([*([arb(0)] * last), arb(1)]))
        second = product.solve(inverse * -(self.bend(first.entries()) * first))
        return first[last, 0], second[last, 0]


@dataclass(frozen=True)
class Fold:
    """A fold ahead of a pose, on its branch.

    Attributes:
        t, s: place on the path and y_j there, balls.
        index: j.
        tube: tube of (y, t) along s.
        before: s at the pose minus s at the fold.
    """

    t: arb
    s: arb
    index: int
    tube: Tube
    before: arb


def fold_ahead(path: StraightPath, pose: Pose) -> Fold | None:
    """The fold at which the branch of a pose ends; None if none is proven."""
    try:
        near, index = _guess(path, pose)
        bordered = Bordered(path, index)
        top = _turning(bordered, near)
        before = (pose.unknown[index] - top.t).mid()
        begin, stop = top.t - before * BEYOND, pose.unknown[index] + before * BEYOND
        tube = proven_tube(bordered, top.t, series_of(bordered, top, FOLD_ORDER), begin.mid(), stop.mid())
        if tube is None or not all(tube.holds(x[index], x) for x in (top.box, [*pose.box, pose.t])):
            return None
        slope, bend = bordered.rates(top.box)[0], bordered.rates(tube.all_along)[1]
        off = abs(slope / bend).upper()
        t, s = top.box[-1] - (slope * slope / (2 * bend)).union(arb(0)), top.t + arb(0, off)
        if not (bend < 0 and off < abs(before) * BEYOND and t > pose.t):
            return None
        return Fold(t, s, index, tube, before)
    except (ZeroDivisionError, NotDecidedError):
        return None


def pose_before(path: StraightPath, fold: Fold, t: arb) -> Pose:
    """The pose at t on the branch before the fold; the fold lies beyond t.

    Raises:
        NotDecidedError: the pose cannot be proven with the present digits.
    """
    squared = ((fold.t - t) / -fold.tube.series[-1][2]).mid()
    if not squared > 0:
        raise NotDecidedError("the distance to the fold", squared, "> 0")
    sign = 1 if fold.before > 0 else -1
    near = fold.tube.at((fold.tube.start + sign * squared.sqrt()).mid())
    pose = start_pose(path, [x.mid() for x in near[:-1]], t)
    s = pose.box[fold.index]
    left = sign * (s - fold.s)
    if not (left > 0 and left < abs(fold.before) and fold.tube.holds(s, [*pose.box, t])):
        raise NotDecidedError("the pose on the branch before the fold", left, fold.before)
    return pose


def _guess(path: StraightPath, pose: Pose) -> tuple[list[arb], int]:
    """A guess of (y, t) at the fold, and j: near a fold y = y* - A sqrt(t* - t), so t* - t = c1 / (4 c2)."""
    series = series_of(path, pose, 2)
    first = [one[1] for one in series]
    index = max(range(len(first)), key=lambda i: abs(float(first[i])))
    left = (first[index] / (4 * series[index][2])).mid()
    if not left > 0:
        raise NotDecidedError("a fold ahead", left, "> 0")
    return [*(x + 2 * c * left for x, c in zip(pose.unknown, first, strict=True)), pose.t + left], index


def _turning(bordered: Bordered, near: Sequence[arb]) -> Pose:
    """The pose at which dt/ds = 0, to half the digits in s and all digits in t."""
    s = near[bordered.index].mid()
    for _ in range(STEPS):
        top = start_pose(bordered, near, s)
        series = series_of(bordered, top, 2)
        step = (series[-1][1] / (-2 * series[-1][2])).mid()
        if abs(step) < arb(2) ** (-ctx.prec // 2):
            return top
        s = (s + step).mid()
        near = [(one[0] + one[1] * step).mid() for one in series]
    raise NotDecidedError("Newton's method: the last correction of the fold's s", step, "0")
