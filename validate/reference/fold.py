r"""The fold that a way leads into: proven, with the branch from a pose before it.

Where a way turns back, its Jacobian is singular. The fold is the zero of

    C(y, t) = 0,   C'(y, t) v = 0,   v_j = 1                            in y, v, t,

found and proven as in `krawczyk`. Past it t is no parameter of the branch, but y_j is: with the row y_j = s
the system in (y, t) is regular, and a box about q(s), the branch to second order about the fold, is proven to
hold one solution for each s from the pose to the fold, as in `way`. So the fold is that pose's own. By the
enclosures of dy/ds, dt/ds and d2t/ds2 over the box t has no other extreme there: every t between is met once
before the fold, by a regular pose, and no t beyond the fold is met.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import arb, arb_mat, arb_poly

from validate.reference.errors import NotDecidedError
from validate.reference.krawczyk import Contraction, System, column, middle_inverse, newton, within
from validate.reference.vectors import Scalar
from validate.reference.way import Pose, Way, series_of, start_pose

STEPS = 16  # of Newton's method: a guess that is good to two digits has 400 after eight


@dataclass(frozen=True)
class Fold:
    """A fold ahead of a pose, on its branch.

    Attributes:
        t: where on the way, a ball.
        unknown: there, balls.
        index: j, the unknown that is the parameter.
        curve: q and t as polynomials in s less its value at the fold.
        width: of the box about them, t's last.
        before: s at the pose less that at the fold.
    """

    t: arb
    unknown: Sequence[arb]
    index: int
    curve: Sequence[arb_poly]
    width: Sequence[arb]
    before: arb


def fold_ahead(way: Way, pose: Pose) -> Fold | None:
    """The fold at which the branch of a pose ends, or None if none is proven."""
    try:
        start, index = _guess(way, pose)
        solved = _proven(fold_rows(way, index), start)
        t = solved[-1]
        return _joined(way, pose, solved, index) if t > pose.t else None
    except (ZeroDivisionError, NotDecidedError):
        return None


def pose_before(way: Way, fold: Fold, t: arb) -> Pose:
    """The pose at t on the branch before the fold, which lies beyond t.

    Raises:
        NotDecidedError: it cannot be proven with the present digits.
    """
    bend = -fold.curve[-1][2]
    s = ((fold.t - t) / bend).mid()
    if not s > 0:
        raise NotDecidedError("the distance to the fold", s, "> 0")
    s = s.sqrt() if fold.before > 0 else -s.sqrt()
    pose = start_pose(way, [one(s.mid()) for one in fold.curve[:-1]], t)
    at = pose.box[fold.index] - fold.unknown[fold.index]
    between = abs(at) < abs(fold.before) and (at > 0 if fold.before > 0 else at < 0)
    near = within([*pose.box, t], [one(at) for one in fold.curve], fold.width)
    if not (between and near):
        raise NotDecidedError("the pose on the branch before the fold", at, fold.before)
    return pose


def fold_rows(way: Way, index: int) -> System:
    """The rows C, C' v and v_j - 1, whose zero is a fold, in x = (y, v, t)."""
    size = way.equations.size

    def residual(x: Sequence[arb]) -> list[arb]:
        y, v, t = x[:size], x[size:-1], x[-1]
        return [*way.rows(y, t), *(way.matrix(y, t) * column(v)).entries(), v[index] - 1]

    def matrix(x: Sequence[arb]) -> arb_mat:
        y, v, t = x[:size], x[size:-1], x[-1]
        jacobian, bend = way.matrix(y, t), way.equations.bend(v)
        by_time, turned = way.by_time(y, t), (way.bend_by_time() * column(v)).entries()
        matrix = arb_mat(2 * size + 1, 2 * size + 1)
        for i in range(size):
            for j in range(size):
                matrix[i, j] = matrix[size + i, size + j] = jacobian[i, j]
                matrix[size + i, j] = bend[i, j]
            matrix[i, 2 * size], matrix[size + i, 2 * size] = by_time[i], turned[i]
        matrix[2 * size, size + index] = arb(1)
        return matrix

    return System(residual, matrix, _change_of(matrix))


