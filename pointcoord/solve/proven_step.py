r"""What is proven of a step along a power series: that one branch leads along it, and which pose it leads to.

Let y(s) = sum_k y_k s^k be a series of all coordinates, from any pose y_0, and c(s) what C(y(s)) should be.
C is quadratic and C_u linear in y, so that with X near C_u(y_0)^-1

    X (C(y(s)) - c(s)) = sum_{k <= 2p} X R_k s^k,      R_k = sum_{i + j = k} B(y_i, y_j) - c_k,
    I - X C_u(y(s)) = I - X C_u(y_0) - sum_{0 < k <= p} X C_u(y_k) s^k      exactly,

and with omega = Lipschitz(X C_u) the theorem of Newton and Kantorovich (see `kantorovich`) holds at every s
from 0 to h if it does with

    eta = max sum_k |X R_k| h^k,    z = |I - X C_u(y_0)| + |sum_{k > 0} |X C_u(y_k)| h^k|,
    2 omega eta < (1 - z)^2,  that is  z + sqrt(2 omega eta) < 1.

Then one branch leads along the series, and no other assembly lies within (1 - z) / omega of its end: a pose
that does is the next one. All is true in any weighted maximum norm. The pose y_0 need not be exact: it stands
for the assembly that u <- u - X (C - c_0) leads to from it, and so does the end of the step before if
Newton's method is proven to converge from there, because both are about the same y_0.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.few_entries import product_of_few_entries
from pointcoord.numerics.kantorovich import nearer_perron
from pointcoord.numerics.multi_index import products
from pointcoord.numerics.power_series import multiplied, powers_first
from pointcoord.numerics.quadratic import QuadraticMap

Array = NDArray[np.float64]

# Of 1, what z + sqrt(2 omega eta) may be: the rest is far more than anything rounds, and with less than that
# Newton's method would converge only linearly from the end of the step.
ROOM = 0.9
# Times that weights are brought nearer to those of the smallest norm.
WEIGHINGS, NOTHING = 4, 1e-150


@dataclass(frozen=True)
class Proof:
    """What holds of steps in a maximum norm.

    Attributes:
        length: up to where, of the lengths that were asked about, one branch leads along the series, (...,);
            0 if nowhere.
        alone: no other assembly lies so near its place there, (...,).
        weights: of the norm, (..., n).
    """

    length: Array
    alone: Array
    weights: Array

    def taken(self, members: NDArray[np.intp]) -> Proof:
        """Some members, by number."""
        return Proof(self.length[members], self.alone[members], self.weights[members])

    def within(self, apart: Array) -> NDArray[np.bool_]:
        """Whether places so far from the ends of the steps, (..., n), are alone there, shape (...,)."""
        return np.asarray((apart / self.weights).max(axis=-1) <= self.alone)


def prove(
    system: QuadraticMap, inverse: Array, series: Array, wanted: Array | float, lengths: Array
) -> Proof:
    """How far series are proven; floating point warnings are the caller's.

    Args:
        inverse: X, (n, n), or of each member (m, n, n).
        series: of each member, (m, order + 1, size).
        wanted: the first two coefficients of c, (2, m, rows), the others being 0.
        lengths: h that are tried, the longest first, (l,).
    """
    order, n = series.shape[-2] - 1, system.unknowns
    left, right = (powers_first(each) for each in system.factors(series))
    rest = system.gather(multiplied(left, right, products(1, order, (0, 2 * order), 0)))
    rest[:2] -= wanted
    remaining = np.abs(np.matvec(inverse, rest))
    change = product_of_few_entries(inverse, system.jacobian(powers_first(series)))
    change[0] -= np.eye(n)
    np.abs(change, out=change)

    def proven(weights: Array, some: Array) -> tuple[NDArray[np.intp], Array]:
        """Numbers of the lengths that are proven in a norm, (m,), and how far their ends are alone."""
        powers = _powers(tuple(some.tolist()), 2 * order)
        turned = np.matvec(change, weights) / weights
        z = _summed(powers[:, : order + 1], turned)
        eta = _summed(powers, remaining / weights)
        omega = system.lipschitz(inverse, weights)
        holds = z + np.sqrt(2.0 * omega * eta) <= ROOM
        number = np.where(holds.any(axis=0), holds.argmax(axis=0), len(some))
        return number, (1.0 - z[np.minimum(number, len(some) - 1), np.arange(len(number))]) / omega

    weights = np.ones((len(series), n))
    number, alone = proven(weights, lengths[:1])
    if number.any():
        # Nearer to the weights for which the norm of what changes most is smallest.
        for _ in range(WEIGHINGS):
            weights, _ = nearer_perron(change[1], weights)
        weights = np.where((number[:, None] > 0) & np.isfinite(weights), weights, 1.0)
        number, alone = proven(weights, lengths)
    return Proof(np.append(lengths, 0.0)[number], alone, weights)


def _summed(powers: Array, terms: Array) -> Array:
    """The largest component of sums of vectors by powers of lengths, (l, k) and (k, m, n) to (l, m)."""
    sums = (powers @ terms.reshape(len(terms), -1)).reshape(len(powers), *terms.shape[1:])
    return np.asarray(sums.max(axis=-1))


@lru_cache(maxsize=16)
def _powers(lengths: tuple[float, ...], most: int) -> Array:
    """Powers of lengths up to one, (l, most + 1)."""
    powers = np.array(lengths)[:, None] ** np.arange(most + 1.0)
    # Products below the normal numbers take a hundred times as long.
    powers[powers < NOTHING] = 0.0
    return np.asarray(powers)
