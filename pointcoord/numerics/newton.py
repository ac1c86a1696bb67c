r"""Newton's method on the quadratic map, carried on until rounding stops it.

    C_u(y) du = -(C(y) - offset),      u <- u + du

LU with partial pivoting (see `linear`). A step ends the iteration when it is no larger than its own
rounding error, |C_u^-1| times the uncertainty of C(y): what is left is noise, not progress.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]

# From a start inside the Kantorovich region the error squares at every step: 2^-1 falls below 2^-53 in
# six steps. Twice that leaves room for starts outside the region that still converge.
LIMIT = 12


@dataclass(frozen=True)
class Converged:
    """What Newton's method reached, any leading batch dimensions.

    Attributes:
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y up to the last, noise-sized step.
        converged: whether the last step was noise, shape (...,).
        iterations: steps taken by each member, shape (...,).
        first_step: largest component of the first step, shape (...,).
        noise: largest component of the rounding error of the last step, shape (...,).
        work: what it cost.
    """

    y: Array
    factors: Factors
    converged: NDArray[np.bool_]
    iterations: NDArray[np.int64]
    first_step: Array
    noise: Array
    work: Work


def newton_refine(system: QuadraticMap, y: Array, offset: Array | float = 0.0) -> Converged:
    """Solve C(u, w) = offset for the unknowns of y, starting from them.

    Args:
        y: start, shape (..., size); the known coordinates stay as they are.
        offset: wanted residual, shape (..., rows).
    Returns:
        The solution; members that do not converge are marked, never raised, and keep their last y.
    """
    batch, n = y.shape[:-1], system.unknowns
    y = y.reshape(-1, y.shape[-1]).copy()
    offset = np.broadcast_to(offset, (*batch, len(system.rows))).reshape(-1, len(system.rows))
    members = len(y)
    converged = np.zeros(members, dtype=bool)
    iterations = np.zeros(members, dtype=np.int64)
    first_step = np.full(members, np.nan)
    last_noise = np.full(members, np.inf)
    previous = np.full(members, np.inf)
    exact_data = np.zeros(y.shape[-1])
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
            noise = (np.abs(local.preconditioner) @ system.uncertainty(here, exact_data)[..., None])[..., 0]
        size = np.abs(step).max(axis=-1)
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
        work=Work(residuals=evaluations, factorisations=evaluations),
    )
