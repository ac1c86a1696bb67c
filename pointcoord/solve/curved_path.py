r"""A path of the known coordinates that is not straight, proven step by step against the straight way.

From a pose y with X = C_u(y)^-1 let T be the tangent that X gives to other known coordinates. C is quadratic,
so

    C(y + s T) = C(y) + s 2 B(y, T) + s^2 B(T, T)      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds at every s
from 0 to 1 if it does with

    eta = |X C(y)| + |X 2 B(y, T)| + |X B(T, T)|,    z = |I - X C_u(y)| + |X C_u(T)|,
    2 omega eta < (1 - z)^2.

Then one branch leads along the straight way, and no other assembly lies within (1 - z) / omega of y + T: a
pose that does is the next one. A turn, which is driven by its cosine and its sine, and inputs that move
together by different laws go beside that way, by no more than d in each known coordinate. As

    C(y + s T + e) = C(y + s T) + 2 B(y + s T, e) + B(e, e),      |e| <= d,

the same holds all over the strip between both with

    eta + |X C_w(y)| d + |X C_w(T)| d + |X| |B|(d, d),    z + |X| |C_u|(d),

so that the path itself leads to that pose. Without this a turn goes by its chord, and where two branches
cross on the circle, as in a parallelogram that lies flat, the chord leads from one to the other beside it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.branch import hidden, orientation, same_side
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# Shares of a step at which it is looked how far its path goes beside the straight way, and how many times as
# far it may go between these: a parabola 1.19 times, a cubic 1.15.
SHARES, INFLATED = np.array([0.3, 0.7]), 1.25
# Turn in one step, rad, at most: of more than half a turn the ends do not tell the way round.
LONGEST = 1.0
# Of the path: a shorter step has met its end, as of a straight one (see `assembly`). Steps, at most.
SHORTEST, MOST = 1e-13, 50_000
# Part of a step that would just be proven, and how much shorter or longer the next one is at most.
SAFETY, CHANGE = 0.8, (0.1, 4.0)
# What |I - X C_u| may be: C_u then has an inverse on all of the way, far beyond any rounding of that bound.
FARTHEST = 0.9


@dataclass(frozen=True)
class StraightWay:
    """The straight ways from poses to other known coordinates; see the formulas above.

    Attributes:
        tangent: T, shape (..., size). eta, z: shape (...,).
    """

    tangent: Array
    eta: Array
    z: Array

    def holds(self, omega: Array | float) -> NDArray[np.bool_]:
        """Whether one branch leads along it, shape (...,)."""
        return np.asarray((self.z <= FARTHEST) & (2.0 * omega * self.eta < (1.0 - self.z) ** 2))


def straight_way(
    system: QuadraticMap, inverse: Array, y: Array, targets: Array, beside: Array | None = None
) -> StraightWay:
    """What the theorem of Newton and Kantorovich asks of the ways; floating point warnings are the caller's.

    Args:
        inverse: X, of C_u near the poses, (n, n), or of each (..., n, n). y: the poses, shape (..., size).
        targets: known coordinates at the ends, shape (..., size - n).
        beside: d, how far the paths go beside the ways, shape (..., size - n); nowhere unless given.
    """
    n = system.unknowns
    tangent = np.zeros_like(y)
    tangent[..., n:] = targets - y[..., n:]
    tangent[..., :n] = -_times(inverse, 2.0 * system.polar(y, tangent))
    parts = (system.residual(y), 2.0 * system.polar(y, tangent), system.residual(tangent))
    eta = np.sum([np.abs(_times(inverse, rows)).max(axis=-1) for rows in parts], axis=0)
    turned = np.abs(np.eye(n) - inverse @ system.jacobian(y))
    change = turned + np.abs(inverse @ system.jacobian(tangent))
    if beside is not None and beside.any():
        d = np.zeros_like(y)
        d[..., n:] = beside
        moved = (n + np.flatnonzero(beside.reshape(-1, beside.shape[-1]).any(axis=0))).tolist()
        driven = np.abs(inverse @ system.derivative_by(np.stack([y, tangent]), tuple(moved))).sum(axis=0)
        eta = eta + (driven @ d[..., moved, None])[..., 0].max(axis=-1)
        if inverse.ndim == 2 and d.ndim == 2:
            # What is small of second order may as well be the largest of all.
            d = d[np.isfinite(beside).all(axis=-1)].max(axis=0, initial=0.0)
        eta = eta + _times(np.abs(inverse), system.uncertainty(np.zeros_like(d), d)).max(axis=-1)
        change = change + np.abs(inverse) @ system.jacobian_uncertainty(d)
    return StraightWay(tangent, eta, np.asarray(change.sum(axis=-1).max(axis=-1)))


def _times(matrix: Array, rows: Array) -> Array:
    return rows @ matrix.T if matrix.ndim == 2 else np.asarray((matrix @ rows[..., None])[..., 0])


def beside_the_way(first: Array, between: Array, last: Array) -> Array:
    """How far paths of the known coordinates go beside their straight ways, shape (..., known coordinates).

    A coordinate that moves alone stays on its way but where it turns back: a parabola that is d from its
    chord in the middle, over a chord that rises by r, goes (4 d - r)^2 / (16 d) beyond an end if 4 d > r.

    Args:
        first, last: the ends, shape (..., known coordinates).
        between: at SHARES of the paths, shape (..., shares, known coordinates).
    """
    rise, shares = np.abs(last - first), SHARES[:, None]
    off = INFLATED * np.abs(between - first[..., None, :] - shares * (last - first)[..., None, :]).max(
        axis=-2
    )
    rounding = 8.0 * EPS * np.maximum(np.abs(first), np.abs(last))
    off = np.where(off > rounding, off, 0.0)
    alone = ((rise > rounding) | (off > 0.0)).sum(axis=-1, keepdims=True) == 1
    beyond = np.maximum(4.0 * off - rise, 0.0) ** 2 / (16.0 * np.where(off > 0.0, off, 1.0))
    return np.where(alone, beyond, off)


@dataclass(frozen=True)
class Path:
    """How far a batch of poses followed their paths: `done` is 1 where the end was reached.

    Attributes:
        iterations: Newton steps that the last correction took, shape (...,).
        left: proven distance to the exact assembly, rounding apart, where a tolerance ended the correction,
            shape (...,), where the end was reached.
    """

    y: Array
    factors: Factors
    iterations: NDArray[np.int64]
    left: Array
    done: Array
    work: Work

    def reshaped(self, batch: tuple[int, ...]) -> Path:
        """The same with other batch dimensions."""
        return Path(
            self.y.reshape(*batch, self.y.shape[-1]),
            self.factors.reshaped(batch),
            self.iterations.reshape(batch),
            self.left.reshape(batch),
            self.done.reshape(batch),
            self.work,
        )


def along(
    system: QuadraticMap,
    y: Array,
    law: Callable[[NDArray[np.intp], Array], Array],
    longest: float,
    tolerance: float,
) -> Path:
    """Carry assembled poses along paths of their known coordinates.

    Args:
        y: the poses, shape (members, size).
        law: known coordinates of members, by number, at shares of their paths, both (m,).
        longest: a share, so short that SHARES of it show the path.
        tolerance: how far the ends may be from the exact assembly, rounding apart, in units.
    Returns:
        Poses at the ends of their paths, or where these stop.
    """
    n, y = system.unknowns, y.copy()
    factors = factorise(system.jacobian(y))
    side = orientation(system, factors)
    done, step, left = np.zeros(len(y)), np.full(len(y), min(longest, 1.0)), np.zeros(len(y))
    iterations, work = np.zeros(len(y), dtype=np.int64), Work(factorisations=len(y))
    active = np.flatnonzero(~(factors.singular | hidden(system, y, factors)))
    for _ in range(MOST):
        if not active.size:
            break
        here, begun, local = y[active], done[active], factors.taken(active)
        end = np.minimum(begun + step[active], 1.0)
        # What would be left is no step of its own.
        end = np.where(1.0 - end < SHORTEST, 1.0, end)
        places = begun[:, None] + (end - begun)[:, None] * SHARES
        between = law(np.repeat(active, len(SHARES)), places.ravel()).reshape(*places.shape, -1)
        target = law(active, end)
        with np.errstate(all="ignore"):
            beside = beside_the_way(here[:, n:], between, target)
            way = straight_way(system, local.preconditioner, here, target, beside)
            omega = system.lipschitz(local.preconditioner)
            able = np.flatnonzero(way.holds(omega))
            # z goes with the length of a step, and eta with its square.
            longer = SAFETY / (way.z + np.sqrt(2.0 * omega * way.eta))
        work += Work(residuals=3 * len(active))
        longer = np.where(np.isfinite(longer), np.clip(longer, *CHANGE), CHANGE[0])
        step[active] = (end - begun) * np.minimum(longer, SAFETY)
        if able.size:
            with np.errstate(all="ignore"):
                guess = (here + way.tangent)[able]
                guess[:, n:] = target[able]
                reached = newton_refine(system, guess, 0.0, tolerance)
                off = np.abs(reached.y - guess).max(axis=-1) + reached.left
                there = factorise(system.jacobian(reached.y))
                good = reached.converged & (off * omega[able] <= 1.0 - way.z[able])
                good &= same_side(system, reached.y, there, side[active[able]], end[able] == 1.0)
            work += reached.work + Work(factorisations=len(able))
            kept, chosen = active[able[good]], np.flatnonzero(good)
            y[kept], done[kept] = reached.y[chosen], end[able[chosen]]
            left[kept], iterations[kept] = reached.left[chosen], reached.iterations[chosen]
            factors = factors.replaced(kept, there.taken(chosen))
            step[kept] = np.minimum((end - begun)[able[chosen]] * longer[able[chosen]], longest)
        active = active[(done[active] < 1.0) & (step[active] >= SHORTEST)]
    return Path(y, factors, iterations, left, done, work)