@dataclass(frozen=True)
class Bordered:
    """The rows C(y, t) and y_j = s, in (y, t)."""

    way: Way
    index: int

    def entries(self, x: Sequence[Scalar]) -> list[tuple[int, int, Scalar]]:
        """Of their Jacobian."""
        y, t = x[:-1], x[-1]
        by_time = [(i, len(y), one) for i, one in enumerate(self.way.by_time(y, t))]
        return [*self.way.entries(y, t), *by_time, (len(y), self.index, t * 0 + 1)]

    def matrix(self, x: Sequence[arb]) -> arb_mat:
        """The same of balls."""
        matrix = arb_mat(len(x), len(x))
        for i, j, entry in self.entries(x):
            matrix[i, j] = entry
        return matrix


def _change_of(matrix: Callable[[Sequence[arb]], arb_mat]) -> Callable[[Sequence[arb]], arb_mat]:
    """What a change of x changes of a matrix that is linear in x."""
    return lambda d: matrix(d) - matrix([arb(0)] * len(d))


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


def _proven(rows: System, start: Sequence[arb]) -> list[arb]:
    """The fold: balls that hold one and only one zero."""
    centre, inverse = newton(rows, start, STEPS)
    proof = Contraction.at(rows, centre, inverse)
    width = proof.settled(0.75)
    if width is None:
        raise NotDecidedError("the fold in its box", "none", "one")
    return [arb(x, r) for x, r in zip(centre, proof.image(width), strict=True)]


def _joined(way: Way, pose: Pose, solved: Sequence[arb], index: int) -> Fold | None:
    """The fold with the box that leads to it from the pose, or None if the box is too wide for a proof."""
    size, bordered = way.equations.size, Bordered(way, index)
    y, v, t = solved[:size], solved[size:-1], solved[-1]
    middle = [x.mid() for x in y]
    inverse = middle_inverse(bordered.matrix([*middle, t.mid()]))
    # At the fold dt/ds = 0 and dy/ds = v; the second derivatives follow from C differentiated twice.
    twice = (inverse * column([*(-(way.equations.bend(v) * column(v))).entries(), arb(0)])).entries()
    first = [*(b.mid() for b in v), arb(0)]
    curve = [arb_poly([a, b, c.mid() / 2]) for a, b, c in zip([*middle, t.mid()], first, twice, strict=True)]
    curve[index] = arb_poly([middle[index], 1])
    before = (pose.unknown[index] - middle[index]).mid()
    half = (before / 2).mid()
    span = arb(0, (abs(half) * arb(1.02)).upper())  # a little beyond both ends, so that they lie inside
    about = [one(arb_poly([half, 1])) for one in curve]
    rows = [*way.rows(about[:-1], about[-1]), arb_poly([])]
    proof = Contraction.along(rows, bordered.entries(about), _change_of(bordered.matrix), span)
    width = proof.settled()
    if width is None:
        return None
    start = [*pose.box, pose.t]
    at = start[index] - middle[index]
    box = [one(span) + arb(0, r) for one, r in zip(about, width, strict=True)]
    if not (within(start, [one(at) for one in curve], width) and _one_extreme(bordered, box)):
        return None
    return Fold(t, y, index, curve, width, before)


def _one_extreme(bordered: Bordered, box: Sequence[arb]) -> bool:
    """Whether d2t/ds2 is negative on the whole box."""
    way, size = bordered.way, len(box) - 1
    matrix = bordered.matrix(box)
    inverse = middle_inverse(matrix)
    product = inverse * matrix
    first = product.solve(inverse * column([*([arb(0)] * size), arb(1)])).entries()
    dy, dt = first[:size], first[size]
    bent = (way.equations.bend(dy) * column(dy)).entries()
    twisted = (way.bend_by_time() * column(dy)).entries()
    second = [-x - 2 * z * dt for x, z in zip(bent, twisted, strict=True)]
    return bool(product.solve(inverse * column([*second, arb(0)]))[size, 0] < 0)
