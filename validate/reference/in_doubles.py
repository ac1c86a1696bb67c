"""The equations at many instants at once, in doubles: known poses, their rates, and small changes.

Numbers are arrays over the instants, (N,), or duals of such arrays with slopes (directions, N). y', y'' and
the effect on them of a residual of the equations all follow from linear equations with the matrix C'.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb

import numpy as np

from validate.arrays import Array
from validate.reference.design import Design, Known, equations_in
from validate.reference.jet import Jet, value_of
from validate.reference.kinematics import Solved
from validate.reference.vectors import Scalar, Vector


def known_in_doubles(design: Design, laws: Mapping[str, Array], count: int) -> Known:
    """The known data of the equations, as jets of arrays (N,).

    Args:
        laws: value and time derivatives of each input, (N, orders), rad or mm; missing inputs are zero.
        count: N.
    """
    still = np.zeros((count, max((law.shape[-1] for law in laws.values()), default=3)))
    driven = {name: Jet(*np.array(laws.get(name, still), dtype=float).T) for name in design.plain["inputs"]}
    return Known.of(equations_in(design.mechanism, float), driven)


def local_places(design: Design, places: Mapping[str, Array], known: Known) -> dict[str, Vector]:
    """Points, (N, 3), mm, in the design's coordinates relative to the chassis."""
    origin, unit = np.array([float(x) for x in design.origin]), float(design.unit)
    local = {}
    for name in design.table:
        x, y, z = ((places[name] - origin) / unit).T
        local[name] = known.chassis.taken_back((x, y, z))
    return local


def jacobian_of(values: Sequence[Scalar], known: Known) -> Array:
    """The Jacobian at poses, (N, size, size); `known` is without derivatives."""
    return _matrix(known.equations.jacobian(values, known.numbers), len(values))


def _matrix(entries: Sequence[tuple[int, int, Scalar]], size: int) -> Array:
    """A matrix from its nonzero entries, (N, size, size) for entries (N,), (size, size) for numbers."""
    matrix = np.zeros((*np.broadcast_shapes(*(np.shape(entry) for *_, entry in entries)), size, size))
    for i, j, entry in entries:
        matrix[..., i, j] = entry
    return matrix


def inverse_of(matrix: Array) -> Array:
    """Inverses of matrices (N, size, size); pseudoinverses if one of them is singular."""
    try:
        return np.asarray(np.linalg.inv(matrix), dtype=float)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrix), dtype=float)


def by_doubles(inverse: Array) -> Solved:
    """Solves with inverses of the Jacobian, (N, size, size), for rows of one number or of N."""

    def solved(rows: Sequence[Scalar]) -> list[Array]:
        stacked = np.array([np.broadcast_to(row, len(inverse)) for row in rows])
        return list(-np.einsum("nij,jn->in", inverse, stacked))

    return solved


def motion_of_a_miss(first: Array, jets: Sequence[Jet], inverse: Array, known: Known) -> Array:
    """Effect of constant residuals of the equations on the unknowns, by order, unknown, residual and instant.

    C(y, t) = delta gives C' dy = delta, and differentiated

        C' dy'  = -(C')' dy,        C' dy'' = -2 (C')' dy' - (C')'' dy,        and so on.

    Args:
        first: dy of each residual, (size, residuals, N).
        jets: the unknowns with their rates.
        inverse: inverse of C', (N, size, size).
    """
    entries = known.equations.jacobian(jets, known.numbers)
    # An entry of the Jacobian may be a plain number.
    turned = [
        _matrix([(i, j, x.part(order) if isinstance(x, Jet) else 0.0) for i, j, x in entries], len(jets))
        for order in range(1, known.derivatives + 1)
    ]
    found = [first.transpose(2, 0, 1)]
    for d in range(1, known.derivatives + 1):
        rest = sum(comb(d, k) * (turned[k - 1] @ found[d - k]) for k in range(1, d + 1))
        found.append(np.asarray(-inverse @ rest))
    return np.stack(found).transpose(0, 2, 3, 1)


def with_slopes(jets: Sequence[Jet], slopes: Array) -> list[Jet]:
    """Jets of duals; the slopes go by order and unknown."""
    return [Jet(*(Jet(part, slopes[d, i]) for d, part in enumerate(jet.parts))) for i, jet in enumerate(jets)]


def values_of(vector: Vector, count: int) -> Array:
    """Values of a vector of duals, (N, 3)."""
    return np.stack([np.broadcast_to(value_of(x), count) for x in vector], axis=-1)
