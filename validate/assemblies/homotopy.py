r"""All isolated solutions of n quadratic forms in n + 1 homogeneous unknowns, by continuation.

The forms x^T Q_r x are reached from c_r ((l_r . x)^2 - (l_0 . x)^2), which have 2^n known solutions, along

    (1 - t) c_r ((l_r . x)^2 - (l_0 . x)^2) + t x^T Q_r x = 0,      t from 0 to 1.

With random lines l and factors c every isolated solution is the end of a path, with probability one
(Sommese, Wampler, *The Numerical Solution of Systems of Polynomials*, 2005, ch. 8); if solutions form curves,
the other paths end on these. All paths are followed in parallel: a Runge-Kutta step of order 4 along the
tangent, then Newton steps at right angles to x. If the first Newton step of a path is long, the step is
halved.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from validate.arrays import Array

Complex = NDArray[np.complex128]

FIRST = 0.01
# Newton steps of a unit vector: a first step longer than NEAR might lead to another path; a last step below
# ARRIVED is at rounding level.
NEAR, ARRIVED = 1e-4, 1e-11
NEWTON, LAST = 3, 5
# From END on, a regular solution is one Newton step away. Only a path that ends on a curve of solutions takes
# steps below SHORTEST.
END, SHORTEST = 1.0 - 1e-8, 1e-13
CLOSE = 1e-3
SINGULAR = 1e9  # condition number from which an end may lie on a curve of solutions
MOST = 5000  # largest number of steps of a path


def solve_quadratic(forms: Array, seed: int = 0) -> Complex:
    """Follow all 2^n paths to the solutions of n quadratic forms, (n, n + 1, n + 1).

    Args:
        seed: seed of the random lines and factors.
    Returns:
        Ends of paths, unit vectors, (ends, n + 1), without singular solutions and solutions on curves.
    """
    both, x = _started(forms, np.random.default_rng(seed))
    t, step, good = np.zeros(len(x)), np.full(len(x), FIRST), np.zeros(len(x), dtype=int)
    active = np.arange(len(x))
    with np.errstate(all="ignore"):
        for _ in range(MOST):
            if not len(active):
                break
            length = np.minimum(step[active], END - t[active])
            ahead = _predicted(both, x[active], t[active], length)
            ahead, sizes = _corrected(both, ahead, t[active] + length, x[active], NEWTON)
            there = (sizes[0] < NEAR) & (sizes[-1] < ARRIVED)
            moved, stuck = active[there], active[~there]
            x[moved], t[moved] = ahead[there], t[moved] + length[there]
            good[moved] += 1
            grown = moved[good[moved] >= 2]
            step[grown] *= 2.0
            step[stuck] *= 0.5
            good[grown] = good[stuck] = 0
            active = active[(t[active] < END) & (step[active] > SHORTEST)]
        near, one = x[t >= END], np.ones(np.count_nonzero(t >= END))
        ends, sizes = _corrected(both, near, one, near, LAST)
        matrices = _bordered(_at(both, ends, one)[1], near)
        return np.asarray(ends[(sizes[0] < CLOSE) & (np.linalg.cond(matrices) < SINGULAR)])


def _started(forms: Array, random: np.random.Generator) -> tuple[Complex, Complex]:
    """The forms at t = 0 and at t = 1, (2, n, n + 1, n + 1), and the solutions at t = 0, (2^n, n + 1)."""
    count = len(forms)
    # Orthonormal lines l, (n + 1, n + 1), and the solutions l_r . x = +-l_0 . x of unit length.
    shape = (count + 1, count + 1)
    lines, _ = np.linalg.qr(random.normal(size=shape) + 1j * random.normal(size=shape))
    signs = 1.0 - 2.0 * ((np.arange(2**count)[:, None] >> np.arange(count)) & 1)
    x = np.concatenate([np.ones((2**count, 1)), signs], axis=1) / np.sqrt(count + 1.0) @ lines.conj()
    squares = lines[:, :, None] * lines[:, None, :]
    factors = np.exp(2j * np.pi * random.uniform(size=(count, 1, 1)))
    return np.stack([factors * (squares[1:] - squares[0]), forms]), x


def _at(both: Complex, x: Complex, t: Array) -> tuple[Complex, Complex, Complex]:
    """Values, (P, n), derivatives by x, (P, n, n + 1), and by t, (P, n), of points (P, n + 1)."""
    start, goal = np.einsum("srij,pj->spri", both, x)
    row = start + t[:, None, None] * (goal - start)
    value, change = (np.einsum("pri,pi->pr", rows, x) for rows in (row, goal - start))
    return value, 2.0 * row, change


def _predicted(both: Complex, x: Complex, t: Array, step: Array) -> Complex:
    """Points after a Runge-Kutta step of each path."""

    def tangent(y: Complex, share: float) -> Complex:
        _, rows, change = _at(both, y, t + share * step)
        return _solved(rows, x, -change)

    along = step[:, None]
    first = tangent(x, 0.0)
    second = tangent(x + 0.5 * along * first, 0.5)
    third = tangent(x + 0.5 * along * second, 0.5)
    fourth = tangent(x + along * third, 1.0)
    return x + along * (first + 2.0 * second + 2.0 * third + fourth) / 6.0


def _corrected(
    both: Complex, y: Complex, t: Array, normal: Complex, steps: int
) -> tuple[Complex, list[Array]]:
    """Unit vectors after Newton steps at right angles to a vector, and the relative length of each step."""
    sizes = []
    for _ in range(steps):
        value, rows, _ = _at(both, y, t)
        change = _solved(rows, normal, -value)
        y = y + change
        sizes.append(np.linalg.norm(change, axis=1) / np.linalg.norm(y, axis=1))
    return y / np.linalg.norm(y, axis=1, keepdims=True), sizes


def _bordered(rows: Complex, normal: Complex) -> Complex:
    return np.concatenate([rows, normal.conj()[:, None, :]], axis=1)


def _solved(rows: Complex, normal: Complex, values: Complex) -> Complex:
    """The d at right angles to a vector with rows d = values; NaN where this is singular."""
    matrix = _bordered(rows, normal)
    right = np.concatenate([values, np.zeros((len(values), 1))], axis=1)
    usable = np.isfinite(matrix).all(axis=(1, 2)) & (np.linalg.det(matrix) != 0.0)
    matrix[~usable] = np.eye(matrix.shape[-1])
    right[~usable] = np.nan
    return np.asarray(np.linalg.solve(matrix, right[..., None])[..., 0])
