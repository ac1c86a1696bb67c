r"""A proof that an assembly lies near a computed pose, and how near.

Because C is quadratic, C_u changes linearly and its Lipschitz constant is known exactly, so Newton and
Kantorovich's theorem can be checked with numbers. With X close to C_u(y)^-1, the map T(x) = x - X C(x)
takes the ball of radius r about u into itself and contracts there if

    eta + z r + omega r^2 / 2 <= r   and   z + omega r < 1,

    eta   >= |X C(y)|               the remaining step,
    z     >= |I - X C_u(y)|         the defect of the inverse,
    omega  = Lipschitz constant of X C_u,

in the maximum norm over the unknowns. Then exactly one assembly lies in the ball; the smallest such r

    r = 2 eta / ((1 - z)(1 + sqrt(1 - h))),      h = 2 omega eta / (1 - z)^2 < 1,

is the error bound, and no other assembly lies within the other root, 2 (1 - z) / omega - r. So it holds where
z + sqrt(2 omega eta) < 1.

Every coordinate has its own bound. With e = X C(y) and the mean value form of C,

    u* = u - e + (I - X C_u)(u* - u) - X (C(u*) - C(u) - C_u (u* - u)),
    |u*_i - u_i| <= |e_i| + tail,      tail = z r + omega r^2 / 2,

and a combination J u of coordinates, such as a point that rides on others, is off by at most
|J e| + |J| tail: its errors cancel as e's do.

One inverse may serve many poses that lie close together: C_u is linear in y, so with D at least what
each coordinate differs by among them,

    |I - X C_u| <= |I - X C_u(a)| + |X| |C_u|(D)

holds at each of them, a the one whose inverse X is. What is left of C(y) is seen at each by itself, so their
bounds lose no more than z of their steps.

Floating point: C(y) is taken in twice the working precision (see `enclosure`), about the known
coordinates that the user's numbers mean (`Mechanism.known_data`). What is left of uncertainty in C(y), d,
adds |X| d to e; products with X add gamma_n of Higham's book, in z as well. Not covered: the rounding of the
bound's own last operations, made up for by a factor of 1 + 1e-6; it is evaluated in ordinary rounding,
not in interval arithmetic. Nor is one rounding of an input's value: the bound holds for the double nearest
to what the law gives; what its computation is off from that is counted (see `time_functions`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.enclosed_rows import differences, residual
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.numerics.vectors import components_last

Array = NDArray[np.float64]

INFLATION = 1.0 + 1e-6  # see above
SMALLEST = 1e-300  # in place of a norm of 0, which leaves weights as they are


@dataclass(frozen=True)
class Ball:
    """What eta, z and omega prove, each of their shape.

    Attributes:
        proven: whether exactly one assembly lies in the ball; radius: its own, where it is.
        outer: no other assembly lies within this distance.
        contraction: z + omega radius.
        tail: z radius + omega radius^2 / 2.
    """

    proven: NDArray[np.bool_]
    radius: Array
    outer: Array
    contraction: Array
    tail: Array


def smallest_radius(eta: Array, z: Array, omega: Array) -> Array:
    """The smallest r that the test holds for, infinite where it holds for none, all of one shape."""
    room = 1.0 - z
    constant = 2.0 * omega * eta / room**2
    least = 2.0 * eta / (room * (1.0 + np.sqrt(np.maximum(1.0 - constant, 0.0))))
    return np.where((room > 0.0) & (constant < 1.0) & np.isfinite(least), least, np.inf)


def nearer_perron(matrix: Array, weights: Array) -> tuple[Array, Array]:
    """Weights for which the norm of matrices of no negative elements, (..., n, n), is smaller; and its norm.

    |Z| = max_i (Z w)_i / w_i for any w > 0; it is least for Perron's vector, which Z w + w comes nearer to,
    also where several eigenvalues are of one size. The largest weight is 1.
    """
    turned = np.matvec(matrix, weights)
    norm = (turned / weights).max(axis=-1)
    weights = weights + turned / np.maximum(norm, SMALLEST)[..., None]
    return weights / weights.max(axis=-1, keepdims=True), norm


def ball(eta: Array, z: Array, omega: Array) -> Ball:
    """The smallest ball about u that the test holds for; floating point warnings are the caller's."""
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
    """Error bound of each pose of groups of m that share an inverse; lengths in the units of y.

    Attributes:
        radius: exactly one assembly lies within it, (..., m); infinite where nothing could be proven.
        contraction: z + omega radius >= |I - X C_u| everywhere within the radius, (..., m); infinite
            where nothing could be proven.
        defect: |I - X C_u(y)| element by element at any pose of the group, (..., unknowns, unknowns).
        residual: C(y) about what the known coordinates mean, (..., m, rows).
        step: e, (..., m, unknowns).
        spread: uncertainty of each component of e, |X| d, (..., 1, unknowns).
        tail: what is left, for every coordinate, (..., m); infinite where nothing could be proven.
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
        pose: computed coordinates, (..., m, size): groups of m poses that lie close together, with what their
            known ones lack and are uncertain by.
        factors: factorisation of C_u at or very near the anchor of each group.
    """
    n, inverse = system.unknowns, factors.preconditioner
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        rows = residual(system, differences(system, pose))
        middle = rows.middle
        doubt = rows.radius[0] + (n + 3) * EPS * np.abs(middle).max(axis=-2, keepdims=True)
        step, spread = applied(inverse, middle), applied(np.abs(inverse), doubt)
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
    """At least |I - X C_u| at every pose of a group, element by element, (..., unknowns, unknowns).

    Args:
        pose: (..., m, size).
        inverse: X of the anchor.
    """
    n, anchor = system.unknowns, pose.high[..., 0, :]
    data = pose.radius[0] + np.abs(pose.low)
    matrix = system.jacobian(anchor)
    doubted = (n + 2) * EPS * np.abs(matrix) + system.jacobian_uncertainty((data + pose.reach)[..., 0, :])
    return np.asarray(np.abs(np.eye(n) - inverse @ matrix) + np.abs(inverse) @ doubted)


def applied(matrix: Array, vectors: Array) -> Array:
    """The product of each matrix, (..., n, n), with m vectors, (..., m, n)."""
    # Coordinate by coordinate, so that the poses lie side by side in memory.
    product = np.empty((matrix.shape[-2], *vectors.shape[:-1]))
    by_vector = components_last(product)
    np.matmul(matrix, vectors.swapaxes(-1, -2), out=by_vector.swapaxes(-1, -2))
    return by_vector
