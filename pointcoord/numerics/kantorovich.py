r"""Proof that an assembly lies near a computed pose, with an error bound (Newton-Kantorovich theorem).

Because C is quadratic, C_u changes linearly and its Lipschitz constant is known exactly, so the conditions of
the Newton-Kantorovich theorem can be checked in numbers. With X close to C_u(y)^-1, the map T(x) = x - X C(x)
takes the ball of radius r about u into itself and contracts there if

    eta + z r + omega r^2 / 2 <= r   and   z + omega r < 1,

    eta   >= |X C(y)|               the remaining step,
    z     >= |I - X C_u(y)|         the defect of the inverse,
    omega  = Lipschitz constant of X C_u,

in the maximum norm over the unknowns. Then exactly one assembly lies in the ball. The smallest such r,

    r = 2 eta / ((1 - z)(1 + sqrt(1 - h))),      h = 2 omega eta / (1 - z)^2 < 1,

is the error bound, and no other assembly lies within the other root, 2 (1 - z) / omega - r. The condition can
be met where z + sqrt(2 omega eta) < 1.

Every coordinate has its own bound. With e = X C(y) and the mean value form of C,

    u* = u - e + (I - X C_u)(u* - u) - X (C(u*) - C(u) - C_u (u* - u)),
    |u*_i - u_i| <= |e_i| + tail,      tail = z r + omega r^2 / 2,

and a linear combination J u of coordinates, such as a point fixed to a body, has an error of at most
|J e| + |J| tail: errors cancel in it as they do in J e.

One inverse may serve many poses that lie close together: C_u is linear in y, so with D at least the largest
difference of each coordinate among them,

    |I - X C_u| <= |I - X C_u(a)| + |X| |C_u|(D)

holds at each pose, where a is the pose of the inverse X. The residual C(y) is computed at each pose, so the
common inverse enlarges the bounds by no more than z times their steps.

Floating point: C(y) is evaluated in twice the working precision (see `enclosure`), at the exact known
coordinates that the user's numbers stand for (`Mechanism.known_data`). The remaining uncertainty d of C(y)
adds |X| d to e; products with X add gamma_n of Higham's book, in z as well. Two things are not covered. The
last operations of the bound itself are in ordinary rounding, not in interval arithmetic; a factor of 1 + 1e-6
makes up for this. And an input's value is rounded once: the bound holds for the double nearest to the law's
exact value. Larger errors of evaluating the law are counted (see `time_functions`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array, Flags
from pointcoord.numerics.enclosed_rows import differences, residual
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import components_last

INFLATION = 1.0 + 1e-6  # covers rounding in the bound itself, see above
SMALLEST = 1e-300  # replaces a zero norm, so that weights stay as they are


@dataclass(frozen=True)
class Ball:
    """Results of the test with eta, z and omega, each of their shape.

    Attributes:
        proven: whether exactly one assembly lies in the ball; radius: radius of the ball, where proven.
        outer: no other assembly lies within this distance.
        contraction: z + omega radius.
        tail: z radius + omega radius^2 / 2.
    """

    proven: Flags
    radius: Array
    outer: Array
    contraction: Array
    tail: Array


def smallest_radius(eta: Array, z: Array, omega: Array) -> Array:
    """The smallest r that satisfies the test, infinite where none does; all of one shape."""
    room = 1.0 - z
    constant = 2.0 * omega * eta / room**2
    least = 2.0 * eta / (room * (1.0 + np.sqrt(np.maximum(1.0 - constant, 0.0))))
    return np.where((room > 0.0) & (constant < 1.0) & np.isfinite(least), least, np.inf)


def nearer_perron(matrix: Array, weights: Array) -> tuple[Array, Array]:
    """Weights with a smaller norm of nonnegative matrices, (..., n, n), and the norm for the given weights.

    |Z| = max_i (Z w)_i / w_i for any w > 0. It is least for the Perron vector, which Z w + w approaches, also
    where several eigenvalues have equal size. The largest weight is 1.
    """
    turned = np.matvec(matrix, weights)
    norm = (turned / weights).max(axis=-1)
    weights = weights + turned / np.maximum(norm, SMALLEST)[..., None]
    return weights / weights.max(axis=-1, keepdims=True), norm


def ball(eta: Array, z: Array, omega: Array) -> Ball:
    """The smallest ball about u that satisfies the test; the caller handles floating point warnings."""
    least = smallest_radius(eta, z, omega)
    radius, proven = INFLATION * least, np.isfinite(least)
    outer = (2.0 * (1.0 - z) / omega - least) / INFLATION
    contraction = INFLATION * (z + omega * radius)
    tail = INFLATION * (z * radius + 0.5 * omega * radius**2)
    return Ball(
        proven=proven,
        radius=radius,
        outer=np.where(proven, outer, 0.0),
        contraction=np.where(proven, contraction, np.inf),
        tail=np.where(proven, tail, np.inf),
    )


@dataclass(frozen=True)
class Certificate:
    """Error bounds of poses in groups of m that share an inverse; lengths in the units of y.

    Attributes:
        radius: exactly one assembly lies within it, (..., m); infinite where nothing could be proven.
        contraction: z + omega radius >= |I - X C_u| everywhere within the radius, (..., m); infinite
            where nothing could be proven.
        defect: |I - X C_u(y)| element by element at any pose of the group, (..., unknowns, unknowns).
        residual: C(y) at the exact known coordinates, (..., m, rows).
        step: e, (..., m, unknowns).
        spread: uncertainty of each component of e, |X| d, (..., 1, unknowns).
        tail: remaining bound of every coordinate, (..., m); infinite where nothing could be proven.
    """

    radius: Array
    contraction: Array
    defect: Array
    residual: Array
    step: Array
    spread: Array
    tail: Array

    @property
    def coordinates(self) -> Array:
        """Error bound of each unknown coordinate, (..., m, unknowns)."""
        return np.asarray(INFLATION * (np.abs(self.step) + self.spread + self.tail[..., None]))


def certify(system: QuadraticMap, pose: Enclosed, factors: Factors) -> Certificate:
    """Bound the distance from poses to the assemblies near them.

    Args:
        pose: computed coordinates, (..., m, size): groups of m poses that lie close together, with the
            rounding errors and uncertainties of their known ones.
        factors: factorisation of C_u at or very near the anchor of each group.
    """
    n, inverse = system.unknowns, factors.preconditioner
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        rows = residual(system, differences(system, pose))
        middle = rows.middle
        uncertainty = rows.radius[0] + (n + 3) * EPS * np.abs(middle).max(axis=-2, keepdims=True)
        step, spread = applied(inverse, middle), applied(np.abs(inverse), uncertainty)
        eta = (np.abs(step) + spread).max(axis=-1)
        defect = defect_of(system, pose, inverse)
        z = defect.sum(axis=-1).max(axis=-1)
        found = ball(eta, z[..., None], system.lipschitz(inverse)[..., None])
    return Certificate(
        radius=found.radius,
        contraction=found.contraction,
        defect=defect,
        residual=middle,
        step=step,
        spread=spread,
        tail=found.tail,
    )


def defect_of(system: QuadraticMap, pose: Enclosed, inverse: Array) -> Array:
    """Upper bound of |I - X C_u| at every pose of a group, element by element, (..., unknowns, unknowns).

    Args:
        pose: (..., m, size).
        inverse: X, the inverse at the anchor.
    """
    n, anchor = system.unknowns, pose.high[..., 0, :]
    data = pose.radius[0] + np.abs(pose.low)
    matrix = system.jacobian(anchor)
    spread = (n + 2) * EPS * np.abs(matrix) + system.jacobian_uncertainty((data + pose.reach)[..., 0, :])
    return np.asarray(np.abs(np.eye(n) - inverse @ matrix) + np.abs(inverse) @ spread)


def applied(matrix: Array, vectors: Array) -> Array:
    """The product of each matrix, (..., n, n), with m vectors, (..., m, n)."""
    # Stored coordinate by coordinate, so that the poses are contiguous in memory.
    product = np.empty((matrix.shape[-2], *vectors.shape[:-1]))
    by_vector = components_last(product)
    np.matmul(matrix, vectors.swapaxes(-1, -2), out=by_vector.swapaxes(-1, -2))
    return by_vector
