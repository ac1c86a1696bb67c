r"""Newton's method on the quadratic map, continued to the tolerance or until rounding stops it.

    C_u(y) du = -(C(y) - offset),      u <- u + du

by LU with partial pivoting (see `linear`). A step ends the iteration

- if it is no larger than its own rounding error, |C_u^-1| times the uncertainty of C(y): it is noise then,
  not progress;
- or if the bound of the *next* step is already below the tolerance. Because C is quadratic, a step d leaves
  C(y + d) = B(d, d) exactly. With X = C_u(y)^-1, q = |X B(d, d)|, omega = Lipschitz(X C_u) and
  z = omega |d| >= |I - X C_u(y + d)|, the theorem (see `kantorovich`) with eta = q bounds |u* - u|, and no
  other solution lies nearby. So a tolerance saves the step that would only confirm the solution, with its
  factorisation. An infinite tolerance only asks that the solution is the only one nearby.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb
from types import EllipsisType

import numpy as np

from pointcoord.numerics.arrays import Array, Flags, Indices, Integers
from pointcoord.numerics.counters import Work
from pointcoord.numerics.kantorovich import smallest_radius
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

# From a start inside the Kantorovich region the error is squared at every step: 2^-1 falls below 2^-53 in
# six steps. Twice that leaves room for starts outside the region that still converge.
LIMIT = 12
# Upper bound of a step's rounding error in units of eps times the condition number: rows are sums of some ten
# products of coordinates near 1, each rounded a few times. A larger step is certainly not noise.
ROUNDINGS = 1e4
LARGEST = float(np.finfo(float).max)


@dataclass(frozen=True)
class Converged:
    """Result of Newton's method, with any leading batch dimensions.

    Attributes:
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y before the last step.
        converged: whether the last step was noise, or the remaining error is below the tolerance, shape
            (...,).
        iterations: steps taken by each member, shape (...,).
        first_step: largest component of the first step, shape (...,).
        left: proven distance to the solution, without rounding, of members that ended by the tolerance,
            shape (...,); zero for those that ended in noise.
        last_step: largest component of the last step, shape (...,).
        work: operations.
        lipschitz: Lipschitz constant of X C_u, with the inverse X of the last step; NaN where not computed.
    """

    y: Array
    factors: Factors
    converged: Flags
    iterations: Integers
    first_step: Array
    left: Array
    last_step: Array
    work: Work
    lipschitz: Array | float = np.nan


def newton_refine(
    system: QuadraticMap, y: Array, offset: Array | float = 0.0, tolerance: Array | float = 0.0
) -> Converged:
    """Solve C(u, w) = offset for the unknowns of y, starting from y's unknowns.

    Args:
        y: start, shape (..., size); the known coordinates stay as they are.
        offset: wanted residual, shape (..., rows).
        tolerance: allowed distance to the solution, without rounding, shape (...,); zero unless given.
    Returns:
        The solution; members that do not converge are marked, raise no error, and keep their last y.
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
    # First all members, of any dimensions; once one has ended, the numbers of the others.
    active: EllipsisType | Indices = ...
    factors: Factors | None = None
    with np.errstate(all="ignore"):
        for count in range(LIMIT):
            here = y[active]
            local = factorise(system.jacobian(here))
            factors = local if factors is None or active is ... else factors.replaced(active, local)
            step = -local.solve(system.residual(here) - offset[active])
            sizes = np.abs(step)
            # A start that is not finite gives a step that is not finite.
            size = sizes.max(axis=-1)
            usable = np.isfinite(size) & ~local.singular
            y[active, :n] += np.where(usable[..., None], step, 0.0)
            if count == 0:
                first_step = np.asarray(size)
            # A member that ends in noise has no larger remaining error, whatever an earlier step left.
            rest = np.zeros(size.shape)
            done = np.zeros(size.shape, dtype=bool)
            if asked:
                lipschitz[active] = omega = system.lipschitz(local.preconditioner)
                rest = what_is_left(system, local, step, size, omega)
                done = usable & (rest <= allowed[active])
            if np.count_nonzero(done) < size.size:
                rounding = _noise(system, here, local, size)
                # Below the square root of the rounding unit the next step would be noise too. So a step that
                # no longer shrinks there is noise, which the bound above underestimated.
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
    assert factors is not None  # LIMIT is at least 1
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
    """Factors of C_u at a solution: Newton's own, from before its last step, where these are accurate enough.

    With z = omega |last step|, their solutions have a relative error of z^2, which must be below rounding or
    the tolerance.
    """
    matrix, omega = system.jacobian(reached.y), reached.lipschitz
    if np.isnan(omega).any():
        omega = system.lipschitz(reached.factors.preconditioner)
    with np.errstate(all="ignore"):
        z = omega * reached.last_step
        near = (z * z <= max(EPS, tolerance)).all()
    if near:
        return reached.factors.moved(matrix), Work()
    return factorise(matrix), Work(factorisations=reached.converged.size)


def rounding_of(system: QuadraticMap, reached: Converged) -> Array:
    """Largest component of the last step's rounding error, shape (...,); zero if the step is far larger."""
    return np.asarray(_noise(system, reached.y, reached.factors, reached.last_step).max(axis=-1))


def _noise(system: QuadraticMap, y: Array, factors: Factors, size: Array) -> Array:
    """Rounding error of a Newton step, shape (members, unknowns); zero if every step is far above it."""
    if (size > ROUNDINGS * EPS * factors.condition).all():
        return np.zeros((*size.shape, system.unknowns))
    rows = system.uncertainty(y, np.zeros(y.shape[-1]))
    return np.asarray(np.matvec(np.abs(factors.preconditioner), rows))


def what_is_left(system: QuadraticMap, factors: Factors, step: Array, size: Array, omega: Array) -> Array:
    """Proven distance to the solution after a Newton step d, without rounding, shape (...,).

    Infinite where nothing is proven; see the formula above. The caller handles floating point warnings.

    Args:
        factors: of C_u at the start of the step. step: d, shape (..., unknowns).
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
    r"""Derivatives of poses and of their time derivatives by a parameter x of the known coordinates.

    In C(y(t, x)) = B(y, y) = 0, the terms of order d in t and 1 in x are

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
