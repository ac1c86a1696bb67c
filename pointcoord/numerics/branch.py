r"""Whether a step of a series, or of a path, ended on the branch that it started on.

Branches meet where a diagonal block of C_u is singular; C_u is block triangular (see `structure`). Two meet
in a fold, where the block's determinant changes its sign. A series that is too coarse to see a fold just
ahead runs smoothly across it; and where two branches cross, as the parallel and the crossed assembly do of
cranks and couplers in one line, a series is smooth in any case. There the sign at its end need not tell:
loops of one block that fold together change it twice, a motion there and back does so, and past a crossing
the other branch has the sign that this one had before. So the determinant D(s) of every block is looked at
all along a series. As a function of s it is as smooth as the series, whose segments are cut far inside of
their radius of convergence: the coefficients of its interpolant of degree 6 at Chebyshev's places fall
steeply, and where that stays clear of 0 by more than its last ones, D has no zero. Where it does not, as near
a zero beside the real axis, shorter parts of the segment are looked at.

With X = C_u^-1 at the end and omega the Lipschitz constant of X C_u, no other assembly lies within 2 / omega
of the end: what the series left out and Newton's correction together must stay far below that, and so must
what rounding may move the end by. Near a crossing both are in proportion to 1 / D, so within the root of EPS
of it no computed pose tells the branches apart: a motion may end there, and does not go on from there.
"""

from __future__ import annotations

from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.chebyshev import interpolation
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.newton import Converged
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Share of the distance within which an assembly is alone that may lie between it and the series.
NEAR = 0.25
# Degree of an interpolant, places at which it is looked at, by what factor a segment is divided finer where
# it shows nothing, and into how many parts at most.
DEGREE, BETWEEN, FINER, MOST_PARTS = 6, 17, 4, 16
# What must be left of a determinant: of its largest value, so that no zero is missed between the places; and
# of the last two coefficients, which are larger than the sum of those after them.
LEAST, BEYOND = 0.03, 4.0
# Where EPS |X|^2 is smaller, rounding hides nothing: of coordinates near 1 omega |X| d is at most some
# thousand times that.
CLEAR = 1e-6
# Below 1 by more than what rounding makes of a few sums of C_u's entries.
SURE = 1.0 - 1e-9


def orientation(system: QuadraticMap, factors: Factors) -> Array:
    """The signs of the determinants of the diagonal blocks of C_u, shape (..., blocks); 0 of a singular one.

    Rows are scaled by positive numbers, which changes no sign.
    """
    signs = np.empty((*factors.matrix.shape[:-2], len(system.structure.blocks)))
    for one in system.structure.diagonal:
        blocks = factors.matrix[..., one.rows[:, :, None], one.unknowns[:, None, :]]
        single = blocks.shape[-1] == 1
        signs[..., one.numbers] = np.sign(blocks[..., 0, 0]) if single else np.linalg.slogdet(blocks)[0]
    return signs


def same_signs(one: Array, other: Array) -> NDArray[np.bool_]:
    """Whether all signs of orientations, (..., blocks), are the same, and none is 0 or no number, (...,)."""
    return np.asarray((one * other > 0.0).all(axis=-1))


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
    same = same_signs(orientation(system, factors), side)
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
        noise = (np.abs(inverse) @ rows[..., None])[..., 0].max(axis=-1)
        return np.asarray(doubtful & ~(system.lipschitz(inverse) * noise <= 1.0))


def surely_regular(system: QuadraticMap, factors: Factors, change: Array) -> NDArray[np.bool_]:
    """Whether C_u is regular at every pose whose coordinates are at most `change` off those of one, (...,).

    C_u is linear in y, so that |I - X C_u| is at most |X| |C_u|(change), with the magnitudes of all terms;
    where this is below 1 in the maximum norm no such C_u has a null vector.

    Args:
        factors: of C_u at that one, X its inverse. change: shape (..., size).
    """
    with np.errstate(all="ignore"):
        moved = np.abs(factors.preconditioner) @ system.jacobian_uncertainty(change)
        return np.asarray(moved.sum(axis=-1).max(axis=-1) < SURE)


