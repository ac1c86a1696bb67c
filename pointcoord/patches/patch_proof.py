r"""A proof that a truncated series is near an assembly everywhere on its patch, with its derivatives.

For a series y(s) about an assembled pose, s in the box |s_i| <= 1, the residual C(y(s)) is a polynomial of
twice its order. Up to the order its coefficients are rounding; beyond it they are what the series leaves out.
With X close to C_u(y_0)^-1, the map T(u) = u - X C(u, w(s)) takes the ball of radius r about u(s) into itself
and contracts there, for every s at once, if

    eta + z r + omega r^2 / 2 <= r   and   z + omega r < 1,

    eta   >= sum_k |X C(y)_k|,
    z     >= |I - X C_u(y_0)| + sum_{k > 0} |X C_u(y_k)|,       C_u is linear in y,
    omega  = Lipschitz constant of X C_u,

as for a pose (see `numerics.kantorovich`), because a polynomial is at most the sum of the magnitudes of its
coefficients on the box (radii polynomials: Day, Lessard and Mischaikow, SIAM J. Numer. Anal. 45 (2007),
1398). Then there is exactly one assembly u*(s) in the ball at each s; it is analytic in s, as C_u is
regular there. The norm is max_i |u_i| / g_i with g near the Perron vector of z's matrix Z, where z is
least.

Differentiating C(y*(s)) = 0, with e = u* - u, Q(a, b) = |2 X B(a, b)|, G = sum_k |X C_u(y_k)| of the
derivatives and q the same sums as eta of the residual and of its derivatives:

    |e|    <= q    + Z |e|    + Q(e, e) / 2,
    |e_i|  <= q_i  + Z |e_i|  + G_i |e| + Q(e, e_i),
    |e_ij| <= q_ij + Z |e_ij| + G_i |e_j| + G_j |e_i| + G_ij |e| + Q(e, e_ij) + Q(e_i, e_j),

which bounds the errors of the derivatives, coordinate by coordinate.

Floating point: the residual of the centre is taken in twice the working precision, its other coefficients
carry gamma_n of their sums (Higham, ch. 3), and the known coordinates what their drives say of their series.
The rounding of the bound's own last operations is made up for by a factor, as for a pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.enclosed_rows import differences, residual
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION, ball, nearer_perron
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.multi_index import powers, products
from pointcoord.numerics.power_series import multiplied
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.patches.jet import Jet

Array = NDArray[np.float64]

# Power iterations towards the Perron vector: any positive vector proves, so these need not converge.
ITERATIONS = 40
# Least weight of a coordinate: what hardly changes still may be off.
LEAST = 1e-3
# Times that a bound is put into its own right side, each of which takes a factor of Z off what is too much.
REFINEMENTS = 4
# Of what is left over, what cutting the series may make where it is mostly rounding.
MOSTLY = 0.5


@dataclass(frozen=True)
class PatchProof:
    """What is proven of each of P patches; lengths in the mechanism's units, derivatives by s.

    Attributes:
        proven: whether there is exactly one assembly near the series everywhere on the patch, (P,).
        error: how far the unknown coordinates and their derivatives are off, at most, (P, unknowns).
        unique_within: no other assembly lies within this of the series, (P, unknowns).
        change: z by input: how much each input changes the Jacobian, (P, p).
        left_out: eta by input: how much each takes part in what the series leaves out, (P, p).
        rounded: whether that is mostly rounding and doubt of the data, in every derivative, so that no
            smaller patch is much nearer, (P,).
    """

    proven: NDArray[np.bool_]
    error: Jet
    unique_within: Array
    change: Array
    left_out: Array
    rounded: NDArray[np.bool_]


def prove_patches(
    system: QuadraticMap,
    factors: Factors,
    series: Array,
    order: int,
    low: Array,
    data: Jet,
) -> PatchProof:
    """Prove patches.

    Args:
        factors: of C_u at the centres.
        series: of all coordinates, shape (P, powers, size).
        low: what the known coordinates of the centre lack, shape (P, size).
        data: how far the known coordinates' series are off beside that, (P, size).
    """
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        remaining, cut = _remaining(system, factors, series, order, low, data)
        change = _change(system, factors, series, order, low, data)
        weights = _perron(change.value)
        z = (np.matvec(change.value, weights) / weights).max(axis=-1)
        eta = (remaining.value / weights).max(axis=-1)
        omega = system.lipschitz(factors.preconditioner, weights)
        found = ball(eta, z, omega)
        proven = found.proven & (found.contraction < 1.0)
        error = _errors(remaining, change, weights, omega, found.radius, found.contraction)
        spread = ((change.first @ weights[:, None, :, None])[..., 0] / weights[:, None]).max(axis=-1)
        left_out = (remaining.first / weights[:, None]).max(axis=-1)
        rounded = _mostly_rounded(remaining, cut, weights)
    return PatchProof(
        proven=proven,
        error=error.scaled(INFLATION).where(proven),
        unique_within=np.where(proven[:, None], weights * found.outer[:, None], 0.0),
        change=spread,
        left_out=left_out,
        rounded=rounded,
    )


def _remaining(
    system: QuadraticMap, factors: Factors, series: Array, order: int, low: Array, data: Jet
) -> tuple[Jet, Jet]:
    """q: bounds of X C(y) and of its derivatives, rounding and doubt of the data included, (P, unknowns).

    Returns:
        All of them, and what of them is by powers above the order, which a series leaves out.
    """
    inputs = data.first.shape[1]
    inverse = factors.preconditioner
    magnitude = np.swapaxes(np.abs(inverse), -1, -2)
    left, right = system.factors(series)
    pairs = products(inputs, order, (2, 2 * order), 1)
    own = powers(inputs, order)
    rest = np.zeros((len(series), powers(inputs, 2 * order).count, left.shape[-1]))
    by_power = multiplied(np.moveaxis(left, 1, 0), np.moveaxis(right, 1, 0), pairs)
    rest[:, pairs.targets] = np.moveaxis(by_power, 0, 1)
    rest[:, 1 : own.count] += left[:, :1] * right[:, 1:] + left[:, 1:] * right[:, :1]
    rows = system.gather(rest)
    centre = residual(system, differences(system, Enclosed.of(series[:, 0], low)))
    rows[:, 0] = centre.middle
    exponents = powers(inputs, 2 * order).exponents
    stepped = rows @ np.swapaxes(inverse, -1, -2)
    kept, cut = (
        Jet.of(stepped[:, part], exponents[part]) for part in (slice(own.count), slice(own.count, None))
    )
    # Each coefficient is a sum of products of rounded differences: two terms and what its row sums at order
    # zero, and as many terms as there are powers elsewhere.
    terms = max(len(row) for row in system.rows)
    few, many = ((count + terms + 6) * UNIT_ROUNDOFF for count in (2, own.count))
    first, later = (
        [Jet.constant(f[:, 0], inputs), Jet.of(f[:, 1:], own.exponents[1:])] for f in (left, right)
    )
    rounded = (first[0] * later[1] + first[1] * later[0]).scaled(few) + (first[1] * later[1]).scaled(many)
    # What the known coordinates are off: the centre's residual has seen what they lack.
    off = _of_factors(system, data + Jet.constant(low, inputs))
    moved = off[0] * later[1] + first[1] * off[1] + off[0] * off[1]
    doubted = _of_factors(system, data)
    moved += doubted[0] * later[0] + first[0] * doubted[1]
    spread = (rounded + moved).each(system.gather_sizes)
    spread += Jet.of(rows, exponents).scaled((system.unknowns + 2) * EPS)
    spread += Jet.constant(centre.radius[0] + UNIT_ROUNDOFF * np.abs(rows[:, 0]), inputs)
    spread = Jet(
        (spread.value[:, None] @ magnitude)[:, 0],
        spread.first @ magnitude,
        spread.second @ magnitude[:, None],
    )
    return kept + cut + spread, cut


def _mostly_rounded(remaining: Jet, cut: Jet, weights: Array) -> NDArray[np.bool_]:
    """Whether what cutting the series leaves is the smaller part of all that remains, (P,)."""
    found = np.ones(len(weights), dtype=bool)
    for part, whole in zip(cut.parts, remaining.parts, strict=True):
        beside = weights.reshape(len(weights), *[1] * (part.ndim - 2), -1)
        few = (part / beside).max(axis=-1) <= MOSTLY * (whole / beside).max(axis=-1)
        found &= few.reshape(len(weights), -1).all(axis=-1)
    return found


def _of_factors(system: QuadraticMap, off: Jet) -> tuple[Jet, Jet]:
    """How far the two factors of each term are off where the coordinates are, (P, terms)."""
    (first, second), (left, right) = system.differences
    each = off.taken(first) + off.taken(second)
    return each.taken(left), each.taken(right)


def _change(system: QuadraticMap, factors: Factors, series: Array, order: int, low: Array, data: Jet) -> Jet:
    """Z and G: bounds of I - X C_u(y(s)) and of its derivatives, shape (P, unknowns, unknowns)."""
    inputs, n = data.first.shape[1], system.unknowns
    inverse = factors.preconditioner
    matrices = system.jacobian(series)
    moved = inverse[:, None] @ matrices
    moved[:, 0] -= np.eye(n)
    exponents = powers(inputs, order).exponents
    known = data + Jet.constant(low, inputs)
    doubt = Jet.of(matrices, exponents).scaled((n + 2) * EPS)
    doubt += known.each(system.jacobian_uncertainty)
    magnitude = np.abs(inverse)
    return Jet.of(moved, exponents) + Jet(
        magnitude @ doubt.value, magnitude[:, None] @ doubt.first, magnitude[:, None, None] @ doubt.second
    )


def _perron(matrix: Array) -> Array:
    """Weights for which the norm of a matrix of no negative elements is near its spectral radius, (P, n)."""
    usable, weights = np.where(np.isfinite(matrix), matrix, 0.0), np.ones(matrix.shape[:-1])
    for _ in range(ITERATIONS):
        weights, _ = nearer_perron(usable, weights)
    return np.asarray(np.maximum(weights, LEAST))


def _errors(
    remaining: Jet, change: Jet, weights: Array, omega: Array, radius: Array, contraction: Array
) -> Jet:
    """Errors of the coordinates and of their derivatives, (P, unknowns)."""
    z, g = change.value, weights

    def norm(vector: Array) -> Array:
        return np.asarray((vector / g).max(axis=-1))

    def solved(right: Array) -> Array:
        """The least v with v <= right + Z v + Q(e, v)."""
        size = norm(right) / (1.0 - contraction)
        found = size[:, None] * g
        for _ in range(REFINEMENTS):
            found = np.minimum(found, right + np.matvec(z, found) + (omega * radius * size)[:, None] * g)
        return found

    value = radius[:, None] * g
    for _ in range(REFINEMENTS):
        rest = remaining.value + np.matvec(z, value) + (0.5 * omega * radius**2)[:, None] * g
        value = np.minimum(value, rest)
    first = np.empty_like(remaining.first)
    inputs = first.shape[1]
    for i in range(inputs):
        first[:, i] = solved(remaining.first[:, i] + np.matvec(change.first[:, i], value))
    second = np.empty_like(remaining.second)
    for i in range(inputs):
        for j in range(i, inputs):
            crossed = omega * norm(first[:, i]) * norm(first[:, j])
            right = remaining.second[:, i, j] + crossed[:, None] * g
            right += np.matvec(change.second[:, i, j], value)
            right += np.matvec(change.first[:, i], first[:, j]) + np.matvec(change.first[:, j], first[:, i])
            second[:, i, j] = second[:, j, i] = solved(right)
    return Jet(value, first, second)
