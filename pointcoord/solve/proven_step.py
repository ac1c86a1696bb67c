r"""What is proven of one step of a path: that one branch leads along it, and which pose it leads to.

From a pose y with X near C_u(y)^-1 let T be the way of Newton's method to other known coordinates, and
C = c the constraints as far as they are closed: c goes from c_0 to c_1 along the step, in proportion. C is
quadratic, so

    C(y + s T) - c = (1 - s) (C(y) - c_0) + s (C(y) + 2 B(y, T) - c_1) + s^2 B(T, T)      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds at every s
from 0 to 1 if it does with

    eta = max(|X (C(y) - c_0)|, |X (C(y) + 2 B(y, T) - c_1)|) + |X B(T, T)|,
    z = |I - X C_u(y)| + |X C_u(T)|,      2 omega eta < (1 - z)^2,  that is  z + sqrt(2 omega eta) < 1.

Then one branch leads along the straight way, and no other assembly lies within (1 - z) / omega of y + T: a
pose that does is the next one. All is true in any weighted maximum norm. The pose y need not be exact: it
stands for the assembly that u <- u - X (C - c_0) leads to from it, and so does the end of the step before if
Newton's method is proven to converge from there, because both are about the same y.

A turn, which is driven by its cosine and its sine, and inputs that move together by different laws go beside
that way, by no more than d in each known coordinate. As

    C(y + s T + e) = C(y + s T) + 2 B(y + s T, e) + B(e, e),      |e| <= d,

the same holds all over the strip between both with

    eta + |X C_w(y)| d + |X C_w(T)| d + |X| |B|(d, d),    z + |X| |C_u|(d),

so that the path itself leads to that pose. Without this a turn goes by its chord, and where two branches
cross on the circle, as in a parallelogram that lies flat, the chord leads from one to the other beside it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.block_inverse import product_of_few_entries
from pointcoord.numerics.kantorovich import used
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]

# Shares of a step at which it is looked how far its path goes beside the straight way, and how many times as
# far it may go between these: a parabola 1.19 times, a cubic 1.15.
SHARES, INFLATED = np.array([0.3, 0.7]), 1.25
# Of 1, what z + sqrt(2 omega eta) may be: the rest is far more than anything rounds, and with less than that
# Newton's method would converge only linearly from the end of the tangent.
ROOM = 0.9
# Parts of the largest curvature that the weights of a coordinate have at least.
LEAST_WEIGHTS = (0.3, 0.02)


@dataclass(frozen=True)
class Proof:
    """What holds of straight ways in a maximum norm.

    Attributes:
        used: z + sqrt(2 omega eta), which goes with the length of a way, shape (...,).
        alone: no other assembly lies so near the end of the tangent, shape (...,).
        weights: of the norm, shape (..., n).
    """

    used: Array
    alone: Array
    weights: Array

    @property
    def holds(self) -> NDArray[np.bool_]:
        """Whether one branch leads along the way, shape (...,)."""
        return np.asarray(self.used <= ROOM)

    def taken(self, members: NDArray[np.intp]) -> Proof:
        """Some members, by number; one batch dimension."""
        return Proof(self.used[members], self.alone[members], self.weights[members])

    def within(self, apart: Array) -> NDArray[np.bool_]:
        """Whether places so far from the ends of the tangents, (..., n), are alone there, shape (...,)."""
        return np.asarray((apart / self.weights).max(axis=-1) <= self.alone)


@dataclass(frozen=True)
class StraightWay:
    """The straight ways from poses to other known coordinates; see the formulas above.

    Attributes:
        tangent: T, shape (..., size).
        bend, remaining: |X B(T, T)|, and all of eta, element by element, shape (..., n).
        change: z, element by element, shape (..., n, n).
    """

    tangent: Array
    bend: Array
    remaining: Array
    change: Array

    def norms(self, weights: Array) -> tuple[Array, Array]:
        """eta and z in maximum norms of some weights, shape (..., n): of shape (...,)."""
        turned = (self.change @ weights[..., None])[..., 0]
        return (self.remaining / weights).max(axis=-1), (turned / weights).max(axis=-1)

    def proof(self, omega: Array | float, weights: Array) -> Proof:
        """In the norm of some weights."""
        eta, z = self.norms(weights)
        return Proof(used(eta, z, omega), np.asarray((1.0 - z) / omega), weights)

    def best_proof(self, system: QuadraticMap, inverse: Array) -> Proof:
        """In the best of three norms: plain, and two that weigh each coordinate by how far its path bends.

        So what hardly moves hardly counts.
        """
        largest = self.bend.max(axis=-1, keepdims=True)
        weights = np.stack(
            [np.ones_like(self.bend), *(self.bend + least * largest for least in LEAST_WEIGHTS)]
        )
        every = self.proof(system.lipschitz(inverse, weights), weights)
        best = np.argmin(np.where(np.isnan(every.used), np.inf, every.used), axis=0)[None]
        most, alone = (np.take_along_axis(part, best, axis=0)[0] for part in (every.used, every.alone))
        return Proof(most, alone, np.take_along_axis(weights, best[..., None], axis=0)[0])


def straight_way(
    system: QuadraticMap,
    inverse: Array,
    y: Array,
    targets: Array,
    beside: Array | None = None,
    offsets: Array | tuple[float, float] = (0.0, 0.0),
) -> StraightWay:
    """What the theorem of Newton and Kantorovich asks of the ways; floating point warnings are the caller's.

    Args:
        inverse: X, of C_u near the poses, (n, n), or of each (..., n, n). y: the poses, shape (..., size).
        targets: known coordinates at the ends, shape (..., size - n).
        beside: d, how far the paths go beside the ways, shape (..., size - n); nowhere unless given.
        offsets: c at the start and at the end, shape (2, ..., rows); 0 unless given.
    """
    n = system.unknowns
    first, last = offsets
    tangent = np.zeros_like(y)
    tangent[..., n:] = targets - y[..., n:]
    here = system.residual(y)
    tangent[..., :n] = -_times(inverse, here - last + 2.0 * system.polar(y, tangent))
    start = np.abs(_times(inverse, here - first))
    end = np.abs(_times(inverse, here - last + 2.0 * system.polar(y, tangent)))
    bend = np.abs(_times(inverse, system.residual(tangent)))
    remaining = np.maximum(start, end) + bend
    change = np.abs(np.eye(n) - product_of_few_entries(inverse, system.jacobian(y)))
    change += np.abs(product_of_few_entries(inverse, system.jacobian(tangent)))
    if beside is not None and beside.any():
        d = np.zeros_like(y)
        d[..., n:] = beside
        moved = (n + np.flatnonzero(beside.reshape(-1, beside.shape[-1]).any(axis=0))).tolist()
        driven = np.abs(inverse @ system.derivative_by(np.stack([y, tangent]), tuple(moved))).sum(axis=0)
        remaining += (driven @ d[..., moved, None])[..., 0]
        if inverse.ndim == 2 and d.ndim == 2:
            # What is small of second order may as well be the largest of all.
            d = d[np.isfinite(beside).all(axis=-1)].max(axis=0, initial=0.0)
        remaining += _times(np.abs(inverse), system.uncertainty(np.zeros_like(d), d))
        change += np.abs(inverse) @ system.jacobian_uncertainty(d)
    return StraightWay(tangent, bend, remaining, change)


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
