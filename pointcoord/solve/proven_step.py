r"""Proof of a step along a power series: the step follows one branch, and leads to one pose.

Branches meet where C_u is singular. In a fold two branches meet and end, and a determinant changes its sign.
At a crossing, like that of the parallel and the crossed assembly of cranks and couplers in line, a series is
smooth and shows nothing. So every step of a path, of a motion in time and of a range of inputs is proven to
meet no singular pose.

Let y(s) = sum_k y_k s^k be a series of all coordinates about the middle of a box, |s_i| <= 1, in one or in
several parameters, and c(s) the target of C(y(s)): zero, or a residual that is reduced to zero along a path.
C is quadratic and C_u is linear in y. With X near C_u(y_0)^-1 therefore

    X (C(y(s)) - c(s)) = sum_k X R_k s^k,      R_k = sum_{i + j = k} B(y_i, y_j) - c_k,
    I - X C_u(y(s)) = I - X C_u(y_0) - sum_{k > 0} X C_u(y_k) s^k      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds everywhere
in the box if it holds with

    eta = max sum_k |X R_k|,    z = |I - X C_u(y_0)| + |sum_{k > 0} |X C_u(y_k)||,
    2 omega eta < (1 - z)^2,  that is  z + sqrt(2 omega eta) < 1.

Then exactly one branch follows the series, and at most one assembly lies within (1 - z) / omega of each of
its poses: a solved pose within this distance of the end is the next pose. The theorem holds in any weighted
maximum norm. Two adjacent boxes, each with an X and a norm of its own, agree on the pose where they touch:
Newton's method converges from there to one pose only. The pose at which a step starts need not be exact: it
stands for the assembly to which u <- u - X (C - c) converges from it. The step before ends at the same
assembly if Newton's method is proven to converge from its end.

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
from pointcoord.numerics.power_series import powers_first
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

# Limit of z + sqrt(2 omega eta). The theorem needs less than 1. The margin is far larger than any rounding
# error, and nearer to 1 Newton's method would converge only linearly from the end of the step.
ROOM = 0.9
# Numbers of parts into which a segment is divided: the next number is tried if the one before proves nothing.
PARTS = (1, 4, 16)
# Powers of a series for which |X C_u(y_k)| is computed in a large map, where each takes a product of large
# matrices; higher powers, which are small, count by |X| |C_u(y_k)|, all together.
EXACT_OF_LARGE = 4
# Most iterations towards the weights with the smallest norm, and a norm at which they stop.
WEIGHINGS, ENOUGH = 8, 0.8
# Below this value of EPS |X|^2 rounding cannot hide a branch: for coordinates near 1 and a rounding error d
# of a row, omega |X| d is at most about a thousand times EPS |X|^2.
CLEAR = 1e-6
# Smallest weight of a coordinate as a share of the largest. Near a singular pose the coordinates that the
# singular block does not move have almost no noise; in a norm with smaller weights these would decide.
LEAST = 2.0**-5


@dataclass(frozen=True)
class Proof:
    """Proofs of steps, with distances in a weighted maximum norm.

    Attributes:
        holds: whether one branch follows the series, (...,).
        alone: radius about the end of the step, and about every pose before it, in which the branch is the
            only assembly, (...,).
        weights: weights of the norm, (..., n).
    """

    holds: Flags
    alone: Array
    weights: Array

    def taken(self, members: Indices) -> Proof:
        """The proofs of some members, by number."""
        return Proof(self.holds[members], self.alone[members], self.weights[members])

    def within(self, apart: Array) -> Flags:
        """Whether poses so far from the ends of the steps, (..., n), lie within `alone`, shape (...,)."""
        return np.asarray((apart / self.weights).max(axis=-1) <= self.alone)


def prove_segment(
    system: QuadraticMap,
    series: Array,
    s: Array | float,
    lacking: Array | float = 0.0,
    parts: Sequence[int] = PARTS,
) -> Proof:
    """Proof of a series, (..., order + 1, size), from 0 to s, (...,).

    The segment is proven as one box about its middle. If that fails, shorter parts are proven as boxes.

    Args:
        lacking: R_0 of the series, (..., rows); the R_k of higher powers up to the order are 0.
        parts: numbers of parts that are tried.
    """
    order = series.shape[-2] - 1
    scaled = (series * (np.asarray(s)[..., None] ** np.arange(order + 1.0))[..., None])[..., None, :, :]
    sizes = np.abs(powers_first(scaled))[1:]
    rest = np.abs(np.broadcast_to(lacking, (*series.shape[:-2], len(system.rows))))[..., None, :]
    for count in parts:
        about = powers_first(_about_middles(order, count) @ scaled)
        inverse = factorise(system.jacobian(about[0])).preconditioner
        proof = prove_box(system, inverse, about[0], about, slice(None), sizes, rest)
        holds = np.asarray(proof.holds.all(axis=-1))
        if holds.all():
            break
    return Proof(holds, proof.alone[..., -1], proof.weights[..., -1, :])


def prove_box(
    system: QuadraticMap,
    inverse: Array,
    y: Array,
    moving: Array,
    places: Sequence[int] | slice,
    sizes: Array,
    lacking: Array,
    defect: Array | float = 0.0,
) -> Proof:
    """Proof of series in the box of all |s_i| <= 1.

    The truncated terms are bounded by the magnitudes of each degree. In several parameters the change of C_u
    is first bounded by |X| |C_u(y_k)|, which is cheap, and by |X C_u(y_k)| only where that proves nothing.

    Args:
        inverse: X, (..., n, n).
        y: the pose in the middle of the box, (..., size).
        moving: series of the moving coordinates about y, powers first, (powers, ..., moving).
        places: places of the moving coordinates in y.
        sizes: magnitudes in the box of the terms of each degree, from the first degree on, of the series as
            it was solved to its order, (degrees, ..., size).
        lacking: sum of |R_k| of that series up to its order, (..., rows).
        defect: |I - X C_u(y)|, if X is not the inverse at y, (..., n, n).
    """
    with np.errstate(all="ignore"):
        inverse = np.broadcast_to(inverse, (*y.shape[:-1], *inverse.shape[-2:]))
        defect = np.broadcast_to(defect, inverse.shape)
        magnitude, change, left = np.abs(inverse), np.empty(inverse.shape), np.ones(y.shape[:-1], dtype=bool)
        one, other = system.sizes_of_factors(sizes)
        cut = system.gather_sizes((one * other[::-1].cumsum(axis=0)).sum(axis=0))
        rest = np.matvec(magnitude, lacking + cut)

        def proven() -> Proof:
            weights = np.ones(rest.shape)
            for _ in range(WEIGHINGS):
                weights, norm = nearer_perron(change, weights)
                if (norm <= ENOUGH).all():
                    break
            weights = np.where(np.isfinite(weights), weights, 1.0)
            omega = system.lipschitz(inverse, weights)
            z, eta = (np.matvec(change, weights) / weights).max(axis=-1), (rest / weights).max(axis=-1)
            holds = z + np.sqrt(2.0 * omega * eta) <= ROOM
            return Proof(np.asarray(holds), (1.0 - z) / omega, weights)

        if len(moving) > len(sizes) + 1:
            change[...] = defect + magnitude @ system.jacobian_uncertainty(sizes.sum(axis=0))
            proof = proven()
            left = ~proof.holds
        if left.any():
            exact = min(EXACT_OF_LARGE, len(moving) - 1) if len(system.rows) >= LARGE else len(moving) - 1
            whole = np.zeros((exact, np.count_nonzero(left), y.shape[-1]))
            whole[..., places] = moving[1 : exact + 1, left]
            by_power = product_of_few_entries(inverse[left], system.jacobian(whole))
            change[left] = defect[left] + np.abs(by_power, out=by_power).sum(axis=0)
            if exact < len(moving) - 1:
                tail = np.zeros(whole.shape[1:])
                tail[..., places] = np.abs(moving[exact + 1 :, left]).sum(axis=0)
                change[left] += product_of_few_entries(magnitude[left], system.jacobian_uncertainty(tail))
            proof = proven()
        return proof


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
