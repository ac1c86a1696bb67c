r"""Newton's method on the quadratic map, carried on until it is as good as asked or rounding stops it.

    C_u(y) du = -(C(y) - offset),      u <- u + du

LU with partial pivoting (see `linear`). A step ends the iteration

- when it is no larger than its own rounding error, |C_u^-1| times the uncertainty of C(y): what is left is
  noise, not progress;
- or when what the *next* step would be at most is already below the tolerance. Because C is quadratic, a step
  d leaves C(y + d) = B(d, d) exactly. With X = C_u(y)^-1, q = |X B(d, d)|, omega = Lipschitz(X C_u) and
  z = omega |d| >= |I - X C_u(y + d)|, Newton and Kantorovich's theorem (see `kantorovich`) about y + d says

      h = 2 omega q / (1 - z)^2 <= 1:      |u* - u| <= 2 q / ((1 - z)(1 + sqrt(1 - h))),

  and that no other solution lies nearby. So a tolerance saves the step that would only confirm it, and its
  factorisation; an infinite one asks for no more than that the solution is the only one here.
"""

from __future__ import annotations

from math import isfinite, sqrt

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.counters import Work
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
        noise: largest component of the rounding error of the last step, shape (...,); zero where the step was
            far above it, or where one start ended by the tolerance (see `rounding_of`).
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
    noise: Array
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
    if y.ndim == 1:
        return _refine_one(system, y, offset, float(tolerance))
    return refine_plainly(system, y, offset, tolerance)


def _refine_one(system: QuadraticMap, y: Array, offset: Array | float, tolerance: float) -> Converged:
    """The same steps for one start, with plain numbers where `refine_plainly` has arrays of one."""
    n, y = system.unknowns, y.copy()
    converged, iterations = False, 0
    first_step, last_noise, left, previous, lipschitz = np.nan, np.inf, 0.0, np.inf, np.nan
    with np.errstate(all="ignore"):
        while iterations < LIMIT:
            factors = factorise(system.jacobian(y))
            step = -factors.solve(system.residual(y) - offset)
            # A number that is none may hide behind others from Python's own maximum, and a sum shows it.
            sizes = np.abs(step).tolist()
            size = max(sizes) if isfinite(sum(sizes)) else np.inf
            iterations += 1
            first_step = size if iterations == 1 else first_step
            last_noise = np.inf
            if not size < np.inf or factors.singular:
                previous = size
                break
            y[:n] += step
            if tolerance > 0.0:
                lipschitz = float(system.lipschitz(factors.preconditioner))
                left = left_of_one(system, factors, step, size, lipschitz)
                converged = left <= min(tolerance, LARGEST)
            if not converged:
                # What ends in noise has no more left than that.
                last_noise, converged = 0.0, size < 1e-8 and size >= 0.5 * previous
                if not size > ROUNDINGS * EPS * float(factors.condition):
                    noise = _noise(system, y, factors, np.asarray(size))
                    converged = converged or bool((np.abs(step) <= noise).all())
                    last_noise = float(noise.max())
                left = 0.0 if converged else left
            else:
                last_noise = 0.0
            previous = size
            if converged:
                break
    return Converged(
        y=y,
        factors=factors,
        converged=np.asarray(converged),
        iterations=np.asarray(iterations),
        first_step=np.asarray(first_step),
        noise=np.asarray(last_noise),
        left=np.asarray(left),
        last_step=np.asarray(previous),
        work=Work(residuals=iterations, factorisations=iterations),
        lipschitz=np.asarray(lipschitz),
    )


