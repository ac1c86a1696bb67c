r"""A straight path of the known coordinates, solved by one power series and proven in pieces.

Between two sets of known coordinates, w(s) = w_0 + s (w_1 - w_0), and with what is not yet assembled taken
back in proportion, C(y(s)) = (1 - s) c, the unknowns are a power series in s. Cut after order p it leaves

    C(p(s)) - (1 - s) c = sum_{p < k <= 2p} R_k s^k,      R_k = sum_{i + j = k} B(y_i, y_j)    exactly,

because C is quadratic. On a piece of the path, |s - m| <= h, with X close to C_u(p(m))^-1 and C_u(p(m + t)) =
sum J_k t^k, which is linear in the series,

    |I - X C_u(p)| <= Z = |I - X J_0| + sum_{k>0} |X J_k| h^k,
    |X (C(p) - (1 - s) c)| <= Y = sum |X R_k| (m + h)^k,

element by element, and Newton and Kantorovich's theorem (see `kantorovich`) asks for

    z + sqrt(2 omega max Y) <= 1

in a weighted maximum norm. Then one assembly lies near p(s) for every s of the piece, C_u is regular there,
and so the assemblies go on from each other. Neighbouring pieces share a place, where both find the same
assembly, because the norm is the same: the smaller of two balls about one place lies in the other.

All pieces are proven at once. Where a series does not reach the end, another one starts from the last place
that is proven.
"""

from __future__ import annotations

from functools import cache
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.branch import hidden, orientation, same_side
from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import used
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import factors_at, newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import LARGE, QuadraticMap
from pointcoord.solve.place import Path
from pointcoord.solve.proven_step import ROOM

Array = NDArray[np.float64]

# Order of a series and pieces in which it is proven. The proof decides; these decide what it costs.
ORDER, PIECES = 14, 2
# Series after which a path is left to smaller steps.
STRETCHES = 3
# What a series may leave out at its end, in parts of 1 / omega, where its length is chosen.
LEFT_OUT = 1e-2
SMALLEST = float(np.finfo(float).tiny)
# Times that weights are brought nearer to those of the smallest norm.
WEIGHINGS = 3


def proven_end(
    system: QuadraticMap, y: Array, target: Array, factors: Factors, tolerance: float
) -> Path | None:
    """The end of a path from one pose, if a few series prove it to be reached; None if not.

    Args:
        y: start, shape (size,), assembled or not. target: known coordinates at the end.
        factors: of C_u at the start.
        tolerance: how far the end may be from the exact assembly, rounding apart, in units.
    """
    if factors.singular or len(system.rows) >= LARGE or bool(hidden(system, y, factors)):
        return None
    n, side = system.unknowns, orientation(system, factors)
    here, local, work = y, factors, Work(residuals=1)
    for _ in range(STRETCHES):
        begun = _begun(system, here, local, target - here[n:])
        series, share, spent = _proven_series(system, begun, local)
        work += spent
        if not share > 0.0:
            return None
        guess = share ** np.arange(len(series)) @ series
        if share == 1.0:
            return _end(system, guess, target, side, tolerance, work)
        # What the series leaves out at its end is taken back along the rest of the path.
        guess[n:] = here[n:] + share * (target - here[n:])
        here, local = guess, factorise(system.jacobian(guess))
        work += Work(residuals=1, factorisations=1)
        if not same_side(system, here, local, side, False):
            return None
    return None


def _end(
    system: QuadraticMap,
    guess: Array,
    target: Array,
    side: Array,
    tolerance: float,
    work: Work,
) -> Path | None:
    """The assembly near a guess with known coordinates, if Newton's method finds it on the same side."""
    guess[system.unknowns :] = target
    reached = newton_refine(system, guess, tolerance=tolerance)
    there, factorised = factors_at(system, reached)
    # In exact arithmetic it converges, and no path crosses a fold, where the determinant's sign changes.
    if not (bool(reached.converged) and bool(same_side(system, reached.y, there, side, True))):
        return None
    work += reached.work + factorised
    return Path(reached.y, there, reached.left, work, reached.iterations, np.array(1.0))


def _begun(system: QuadraticMap, y: Array, factors: Factors, change: Array) -> Array:
    """The first two terms of a path's series, y and its tangent, (2, size).

    What y is not assembled by is taken back along the path.
    """
    begun = np.zeros((2, len(y)))
    begun[0], begun[1, system.unknowns :] = y, change
    with np.errstate(all="ignore"):
        begun[1, : system.unknowns] = -factors.solve(2.0 * system.polar(y, begun[1]) + system.residual(y))
    return begun


