r"""What is proven of a step along a power series: that one branch leads along it, and which pose it leads to.

Branches meet where C_u is singular: two in a fold, where a determinant changes its sign; and where two cross,
as the parallel and the crossed assembly do of cranks and couplers in one line, a series is smooth in any
case. So it is proven of every step, of a path, of a motion in time and of a range of inputs, that it meets no
such pose.

Let y(s) = sum_k y_k s^k be a series of all coordinates, from any pose y_0, and c(s) what C(y(s)) should be.
C is quadratic and C_u linear in y, so that with X near C_u(y_0)^-1

    X (C(y(s)) - c(s)) = sum_{k <= 2p} X R_k s^k,      R_k = sum_{i + j = k} B(y_i, y_j) - c_k,
    I - X C_u(y(s)) = I - X C_u(y_0) - sum_{0 < k <= p} X C_u(y_k) s^k      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds at every s
from 0 to h if it does with

    eta = max sum_k |X R_k| h^k,    z = |I - X C_u(y_0)| + |sum_{k > 0} |X C_u(y_k)| h^k|,
    2 omega eta < (1 - z)^2,  that is  z + sqrt(2 omega eta) < 1.

Then one branch leads along the series, and no other assembly lies within (1 - z) / omega of its end: a pose
that does is the next one. All is true in any weighted maximum norm; and of a series in several parameters,
|s_i| <= 1, with the sums over all of its powers. Boxes side by side, each with its own X and norm, lead to
the same pose where they touch: it is the one that Newton's method converges to from there. The pose y_0
need not be exact: it stands for the assembly that u <- u - X (C - c_0) leads to from it, and so does the end
of the step before if Newton's method is proven to converge from there, because both are about the same y_0.

Rounding is not counted. Near a pose where branches meet what it may move a pose by is in proportion to
1 / D, D the determinant, and so is the way to another assembly to D: within the root of EPS of it no computed
pose tells the branches apart (see `hidden`). A motion may end there, and does not go on from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.few_entries import product_of_few_entries
from pointcoord.numerics.kantorovich import nearer_perron
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.multi_index import products
from pointcoord.numerics.power_series import multiplied, powers_first
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

# Lengths of steps that are tried: few of those that few steps need.
LENGTHS = np.concatenate([0.85 ** np.arange(16.0), 0.5 ** np.arange(4.0, 44.0)])
WHOLE = np.ones(1)
# Of 1, what z + sqrt(2 omega eta) may be: the rest is far more than anything rounds, and with less than that
# Newton's method would converge only linearly from the end of the step.
ROOM = 0.9
# Into how many parts a segment is divided, one after the other where that proves nothing.
PARTS = (1, 4, 16)
# Times that weights are brought nearer to those of the smallest norm, so many times as many for a box, where
# a shorter one is no answer; and a norm that is small enough.
WEIGHINGS, MORE, ENOUGH = 4, 2, 0.8
# Where EPS |X|^2 is smaller, rounding hides nothing: of coordinates near 1 omega |X| d is at most some
# thousand times that.
CLEAR = 1e-6


@dataclass(frozen=True)
class Proof:
    """What holds of steps in a maximum norm.

    Attributes:
        length: up to where, of the lengths that were asked about, one branch leads along the series, (...,);
            0 if nowhere.
        alone: no other assembly lies so near its place there, nor nearer to the start, (...,).
        weights: of the norm, (..., n).
    """

    length: Array
    alone: Array
    weights: Array

    def taken(self, members: NDArray[np.intp]) -> Proof:
        """Some members, by number."""
        return Proof(self.length[members], self.alone[members], self.weights[members])

    def within(self, apart: Array) -> Flags:
        """Whether places so far from the ends of the steps, (..., n), are alone there, shape (...,)."""
        return np.asarray((apart / self.weights).max(axis=-1) <= self.alone)


def prove(
    system: QuadraticMap,
    inverse: Array,
    series: Array,
    lacking: Array | None = None,
    lengths: Array = LENGTHS,
) -> Proof:
    """How far series are proven; floating point warnings are the caller's.

    Args:
        inverse: X, (..., n, n).
        series: (..., order + 1, size).
        lacking: the first R_k, (powers, ..., rows), if they are not 0; up to the order all others are.
        lengths: h that are tried, the longest first, (l,).
    """
    order = series.shape[-2] - 1
    left, right = (powers_first(each) for each in system.factors(series))
    cut = system.gather(multiplied(left, right, products(1, order, (order + 1, 2 * order), 0)))
    first = cut[:0] if lacking is None else lacking
    rest = np.abs(np.matvec(inverse, np.concatenate([first, cut])))
    change = product_of_few_entries(inverse, system.jacobian(powers_first(series)))
    change[0] -= np.eye(system.unknowns)
    np.abs(change, out=change)
    powers = lengths[:, None] ** np.arange(2.0 * order + 1.0)
    of_rest = np.r_[: len(first), order + 1 : 2 * order + 1]

    def proven(weights: Array, count: int | None) -> tuple[NDArray[np.intp], Array]:
        """Numbers of the lengths that are proven in a norm, (...,), and how far their ends are alone."""
        z = _summed(powers[:count, : order + 1], np.matvec(change, weights) / weights)
        omega = system.lipschitz(inverse, weights)
        holds = z + np.sqrt(2.0 * omega * _summed(powers[:count, of_rest], rest / weights)) <= ROOM
        number = np.where(holds.any(axis=0), holds.argmax(axis=0), len(z))
        there = np.take_along_axis(z, np.minimum(number, len(z) - 1)[None], axis=0)[0]
        return number, (1.0 - there) / omega

    weights = np.ones(change.shape[1:-1])
    number, alone = proven(weights, 1)
    if number.any():
        # Nearer to the weights for which the norm of what changes most is smallest.
        for _ in range(WEIGHINGS):
            weights, _ = nearer_perron(change[1], weights)
        weights = np.where((number[..., None] > 0) & np.isfinite(weights), weights, 1.0)
        number, alone = proven(weights, None)
    return Proof(np.append(lengths, 0.0)[number], alone, weights)


def prove_segment(system: QuadraticMap, series: Array, s: float) -> Proof:
    """Whether a series, (..., order + 1, size), is proven from 0 to s: then the length is 1.

    It is a box about its middle, or boxes about the middles of shorter parts where that proves nothing.
    """
    order = series.shape[-2] - 1
    scaled = (series * (s ** np.arange(order + 1.0))[:, None])[..., None, :, :]
    sizes, lacking = np.abs(powers_first(scaled))[1:], system.residual(scaled[..., 0, :])
    for parts in PARTS:
        about = powers_first(_about_middles(order, parts) @ scaled)
        proof = prove_box(system, about[0], about, slice(None), sizes, lacking)
        length = proof.length.min(axis=-1)
        if length.all():
            break
    return Proof(length, proof.alone[..., -1], proof.weights[..., -1, :])


def prove_box(
    system: QuadraticMap,
    y: Array,
    moving: Array,
    places: Sequence[int] | slice,
    sizes: Array,
    lacking: Array,
) -> Proof:
    """Whether series are proven where all |s_i| <= 1: then the length is 1.

    What is cut off is taken by the magnitudes of each degree. What C_u changes by is so too in several
    parameters, |X| |C_u(y_k)|, and by |X C_u(y_k)| only where that proves nothing.

    Args:
        y: in the middle, (..., size).
        moving: series about it of the coordinates that move, powers first, (powers, ..., moving).
        places: which these are.
        sizes: magnitudes in the box by degree, from the first on, of a series that is solved to its order,
            (degrees, ..., size).
        lacking: C(y) where that starts, (..., rows).
    """
    with np.errstate(all="ignore"):
        inverse = factorise(system.jacobian(y)).preconditioner
        magnitude, change, left = np.abs(inverse), np.empty_like(inverse), np.ones(y.shape[:-1], dtype=bool)
        one, other = system.sizes_of_factors(sizes)
        cut = system.gather_sizes((one * other[::-1].cumsum(axis=0)).sum(axis=0))
        rest = np.matvec(magnitude, np.abs(lacking) + cut)

        def proven() -> Proof:
            weights = np.ones(rest.shape)
            for _ in range(MORE * WEIGHINGS):
                weights, norm = nearer_perron(change, weights)
                if (norm <= ENOUGH).all():
                    break
            weights = np.where(np.isfinite(weights), weights, 1.0)
            omega = system.lipschitz(inverse, weights)
            z, eta = (np.matvec(change, weights) / weights).max(axis=-1), (rest / weights).max(axis=-1)
            holds = z + np.sqrt(2.0 * omega * eta) <= ROOM
            return Proof(np.where(holds, 1.0, 0.0), (1.0 - z) / omega, weights)

        if len(moving) > len(sizes) + 1:
            change[...] = magnitude @ system.jacobian_uncertainty(sizes.sum(axis=0))
            proof = proven()
            left = proof.length < 1.0
        if left.any():
            whole = np.zeros((len(moving) - 1, np.count_nonzero(left), y.shape[-1]))
            whole[..., places] = moving[1:, left]
            by_power = product_of_few_entries(inverse[left], system.jacobian(whole))
            change[left] = np.abs(by_power, out=by_power).sum(axis=0)
            proof = proven()
        return proof


def _summed(powers: Array, terms: Array) -> Array:
    """The largest component of sums of vectors by powers of lengths, (l, k) and (k, ..., n) to (l, ...)."""
    sums = (powers @ terms.reshape(len(terms), -1)).reshape(len(powers), *terms.shape[1:])
    return np.asarray(sums.max(axis=-1))


@lru_cache(maxsize=64)
def _about_middles(order: int, parts: int) -> Array:
    """Matrices that give a polynomial on 0 .. 1 about the middles of parts, (parts, order + 1, order + 1).

    sum_k a_k s^k = sum_j (sum_k binomial(k, j) m^(k - j) h^j a_k) t^j for s = m + h t.
    """
    half, every = 0.5 / parts, range(order + 1)
    middles = [(2.0 * part + 1.0) * half for part in range(parts)]
    return np.array(
        [[[comb(k, j) * m ** max(k - j, 0) * half**j for k in every] for j in every] for m in middles]
    )


def orientation(system: QuadraticMap, factors: Factors) -> Array:
    """The signs of the determinants of the diagonal blocks of C_u, shape (..., blocks); 0 of a singular one.

    Rows are scaled by positive numbers, which changes no sign.
    """
    signs = np.empty((*factors.matrix.shape[:-2], len(system.block_order.blocks)))
    for one in system.block_order.diagonal:
        blocks = factors.matrix[..., one.rows[:, :, None], one.unknowns[:, None, :]]
        single = blocks.shape[-1] == 1
        signs[..., one.numbers] = np.sign(blocks[..., 0, 0]) if single else np.linalg.slogdet(blocks)[0]
    return signs


def same_side(system: QuadraticMap, y: Array, factors: Factors, side: Array, last: Flags | bool) -> Flags:
    """Whether the end of a proven step is surely on the branch of its start, shape (...,).

    In exact arithmetic no such step crosses a fold or a crossing; what does has run out of digits.

    Args:
        y: the end, shape (..., size). factors: of C_u there. side: orientation at the start.
        last: whether nothing goes on from there: only what lies beyond may be on another branch.
    """
    # No sign is another, 0 or no number.
    same = np.asarray((orientation(system, factors) * side > 0.0).all(axis=-1))
    return same if np.all(last) else same & (last | ~hidden(system, y, factors))


def hidden(system: QuadraticMap, y: Array, factors: Factors) -> Flags:
    """Whether rounding may have moved a pose over to another one, at least 2 / omega away, shape (...,).

    Args:
        y: the pose, shape (..., size). factors: of C_u there.
    """
    # A row that vanishes shows in its scale, and what else does in the condition number.
    size = factors.condition * factors.row_scale.max(axis=-1)
    doubtful = np.asarray(~(EPS * size * size < CLEAR))
    if not doubtful.any():
        return doubtful
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        rows = system.uncertainty(y, np.zeros(y.shape[-1]))
        noise = np.matvec(np.abs(inverse), rows).max(axis=-1)
        return np.asarray(doubtful & ~(system.lipschitz(inverse) * noise <= 1.0))