def refine_plainly(
    system: QuadraticMap, y: Array, offset: Array | float = 0.0, tolerance: Array | float = 0.0
) -> Converged:
    """The same for any batch, each member of which goes on until its own end."""
    batch, n = y.shape[:-1], system.unknowns
    y = y.reshape(-1, y.shape[-1]).copy()
    offset = np.broadcast_to(offset, (*batch, len(system.rows))).reshape(-1, len(system.rows))
    allowed = np.broadcast_to(tolerance, batch).ravel()
    members = len(y)
    converged = np.zeros(members, dtype=bool)
    iterations = np.zeros(members, dtype=np.int64)
    first_step = np.full(members, np.nan)
    last_noise = np.full(members, np.inf)
    left = np.zeros(members)
    previous = np.full(members, np.inf)
    active = np.arange(members)
    factors: Factors | None = None
    evaluations = 0
    for _ in range(LIMIT):
        here = y[active]
        evaluations += len(active)
        # A start that is not finite shows as a step that is not, which is checked below.
        with np.errstate(invalid="ignore", over="ignore"):
            local = factorise(system.jacobian(here))
            factors = local if factors is None else factors.replaced(active, local)
            step = -local.solve(system.residual(here) - offset[active])
            size = np.abs(step).max(axis=-1)
            noise = _noise(system, here, local, size)
        usable = np.isfinite(size) & ~local.singular
        # Below the square root of the rounding unit the error of the next step would be noise as well,
        # so a step that no longer shrinks there is noise that the bound above judged too low.
        stalled = (size < 1e-8) & (size >= 0.5 * previous[active])
        small = (np.abs(step) <= noise).all(axis=-1) | stalled
        iterations[active] += 1
        first_step[active] = np.where(np.isnan(first_step[active]), size, first_step[active])
        last_noise[active] = noise.max(axis=-1)
        previous[active] = size
        y[active, :n] += np.where(usable[:, None], step, 0.0)
        wanted = allowed[active]
        # What ends in noise has no more left than that, whatever a step before it left.
        left[active] = 0.0
        if (usable & ~small & (wanted > 0.0)).any():
            rest = what_is_left(system, local, step)
            left[active] = np.where(small, 0.0, rest)
            small = small | (rest <= np.minimum(wanted, np.finfo(float).max))
        converged[active] = usable & small
        active = active[usable & ~small]
        if not active.size:
            break
    if factors is None:
        factors = factorise(system.jacobian(y))
    return Converged(
        y=y.reshape(*batch, -1),
        factors=factors.reshaped(batch),
        converged=converged.reshape(batch),
        iterations=iterations.reshape(batch),
        first_step=first_step.reshape(batch),
        noise=last_noise.reshape(batch),
        left=left.reshape(batch),
        last_step=previous.reshape(batch),
        work=Work(residuals=evaluations, factorisations=evaluations),
    )


def rounding_of(system: QuadraticMap, reached: Converged) -> Array:
    """Largest component of the rounding error of a last step, shape (...,); zero where that is far larger."""
    return np.asarray(_noise(system, reached.y, reached.factors, reached.last_step).max(axis=-1))


def _noise(system: QuadraticMap, y: Array, factors: Factors, size: Array) -> Array:
    """Rounding error of a Newton step, shape (members, unknowns); zero if every step is far above it."""
    if (size > ROUNDINGS * EPS * factors.condition).all():
        return np.zeros((*size.shape, system.unknowns))
    rows = system.uncertainty(y, np.zeros(y.shape[-1]))
    return np.asarray((np.abs(factors.preconditioner) @ rows[..., None])[..., 0])


def left_of_one(system: QuadraticMap, factors: Factors, step: Array, size: float, lipschitz: float) -> float:
    """What `what_is_left` says of one step, of a size and with a Lipschitz constant that are at hand."""
    d = np.zeros(system.size)
    d[: system.unknowns] = step
    bent = np.abs(factors.preconditioner.dot(system.residual(d))).tolist()
    q, room = max(bent), 1.0 - lipschitz * size
    if not (room > 0.0 and isfinite(sum(bent))):
        return np.inf
    constant = 2.0 * lipschitz * q / (room * room)
    return 2.0 * q / (room * (1.0 + sqrt(1.0 - constant))) if constant < 1.0 else np.inf


def what_is_left(system: QuadraticMap, factors: Factors, step: Array) -> Array:
    """Proven distance to the solution after a Newton step d, rounding apart, shape (...,).

    Infinite where nothing is proven; see the formula above.

    Args:
        factors: of C_u at the place that the step started from. step: d, shape (..., unknowns).
    """
    d = np.zeros((*step.shape[:-1], system.size))
    d[..., : system.unknowns] = step
    inverse = factors.preconditioner
    with np.errstate(all="ignore"):
        rows = system.residual(d)
        bent = inverse.dot(rows) if rows.ndim == 1 else (inverse @ rows[..., None])[..., 0]
        q = np.abs(bent).max(axis=-1)
        omega = system.lipschitz(inverse)
        room = 1.0 - omega * np.abs(step).max(axis=-1)
        constant = 2.0 * omega * q / room**2
        rest = 2.0 * q / (room * (1.0 + np.sqrt(np.maximum(1.0 - constant, 0.0))))
    return np.where((room > 0.0) & (constant < 1.0), rest, np.inf)
