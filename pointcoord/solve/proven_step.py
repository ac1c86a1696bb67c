r"""Proof of a step along a power series: the step follows one branch, and leads to one pose.

Branches meet where C_u is singular. In a fold two branches meet and end, and a determinant changes its sign.
At a crossing, like that of the parallel and the crossed assembly of cranks and couplers in line, a series is
smooth and shows nothing. So every step of a path, of a motion in time and of a range of inputs is proven to
meet no singular pose.

Let y(s) = sum_k y_k s^k be a series of all coordinates, from any pose y_0, and c(s) the target of C(y(s)).
C is quadratic and C_u is linear in y. With X near C_u(y_0)^-1 therefore

    X (C(y(s)) - c(s)) = sum_{k <= 2p} X R_k s^k,      R_k = sum_{i + j = k} B(y_i, y_j) - c_k,
    I - X C_u(y(s)) = I - X C_u(y_0) - sum_{0 < k <= p} X C_u(y_k) s^k      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds at every s
from 0 to h if it holds with

    eta = max sum_k |X R_k| h^k,    z = |I - X C_u(y_0)| + |sum_{k > 0} |X C_u(y_k)| h^k|,
    2 omega eta < (1 - z)^2,  that is  z + sqrt(2 omega eta) < 1.

Then exactly one branch follows the series, and at most one assembly lies within (1 - z) / omega of the end of
the series: a solved pose within this distance is the next pose. The theorem holds in any weighted maximum
norm. It also holds for a series in several parameters, |s_i| <= 1, with sums over all powers. Two adjacent
boxes, each with an X and a norm of its own, agree on the pose where they touch: Newton's method converges
from there to one pose only. The pose y_0 need not be exact: it stands for the assembly to which
u <- u - X (C - c_0) converges from y_0. The step before ends at the same assembly if Newton's method is
proven to converge from its end, because both proofs start from the same y_0.

The proof leaves rounding out. Near a pose where branches meet, with D the determinant, rounding moves a pose
in proportion to 1 / D, and the next assembly is at a distance in proportion to D. Within the root of EPS of
that pose no computed pose tells the branches apart (see `hidden`). A motion may end there, but not go on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.few_entries import LARGE, product_of_few_entries
from pointcoord.numerics.kantorovich import nearer_perron
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.multi_index import products
from pointcoord.numerics.power_series import multiplied, powers_first
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

# Lengths of steps that are tried, a compromise between few lengths and few steps: fine steps down to 0.09,
# then halves.
LENGTHS = np.concatenate([0.85 ** np.arange(16.0), 0.5 ** np.arange(4.0, 44.0)])
WHOLE = np.ones(1)
# Limit of z + sqrt(2 omega eta). The theorem needs less than 1. The margin is far larger than any rounding
# error, and nearer to 1 Newton's method would converge only linearly from the end of the step.
ROOM = 0.9
# Numbers of parts into which a segment is divided: the next number is tried if the one before proves nothing.
PARTS = (1, 4, 16)
# Powers of a series for which |X C_u(y_k)| is computed in a large map, where each takes a product of large
# matrices; higher powers, which are small, count by |X| |C_u(y_k)|, all together.
EXACT_OF_LARGE = 4
# Iterations towards the weights with the smallest norm; the factor by which a box may take more, because a
# box cannot be made shorter; and a norm at which the iteration stops.
WEIGHINGS, MORE, ENOUGH = 4, 2, 0.8
# Below this value of EPS |X|^2 rounding cannot hide a branch: for coordinates near 1 and a rounding error d
# of a row, omega |X| d is at most about a thousand times EPS |X|^2.
CLEAR = 1e-6
# Smallest weight of a coordinate as a share of the largest. Near a singular pose the coordinates that the
# singular block does not move have almost no noise; in a norm with smaller weights these would decide.
LEAST = 2.0**-5


@dataclass(frozen=True)
class Proof:
    """Proven steps, with distances in a weighted maximum norm.

    Attributes:
        length: the longest of the tried lengths up to which one branch follows the series, (...,); 0 if none.
        alone: radius about the end of the step, and about every pose before it, in which the branch is the
            only assembly, (...,).
        weights: weights of the norm, (..., n).
    """

    length: Array
    alone: Array
    weights: Array

    def taken(self, members: Indices) -> Proof:
        """The proofs of some members, by number."""
        return Proof(self.length[members], self.alone[members], self.weights[members])

    def within(self, apart: Array) -> Flags:
        """Whether poses so far from the ends of the steps, (..., n), lie within `alone`, shape (...,)."""
        return np.asarray((apart / self.weights).max(axis=-1) <= self.alone)


def prove(
    system: QuadraticMap,
    inverse: Array,
    series: Array,
    lacking: Array | None = None,
    lengths: Array = LENGTHS,
) -> Proof:
    """How far series are proven. The caller suppresses floating point warnings.

    Args:
        inverse: X, (..., n, n).
        series: coefficients y_k, (..., order + 1, size).
        lacking: the first R_k, (powers, ..., rows), if not 0; all other R_k up to the order are 0.
        lengths: lengths h that are tried, the longest first, (l,).
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

    def proven(weights: Array, count: int | None) -> tuple[Indices, Array]:
        """Index of the longest length proven in a norm, (...,), and the radius `alone` at its end."""
        z = _summed(powers[:count, : order + 1], np.matvec(change, weights) / weights)
        omega = system.lipschitz(inverse, weights)
        holds = z + np.sqrt(2.0 * omega * _summed(powers[:count, of_rest], rest / weights)) <= ROOM
        number = np.where(holds.any(axis=0), holds.argmax(axis=0), len(z))
        there = np.take_along_axis(z, np.minimum(number, len(z) - 1)[None], axis=0)[0]
        return number, (1.0 - there) / omega

    weights = np.ones(change.shape[1:-1])
    number, alone = proven(weights, 1)
    if number.any():
        # Towards the weights that make the norm of X C_u(y_1), the largest change, smallest.
        for _ in range(WEIGHINGS):
            weights, _ = nearer_perron(change[1], weights)
        weights = np.where((number[..., None] > 0) & np.isfinite(weights), weights, 1.0)
        number, alone = proven(weights, None)
    return Proof(np.append(lengths, 0.0)[number], alone, weights)


