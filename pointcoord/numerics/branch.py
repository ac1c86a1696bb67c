r"""Proves that a step of a series, or of a path, ended on the branch that it started on.

Branches meet where a diagonal block of C_u is singular; C_u is block triangular (see `block_order`). Two meet
in a fold, where the block's determinant changes its sign. A series that is too coarse to see a fold just
ahead runs smoothly across it; and where two branches cross, as the parallel and the crossed assembly do of
cranks and couplers in one line, a series is smooth in any case. So it is proven that no block D is singular
all along a series. C_u is linear in y, so that D(s) = sum_k D_k s^k has the series' coefficients, and with
X = D_0^-1

    |I - X D(s)| <= Z = sum_{k > 0} |X D_k|        for |s_i| <= 1,

element by element. Where Z w < w for some w > 0 no such D has a null vector. A segment is looked at about its
middle, and where that proves nothing about the middles of shorter parts.

With X = C_u^-1 at the end and omega the Lipschitz constant of X C_u, no other assembly lies within 2 / omega
of the end: what the series left out and Newton's correction together must stay far below that, and so must
what rounding may move the end by. Near a crossing both are in proportion to 1 / D, so within the root of EPS
of it no computed pose tells the branches apart: a motion may end there, and does not go on from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.chebyshev import binomials
from pointcoord.numerics.kantorovich import nearer_perron
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import Converged
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Share of the distance within which an assembly is alone that may lie between it and the series.
NEAR = 0.25
# Into how many parts a segment is divided, one after the other where that proves nothing, and norms tried.
PARTS, WEIGHINGS = (1, 4, 16), 6
# Where EPS |X|^2 is smaller, rounding hides nothing: of coordinates near 1 omega |X| d is at most some
# thousand times that.
CLEAR = 1e-6
# Below 1 by more than what rounding makes of a few sums of C_u's entries.
SURE = 1.0 - 1e-9


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


def on_branch(
    system: QuadraticMap, series: Array, s: float, reached: Converged, factors: Factors
) -> NDArray[np.bool_]:
    """Whether the end of a series is its own and not that of another assembly, shape (...,).

    Args:
        series: coefficients, shape (..., order + 1, size). s: its parameter at the end.
        reached: the end, as Newton's method found it from the series. factors: of C_u there.
    """
    last, order = np.abs(series[..., -2:, :]), series.shape[-2] - 1
    left_out = (last[..., 0, :] * s ** (order - 1) + last[..., 1, :] * s**order).max(axis=-1)
    omega = reached.lipschitz_with(system, factors)
    alone = omega * (reached.first_step + left_out) <= 2.0 * NEAR
    return np.asarray(alone)


def same_side(
    system: QuadraticMap, y: Array, factors: Factors, side: Array, last: NDArray[np.bool_] | bool
) -> NDArray[np.bool_]:
    """Whether the end of a proven step is surely on the branch of its start, shape (...,).

    In exact arithmetic no such step crosses a fold or a crossing; what does has run out of digits.

    Args:
        y: the end, shape (..., size). factors: of C_u there. side: orientation at the start.
        last: whether nothing goes on from there: only what lies beyond may be on another branch.
    """
    # No sign is another, 0 or no number.
    same = np.asarray((orientation(system, factors) * side > 0.0).all(axis=-1))
    return same if np.all(last) else same & (last | ~hidden(system, y, factors))


def hidden(system: QuadraticMap, y: Array, factors: Factors) -> NDArray[np.bool_]:
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


def regular_along(system: QuadraticMap, series: Array, s: float) -> NDArray[np.bool_]:
    """Whether no block of C_u is singular on a segment of a series, from 0 to s, shape (...,).

    Args:
        series: coefficients, shape (..., order + 1, size).
    """
    order = series.shape[-2] - 1
    scaled = series * (s ** np.arange(order + 1.0))[:, None]
    for parts in PARTS:
        local = _about_middles(order, parts) @ scaled[..., None, :, :]
        good = _regular(system, local[..., 0, :], system.entries(local[..., 1:, :]), False).all(axis=-1)
        if good.all():
            break
    return np.asarray(good)


def regular_on(system: QuadraticMap, y: Array, series: Array, moving: Sequence[int]) -> NDArray[np.bool_]:
    """Whether no block of C_u is singular where |s_i| <= 1 in a series, shape (N,); see the formula above.

    By |X| |D_k| first, which takes the sum of all powers alone, and where that proves nothing by |X D_k|.

    Args:
        y: where it starts, (N, size).
        series: of the coordinates that move, by power of one or several variables from the first one on,
            (powers - 1, N, moving).
    """
    sums = np.zeros_like(y)
    sums[:, moving] = np.abs(series).sum(axis=0)
    good = _regular(system, y, system.spread_entries(sums)[:, None], True)
    left = ~good
    if left.any():
        whole = np.zeros((np.count_nonzero(left), len(series), y.shape[-1]))
        whole[..., moving] = series[:, left].swapaxes(0, 1)
        good[left] = _regular(system, y[left], system.entries(whole), False)
    return good


def _regular(system: QuadraticMap, y: Array, entries: Array, magnitudes: bool) -> NDArray[np.bool_]:
    """Whether no block is singular about poses, (..., size), by entries of C_u of each power, shape (...,).

    Args:
        entries: shape (..., powers, entries). magnitudes: whether they are sums of magnitudes.
    """
    here, good = system.entries(y), np.ones(y.shape[:-1], dtype=bool)
    with np.errstate(all="ignore"):
        for places in _diagonal_entries(system):
            inverse = factorise(places.blocks(here)).preconditioner[..., None, :, :, :]
            inverse = np.abs(inverse) if magnitudes else inverse
            change = np.abs(inverse @ places.blocks(entries)).sum(axis=-4)
            good &= below_one(change).all(axis=-1)
    return good


def below_one(matrix: Array) -> NDArray[np.bool_]:
    """Whether matrices of no negative elements, (..., n, n), are below 1 in some norm, (...,)."""
    weights, below = np.ones(matrix.shape[:-1]), np.zeros(matrix.shape[:-2], dtype=bool)
    for _ in range(WEIGHINGS):
        weights, norm = nearer_perron(matrix, weights)
        # What is not finite is not below anything.
        below |= norm < SURE
        if below.all():
            break
    return below


@dataclass(frozen=True)
class _Places:
    """Diagonal blocks of one size.

    Attributes:
        count, rows: of the blocks, and of each. kept, places: which entries of C_u they have, and where.
    """

    count: int
    rows: int
    kept: Indices
    places: Indices

    def blocks(self, entries: Array) -> Array:
        """The blocks, (..., count, rows, rows), from entries, (..., entries)."""
        found = np.zeros((*entries.shape[:-1], self.count * self.rows**2))
        found[..., self.places] = entries[..., self.kept]
        return found.reshape(*entries.shape[:-1], self.count, self.rows, self.rows)


@lru_cache(maxsize=64)
def _diagonal_entries(system: QuadraticMap) -> tuple[_Places, ...]:
    """The diagonal blocks of each size."""
    n, found = system.unknowns, []
    for one in system.block_order.diagonal:
        count, size = one.rows.shape
        place = np.full(len(system.rows) * n, -1)
        place[(one.rows[:, :, None] * n + one.unknowns[:, None, :]).ravel()] = np.arange(count * size * size)
        there = place[system.filled]
        kept = np.flatnonzero(there >= 0)
        found.append(_Places(count, size, kept, there[kept]))
    return tuple(found)


@lru_cache(maxsize=64)
def _about_middles(order: int, parts: int) -> Array:
    """Matrices that give a polynomial on 0 .. 1 about the middles of parts, (parts, order + 1, order + 1).

    sum_k a_k s^k = sum_j (sum_k binomial(k, j) m^(k - j) h^j a_k) t^j for s = m + h t.
    """
    half, powers = 0.5 / parts, np.arange(order + 1.0)
    middles = (2.0 * np.arange(parts) + 1.0)[:, None, None] * half
    missing = np.maximum(powers - powers[:, None], 0.0)
    return np.asarray(binomials(order + 1).T * middles**missing * half ** powers[:, None])