def _proven_series(system: QuadraticMap, begun: Array, factors: Factors) -> tuple[Array, float, Work]:
    """The series of a path about its start, the share that it is proven on, and what that takes.

    Args:
        begun: its first two terms.
    """
    known = np.zeros((ORDER + 1, system.size - system.unknowns))
    known[:2] = begun[:, system.unknowns :]
    with np.errstate(all="ignore"):
        series = expand(system, factors, begun[0], known, begun)
        share = _proven_share(system, series, factors)
    # Its orders are no rates of a motion, as the tangents of a path are none.
    return series, share, Work(factorisations=PIECES)


def _proven_share(system: QuadraticMap, series: Array, factors: Factors) -> float:
    """Up to where, from 0 to 1, the assemblies go on along a series; see the formulas above."""
    order, pieces, n = len(series) - 1, PIECES, system.unknowns
    left, right = (np.ascontiguousarray(each) for each in system.factors(series))
    first, second, starts = _beyond(order)
    rest = system.gather(np.add.reduceat(left[first] * right[second], starts, axis=0)) * factors.row_scale
    # As far as what is left out stays small, in the plain norm and with the inverse at the start.
    # A map that does not bend has no other assembly at any distance.
    allowed = LEFT_OUT / max(float(system.lipschitz(factors.preconditioner)), SMALLEST)
    sizes = np.abs(rest @ factors.inverse.T).max(axis=-1)
    powers = np.arange(order + 1.0, 2.0 * order + 1.0)
    reach = min(float(np.min((allowed / sizes) ** (1.0 / powers))), 1.0)
    if not reach > 0.0:
        return 0.0
    # C_u on each piece as a polynomial of what is left and right of its middle, in halves of its length.
    matrices = system.jacobian(series) * factors.row_scale[:, None]
    matrices *= (reach ** np.arange(order + 1.0))[:, None, None]
    local = (_about_middles(order, pieces) @ matrices.reshape(order + 1, -1)).reshape(pieces, -1, n, n)
    inverse = inverses(local[:, 0])
    if inverse is None:
        return 0.0
    flat = np.ascontiguousarray(local.swapaxes(1, 2)).reshape(pieces, n, -1)
    moved = (inverse @ flat).reshape(pieces, n, order + 1, n)
    moved[:, :, 0] -= np.eye(n)
    change = np.ones(order + 1) @ np.abs(moved)
    ends = (reach * np.arange(1.0, pieces + 1.0) / pieces)[:, None] ** powers
    remaining = (np.abs(inverse @ rest.T) @ ends[..., None])[..., 0]
    preconditioner = inverse * factors.row_scale
    weights, largest = np.ones(n), change.max(axis=0)
    for _ in range(WEIGHINGS + 1):
        z = (change.dot(weights) / weights).max(axis=-1)
        omega = system.lipschitz(preconditioner, weights)
        proven = used((remaining / weights).max(axis=-1), z, omega) <= ROOM
        if proven.all():
            return reach
        # Nearer to the weights for which the norm of a matrix of no negative elements is smallest.
        weights = weights + largest.dot(weights) / max(float(z.max()), 1e-300)
        weights /= weights.max()
    return reach * int(np.argmin(proven)) / pieces


def inverses(matrices: Array) -> Array | None:
    """Of the matrices in the middles of the pieces, whose rows are scaled; None where one has none."""
    try:
        return np.asarray(np.linalg.inv(matrices))
    except np.linalg.LinAlgError:
        return None


@cache
def _beyond(order: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Pairs (i, j) of orders up to one, with i + j = k beyond it, by k; and where each k starts."""
    pairs = [(i, k - i) for k in range(order + 1, 2 * order + 1) for i in range(k - order, order + 1)]
    lengths = [2 * order + 1 - k for k in range(order + 1, 2 * order + 1)]
    first, second = np.array(pairs, dtype=np.intp).T
    return first, second, np.cumsum([0, *lengths[:-1]], dtype=np.intp)


@cache
def _about_middles(order: int, pieces: int) -> Array:
    """Matrices that give a polynomial on 0 .. 1 about the middles of pieces, (pieces, order + 1, order + 1).

    sum_k a_k s^k = sum_j (sum_k binomial(k, j) m^(k - j) h^j a_k) t^j for s = m + h t.
    """
    half = 0.5 / pieces
    tables = np.zeros((pieces, order + 1, order + 1))
    for piece in range(pieces):
        middle = (2 * piece + 1) * half
        for k in range(order + 1):
            for j in range(k + 1):
                tables[piece, j, k] = comb(k, j) * middle ** (k - j) * half**j
    return tables