def prove_segment(system: QuadraticMap, series: Array, s: float) -> Proof:
    """Proof of a series, (..., order + 1, size), from 0 to s: the length is 1 if proven, else 0.

    The segment is proven as one box about its middle. If that fails, shorter parts are proven as boxes.
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
    """Proof of series in the box of all |s_i| <= 1: the length is 1 if proven, else 0.

    The truncated terms are bounded by the magnitudes of each degree. In several parameters the change of C_u
    is first bounded by |X| |C_u(y_k)|, which is cheap, and by |X C_u(y_k)| only where that proves nothing.

    Args:
        y: the pose in the middle of the box, (..., size).
        moving: series of the moving coordinates about y, powers first, (powers, ..., moving).
        places: places of the moving coordinates in y.
        sizes: magnitudes in the box of the terms of each degree, from the first degree on, of the series as
            it was solved to its order, (degrees, ..., size).
        lacking: C at the pose from which that series starts, (..., rows).
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
            exact = min(EXACT_OF_LARGE, len(moving) - 1) if len(system.rows) >= LARGE else len(moving) - 1
            whole = np.zeros((exact, np.count_nonzero(left), y.shape[-1]))
            whole[..., places] = moving[1 : exact + 1, left]
            by_power = product_of_few_entries(inverse[left], system.jacobian(whole))
            change[left] = np.abs(by_power, out=by_power).sum(axis=0)
            if exact < len(moving) - 1:
                tail = np.zeros(whole.shape[1:])
                tail[..., places] = np.abs(moving[exact + 1 :, left]).sum(axis=0)
                change[left] += product_of_few_entries(magnitude[left], system.jacobian_uncertainty(tail))
            proof = proven()
        return proof


def _summed(powers: Array, terms: Array) -> Array:
    """Largest component of sum_k h^k term_k for each length h; powers (l, k), terms (k, ..., n); (l, ...)."""
    sums = (powers @ terms.reshape(len(terms), -1)).reshape(len(powers), *terms.shape[1:])
    return np.asarray(sums.max(axis=-1))


@lru_cache(maxsize=64)
def _about_middles(order: int, parts: int) -> Array:
    """Matrices that expand a polynomial on 0 .. 1 about the middles of parts, (parts, order + 1, order + 1).

    sum_k a_k s^k = sum_j (sum_k binomial(k, j) m^(k - j) h^j a_k) t^j for s = m + h t.
    """
    half, every = 0.5 / parts, range(order + 1)
    middles = [(2.0 * part + 1.0) * half for part in range(parts)]
    return np.array(
        [[[comb(k, j) * m ** max(k - j, 0) * half**j for k in every] for j in every] for m in middles]
    )


def orientation(system: QuadraticMap, factors: Factors) -> Array:
    """The signs of the determinants of the diagonal blocks of C_u, shape (..., blocks); 0 for singular ones.

    The factors scale rows by positive numbers, which changes no sign.
    """
    signs = np.empty((*factors.matrix.shape[:-2], len(system.block_order.blocks)))
    for one in system.block_order.diagonal:
        blocks = factors.matrix[..., one.rows[:, :, None], one.unknowns[:, None, :]]
        single = blocks.shape[-1] == 1
        signs[..., one.numbers] = np.sign(blocks[..., 0, 0]) if single else np.linalg.slogdet(blocks)[0]
    return signs


def same_side(system: QuadraticMap, y: Array, factors: Factors, side: Array, last: Flags | bool) -> Flags:
    """Whether the end of a proven step is certainly on the branch of its start, shape (...,).

    In exact arithmetic no proven step passes a fold or a crossing. A step that does has run out of digits.

    Args:
        y: the pose at the end, shape (..., size).
        factors: factorisation of C_u at y.
        side: orientation at the start of the path.
        last: whether the path ends at y. Then `hidden` need not hold: only poses beyond y could be on another
            branch.
    """
    # Not the same: the opposite sign, 0 and NaN.
    same = np.asarray((orientation(system, factors) * side > 0.0).all(axis=-1))
    return same if np.all(last) else same & (last | ~hidden(system, y, factors))


def hidden(system: QuadraticMap, y: Array, factors: Factors) -> Flags:
    """Whether rounding may have moved a pose to another assembly, at least 2 / omega away, shape (...,).

    Args:
        y: the pose, shape (..., size).
        factors: factorisation of C_u at y.
    """
    # A vanishing row shows in the row scale, every other singularity in the condition number.
    size = factors.condition * factors.row_scale.max(axis=-1)
    doubtful = np.asarray(~(EPS * size * size < CLEAR))
    if not doubtful.any():
        return doubtful
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        rows = system.uncertainty(y, np.zeros(y.shape[-1]))
        noise = np.matvec(np.abs(inverse), rows)
        # In a norm with these weights the noise is 1 at most.
        weights = np.maximum(noise, LEAST * noise.max(axis=-1, keepdims=True))
        return np.asarray(doubtful & ~(system.lipschitz(inverse, weights) <= 1.0))