def regular_along(system: QuadraticMap, series: Array, s: float) -> NDArray[np.bool_]:
    """Whether no block of C_u is singular on a segment of a series, from 0 to s, shape (...,).

    Args:
        series: coefficients, shape (..., order + 1, size).
    """
    order, parts = series.shape[-2] - 1, 1
    scaled = series * (s ** np.arange(order + 1.0))[:, None]
    while True:
        y = _powers(order, parts) @ scaled
        good = regular_between(system, y.reshape(*y.shape[:-2], parts, DEGREE + 1, -1)).all(axis=-1)
        if parts >= MOST_PARTS or good.all():
            return np.asarray(good)
        parts *= FINER


def regular_between(system: QuadraticMap, y: Array, variables: int = 1) -> NDArray[np.bool_]:
    """Whether no block of C_u is singular on lines of poses, shape (...,), as far as their interpolants show.

    Args:
        y: at Chebyshev's places on a line, shape (..., DEGREE + 1, size), or on a grid of as many lines of
            each of several variables, one axis for each.
    """
    with np.errstate(all="ignore"):
        sign, size = _determinants(system, y)
        good = np.ones(y.shape[: -1 - variables], dtype=bool)
        for axis in range(-1 - variables, -1):
            along = np.swapaxes(sign * np.exp(size - size.max(axis=axis, keepdims=True)), axis, -2)
            found = _finer() @ along
            # What is not finite is not above anything.
            clear = np.maximum(found.min(axis=-2), -found.max(axis=-2)) > LEAST
            good &= clear.all(axis=tuple(range(-variables, 0)))
        return good


def _determinants(system: QuadraticMap, y: Array) -> tuple[Array, Array]:
    """Signs and logarithms of the determinants of the diagonal blocks of C_u, each (..., blocks)."""
    entries = system.entries(y)
    count = len(system.structure.blocks)
    sign, size = np.empty((*y.shape[:-1], count)), np.empty((*y.shape[:-1], count))
    for numbers, rows, kept, places in _diagonal_entries(system):
        if rows == 1:
            blocks = entries[..., kept]
            sign[..., numbers], size[..., numbers] = np.sign(blocks), np.log(np.abs(blocks))
            continue
        blocks = np.zeros((*y.shape[:-1], len(numbers) * rows * rows))
        blocks[..., places] = entries[..., kept]
        blocks = blocks.reshape(*y.shape[:-1], len(numbers), rows, rows)
        sign[..., numbers], size[..., numbers] = np.linalg.slogdet(blocks)
    return sign, size


@lru_cache(maxsize=64)
def _diagonal_entries(system: QuadraticMap) -> tuple[tuple[Indices, int, Indices, Indices], ...]:
    """Of the diagonal blocks of each size: numbers, rows, which entries of C_u they have, and where."""
    n, found = system.unknowns, []
    for one in system.structure.diagonal:
        count, size = one.rows.shape
        place = np.full(len(system.rows) * n, -1)
        place[(one.rows[:, :, None] * n + one.unknowns[:, None, :]).ravel()] = np.arange(count * size * size)
        there = place[system.filled]
        kept = np.flatnonzero(there >= 0)
        found.append((one.numbers, size, kept, there[kept]))
    return tuple(found)


@lru_cache(maxsize=256)
def _powers(order: int, parts: int) -> Array:
    """Powers of Chebyshev's places on the parts of a segment of length 1, part after part."""
    places = (np.arange(parts)[:, None] + 0.5 + 0.5 * interpolation(DEGREE).points) / parts
    return np.asarray(places.ravel()[:, None] ** np.arange(order + 1))


@cache
def _finer() -> Array:
    """From values at Chebyshev's places to those between, with what may be beyond the degree either way."""
    coefficients = interpolation(DEGREE).coefficients
    between = np.polynomial.chebyshev.chebvander(np.linspace(-1.0, 1.0, BETWEEN), DEGREE) @ coefficients
    last, before = BEYOND * coefficients[-1], BEYOND * coefficients[-2]
    return np.concatenate([between + a * last + b * before for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
