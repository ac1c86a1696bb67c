r"""Newton's method on the quadratic map, carried on until it is as good as asked or rounding stops it.

    C_u(y) du = -(C(y) - offset),      u <- u + du

LU with partial pivoting (see `linear`). A step ends the iteration

- when it is no larger than its own rounding error, |C_u^-1| times the uncertainty of C(y): what is left is
  noise, not progress;
- or when what the *next* step would be at most is already below the tolerance. Because C is quadratic, a step
  d leaves C(y + d) = B(d, d) exactly. With X = C_u(y)^-1, q = |X B(d, d)|, omega = Lipschitz(X C_u) and
  z = omega |d| >= |I - X C_u(y + d)|, the theorem (see `kantorovich`) with eta = q bounds |u* - u|, and no
  other solution lies nearby. So a tolerance saves the step that would only confirm it, and its factorisation;
  an infinite one asks for no more than that the solution is the only one here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from types import EllipsisType

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import smallest_radius
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# From a start inside the Kantorovich region the error squares at every step: 2^-1 falls below 2^-53 in
# six steps. Twice that leaves room for starts outside the region that still converge.
LIMIT = 12
# The rounding error of a step in parts of eps times the condition number, at most: rows are sums of some ten
# products of coordinates near 1, each rounded a few times. A larger step need not be compared with it.
ROUNDINGS = 1e4
LARGEST = float(np.finfo(float).max)


@dataclass(frozen=True)
class Converged:
    """What Newton's method reached, any leading batch dimensions.

    Attributes:
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y up to the last step.
        converged: whether the last step was noise, or what it leaves is below the tolerance, shape (...,).
        iterations: steps taken by each member, shape (...,).
        first_step: largest component of the first step, shape (...,).
        left: proven distance to the solution, rounding apart, of members that ended by the tolerance,
            shape (...,); zero of those that ended in noise.
        last_step: largest component of the last step, shape (...,).
        work: what it cost.
        lipschitz: of X C_u, X the inverse that the last step was made with; not a number where it was not
            needed.
    """

    y: Array
    factors: Factors
    converged: NDArray[np.bool_]
    iterations: NDArray[np.int64]
    first_step: Array
    left: Array
    last_step: Array
    work: Work
    lipschitz: Array | float = np.nan

    def lipschitz_with(self, system: QuadraticMap, factors: Factors) -> Array:
        """The Lipschitz constant of X C_u with the inverse of some factors, shape (...,)."""
        known = factors.inverse is self.factors.inverse and not np.isnan(self.lipschitz).any()
        return np.asarray(self.lipschitz) if known else system.lipschitz(factors.preconditioner)


def newton_refine(
    system: QuadraticMap, y: Array, offset: Array | float = 0.0, tolerance: Array | float = 0.0
) -> Converged:
    """Solve C(u, w) = offset for the unknowns of y, starting from them.

    Args:
        y: start, shape (..., size); the known coordinates stay as they are.
        offset: wanted residual, shape (..., rows).
        tolerance: allowed distance to the solution, rounding apart, shape (...,); none unless given.
    Returns:
        The solution; members that do not converge are marked, never raised, and keep their last y.
    """
    n, batch, members = system.unknowns, y.shape[:-1], y.shape[:-1]
    y, offset, allowed = y.copy(), np.asarray(offset), np.minimum(tolerance, LARGEST)
    if batch:
        y = y.reshape(-1, y.shape[-1])
        members = y.shape[:1]
        offset = np.broadcast_to(offset, (*batch, len(system.rows))).reshape(-1, len(system.rows))
        allowed = np.broadcast_to(allowed, batch).reshape(members)
    asked = np.count_nonzero(allowed) > 0
    converged, iterations = np.zeros(members, dtype=bool), np.zeros(members, dtype=np.int64)
    first_step, left = np.zeros(members), np.zeros(members)
    previous, lipschitz = np.full(members, np.inf), np.full(members, np.nan)
    # All members, of whatever dimensions, and from where the first of them ends the others by number.
    active: EllipsisType | NDArray[np.intp] = ...
    factors: Factors | None = None
    with np.errstate(all="ignore"):
        for count in range(LIMIT):
            here = y[active]
            local = factorise(system.jacobian(here))
            factors = local if factors is None or active is ... else factors.replaced(active, local)
            step = -local.solve(system.residual(here) - offset[active])
            sizes = np.abs(step)
            # A start that is not finite shows as a step that is not.
            size = sizes.max(axis=-1)
            usable = np.isfinite(size) & ~local.singular
            y[active, :n] += np.where(usable[..., None], step, 0.0)
            if count == 0:
                first_step = np.asarray(size)
            # What ends in noise has no more left than that, whatever a step before it left.
            rest = np.zeros(size.shape)
            done = np.zeros(size.shape, dtype=bool)
            if asked:
                lipschitz[active] = omega = system.lipschitz(local.preconditioner)
                rest = what_is_left(system, local, step, size, omega)
                done = usable & (rest <= allowed[active])
            if np.count_nonzero(done) < size.size:
                rounding = _noise(system, here, local, size)
                # Below the square root of the rounding unit the error of the next step would be noise as
                # well, so a step that no longer shrinks there is noise that the bound above judged too low.
                stalled = (size < 1e-8) & (size >= 0.5 * previous[active])
                rest = np.where(done, rest, 0.0)
                done = done | (usable & (stalled | (sizes <= rounding).all(axis=-1)))
            iterations[active], converged[active], previous[active] = count + 1, done, size
            left[active] = rest
            going = usable & ~done
            if not np.count_nonzero(going):
                break
            if np.count_nonzero(going) < size.size:
                active = np.flatnonzero(going) if active is ... else active[going]
    assert factors is not None  # LIMIT is no less than 1
    taken = int(iterations.sum())
    return Converged(
        y=y.reshape(*batch, y.shape[-1]),
        factors=factors.reshaped(batch) if batch else factors,
        converged=converged.reshape(batch),
        iterations=iterations.reshape(batch),
        first_step=first_step.reshape(batch),
        left=left.reshape(batch),
        last_step=previous.reshape(batch),
        work=Work(residuals=taken, factorisations=taken),
        lipschitz=lipschitz.reshape(batch),
    )


def factors_at(system: QuadraticMap, reached: Converged, tolerance: float = 0.0) -> tuple[Factors, Work]:
    """Factors of C_u at a solved place; Newton's own, of the place before its last step, where these do.

    With z = omega |last step| their solutions are off by z^2 of themselves, which is to be rounding or below
    a tolerance.
    """
    matrix = system.jacobian(reached.y)
    with np.errstate(all="ignore"):
        z = reached.lipschitz_with(system, reached.factors) * reached.last_step
        near = (z * z <= max(EPS, tolerance)).all()
    if near:
        return reached.factors.moved(matrix), Work()
    return factorise(matrix), Work(factorisations=reached.converged.size)


def rounding_of(system: QuadraticMap, reached: Converged) -> Array:
    """Largest component of the rounding error of a last step, shape (...,); zero where that is far larger."""
    return np.asarray(_noise(system, reached.y, reached.factors, reached.last_step).max(axis=-1))


def _noise(system: QuadraticMap, y: Array, factors: Factors, size: Array) -> Array:
    """Rounding error of a Newton step, shape (members, unknowns); zero if every step is far above it."""
    if (size > ROUNDINGS * EPS * factors.condition).all():
        return np.zeros((*size.shape, system.unknowns))
    rows = system.uncertainty(y, np.zeros(y.shape[-1]))
    return np.asarray(np.matvec(np.abs(factors.preconditioner), rows))


def what_is_left(system: QuadraticMap, factors: Factors, step: Array, size: Array, omega: Array) -> Array:
    """Proven distance to the solution after a Newton step d, rounding apart, shape (...,).

    Infinite where nothing is proven; see the formula above. Floating point warnings are the caller's.

    Args:
        factors: of C_u at the place that the step started from. step: d, shape (..., unknowns).
        size: |d|, shape (...,). omega: Lipschitz constant of X C_u, shape (...,).
    """
    d = np.zeros((*step.shape[:-1], system.size))
    d[..., : system.unknowns] = step
    bent = np.matvec(factors.preconditioner, system.residual(d))
    return smallest_radius(np.abs(bent).max(axis=-1), omega * size, omega)


def implicit_rate(
    system: QuadraticMap, factors: Factors, y: Array, driven: Array, quadratic: Array | float
) -> Array:
    """Solve C_u u^(d) = -(C_w w^(d) + quadratic term) for a derivative of poses y, (N, size).

    Args:
        driven: w^(d), (..., N, known coordinates).
    """
    rate = np.zeros((*driven.shape[:-1], system.size))
    rate[..., system.unknowns :] = driven
    rate[..., : system.unknowns] = -factors.solve(2.0 * system.polar(y, rate) + quadratic)
    return rate


def implicit_slopes(
    system: QuadraticMap, factors: Factors, states: Sequence[Array], driven: Sequence[Array]
) -> list[Array]:
    r"""What poses and their time derivatives change by with a parameter x of the known coordinates.

    Of C(y(t, x)) = B(y, y) = 0 the terms of order d in t and 1 in x are

        C_u u_x^(d) = -( C_w w_x^(d) + sum_{0 < i <= d} binomial(d, i) 2 B(y^(i), y_x^(d-i)) ).

    Args:
        factors: of C_u at the poses.
        states: y^(d), poses and their time derivatives, each (N, size).
        driven: w_x^(d), each (..., N, known coordinates).
    Returns:
        y_x^(d), each (..., N, size).
    """
    found: list[Array] = []
    for d, own in enumerate(driven):
        mixed = (2 * comb(d, i) * system.polar(states[i], found[d - i]) for i in range(1, d + 1))
        found.append(implicit_rate(system, factors, states[0], own, sum(mixed, 0.0)))
    return found
