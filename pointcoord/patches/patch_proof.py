r"""Proof that a truncated series and its derivatives are near an assembly everywhere on a patch.

For a series y(s) about an assembled pose, s in the box |s_i| <= 1, the residual C(y(s)) is a polynomial of
twice the order of the series. Its coefficients up to that order are rounding errors; those above are
truncation errors. With X close to C_u(y_0)^-1, the map T(u) = u - X C(u, w(s)) takes the ball of radius r
about u(s) into itself and is a contraction there, for every s at once, if

    eta + z r + omega r^2 / 2 <= r   and   z + omega r < 1,

    eta   >= sum_k |X C(y)_k|,
    z     >= |I - X C_u(y_0)| + sum_{k > 0} |X C_u(y_k)|,       C_u is linear in y,
    omega  = Lipschitz constant of X C_u,

as for a pose (see `numerics.kantorovich`), because a polynomial on the box is at most the sum of the
magnitudes of its coefficients (radii polynomials: Day, Lessard and Mischaikow, SIAM J. Numer. Anal. 45
(2007), 1398). Then there is exactly one assembly u*(s) in the ball at each s. It is analytic in s, because
C_u is regular there. The norm is max_i |u_i| / g_i with g near the Perron vector of the matrix Z of z, for
which z is smallest.

Differentiating C(y*(s)) = 0 gives, with e = u* - u, Q(a, b) = |2 X B(a, b)|, G the sum_k |X C_u(y_k)| of the
derivatives of C_u, and q the sums of eta for the residual and its derivatives:

    |e|    <= q    + Z |e|    + Q(e, e) / 2,
    |e_i|  <= q_i  + Z |e_i|  + G_i |e| + Q(e, e_i),
    |e_ij| <= q_ij + Z |e_ij| + G_i |e_j| + G_j |e_i| + G_ij |e| + Q(e, e_ij) + Q(e_i, e_j),

These bound the errors of the derivatives, coordinate by coordinate.

Floating point: the residual at the centre is computed in twice the working precision. Its other coefficients
have an error gamma_n of their sums (Higham, ch. 3). The known coordinates have the error bounds of their
drives. A factor covers the rounding of the last operations of the bound, as for a pose.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pointcoord.numerics.arrays import Array, Flags
from pointcoord.numerics.enclosed_rows import differences, residual
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION, ball, nearer_perron
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.multi_index import powers, products
from pointcoord.numerics.power_series import multiplied
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.patches.jet import Jet

# Power iterations towards the Perron vector. Any positive vector gives a proof, so they need not converge.
ITERATIONS = 40
# Smallest weight of a coordinate: a coordinate that hardly changes may still have an error.
LEAST = 1e-3
# Times that a bound is inserted into its own right side; each time reduces the excess by a factor of Z.
REFINEMENTS = 4
# Largest share of the truncation error in a residual that counts as mostly rounding.
MOSTLY = 0.5


@dataclass(frozen=True)
class PatchProof:
    """Proofs of P patches; lengths in the mechanism's units, derivatives by s.

    Attributes:
        proven: whether there is exactly one assembly near the series everywhere on the patch, (P,).
        error: error bounds of the unknown coordinates and of their derivatives, (P, unknowns).
        unique_within: distance from the series within which there is no other assembly, (P, unknowns).
        change: z by input: the change of the Jacobian by each input, (P, p).
        left_out: eta by input: the contribution of each input to the truncation error, (P, p).
        rounded: whether the residual is mostly rounding and error of the data, in every derivative, so that a
            smaller patch would not be much more exact, (P,).
    """

    proven: Flags
    error: Jet
    unique_within: Array
    change: Array
    left_out: Array
    rounded: Flags


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
        factors: factorisation of C_u at the centres.
        series: series of all coordinates, shape (P, powers, size).
        order: total degree of the series.
        low: rounding errors of the known coordinates at the centre, to be added to them, shape (P, size).
        data: error bounds of the series of the known coordinates after that correction, (P, size).
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
    """q: bounds of X C(y) and of its derivatives, with rounding and error of the data, (P, unknowns).

    Returns:
        The bounds, and their part from powers above the order, which is the truncation error.
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
    # Each coefficient is a sum of products of rounded differences, over the terms of its row. Products with
    # the constant coefficient have two terms, all others up to as many terms as there are powers.
    terms = max(len(row) for row in system.rows)
    few, many = ((count + terms + 6) * UNIT_ROUNDOFF for count in (2, own.count))
    first, later = (
        [Jet.constant(f[:, 0], inputs), Jet.of(f[:, 1:], own.exponents[1:])] for f in (left, right)
    )
    rounded = (first[0] * later[1] + first[1] * later[0]).scaled(few) + (first[1] * later[1]).scaled(many)
    # Errors of the known coordinates. The residual at the centre already has their rounding errors `low`.
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


def _mostly_rounded(remaining: Jet, cut: Jet, weights: Array) -> Flags:
    """Whether the truncation error is the smaller part of the residual, in every derivative, (P,)."""
    found = np.ones(len(weights), dtype=bool)
    for part, whole in zip(cut.parts, remaining.parts, strict=True):
        scale = weights.reshape(len(weights), *[1] * (part.ndim - 2), -1)
        few = (part / scale).max(axis=-1) <= MOSTLY * (whole / scale).max(axis=-1)
        found &= few.reshape(len(weights), -1).all(axis=-1)
    return found


def _of_factors(system: QuadraticMap, off: Jet) -> tuple[Jet, Jet]:
    """Error bounds of the two factors of each term, from those of the coordinates, (P, terms)."""
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
    """Weights for which the norm of a non-negative matrix is near its spectral radius, (P, n)."""
    usable, weights = np.where(np.isfinite(matrix), matrix, 0.0), np.ones(matrix.shape[:-1])
    for _ in range(ITERATIONS):
        weights, _ = nearer_perron(usable, weights)
    return np.asarray(np.maximum(weights, LEAST))


def _errors(
    remaining: Jet, change: Jet, weights: Array, omega: Array, radius: Array, contraction: Array
) -> Jet:
    """Error bounds of the coordinates and of their derivatives, (P, unknowns)."""
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
