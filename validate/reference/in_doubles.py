r"""The equations at many instants at once, in doubles: poses that are known, their rates, and small changes.

One text of the equations serves every kind of number (`linkage`): here arrays over the instants, (N,), and
duals of them whose slopes are (directions, N). From C(y, t) = 0 follow y' and y'', and by a parameter that
the equations depend on, order by order, what it makes of y, y' and y'': each solves an equation with the one
matrix C', and what stands on its right is C itself, evaluated with duals.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import sqrt
from typing import Self

import numpy as np
from flint import arb
from numpy.typing import NDArray

from validate.reference.design import HEAVE, Design
from validate.reference.dual import Dual, slope_of, value_of
from validate.reference.jet import Jet
from validate.reference.linkage import Known
from validate.reference.vectors import Scalar, Vector, plus

Array = NDArray[np.float64]

ORDERS = 3  # a number, its rate and its acceleration


class Constant(float):
    """A number that the equations take the root of, alone or after a quotient."""

    def sqrt(self) -> float:
        """Its root."""
        return sqrt(self)

    def __truediv__(self, other: float) -> Self:
        return type(self)(float(self) / other)

    def __rtruediv__(self, other: float) -> Self:
        return type(self)(other / float(self))


def known_in_doubles(design: Design, laws: Mapping[str, Array], count: int) -> Known:
    """What the equations take as given, as jets of arrays (N,).

    Args:
        laws: of each input that does not rest at zero, value, rate and acceleration, (N, 3); rad or mm.
        count: N.
    """
    linkage = design.linkage
    still = np.zeros((count, ORDERS))
    driven = {}
    for name, drive in linkage.inputs.items():
        found = [
            drive.driven(Jet(*(arb(x) for x in law)), design.squared_length, design.unit)
            for law in laws.get(name, still).tolist()
        ]
        driven[name] = Jet(*np.array([floats_of_jet(jet) for jet in found]).reshape(-1, ORDERS).T)
    up, right = floats_of(design.up), floats_of(design.right)
    return Known(
        linkage=linkage,
        chassis={n: plus(_still(design.table[n], count), lift(design, laws)) for n in linkage.chassis},
        up=up,
        right=right,
        squared_length={link: Constant(float(x)) for link, x in design.squared_length.items()},
        driven=driven,
        knuckle={name: floats_of(shape) for name, shape in design.knuckle.items()},
    )


def lift(design: Design, laws: Mapping[str, Array]) -> Vector:
    """What heave moves the chassis by, jets of arrays; local."""
    if HEAVE not in laws:
        return 0.0, 0.0, 0.0
    rise, up = Jet(*(laws[HEAVE] / float(design.unit)).T), floats_of(design.up)
    return rise * up[0], rise * up[1], rise * up[2]


def local_places(design: Design, places: Mapping[str, Array]) -> dict[str, Vector]:
    """Points, (N, 3), mm, in the design's coordinates."""
    origin, unit = np.array([float(x) for x in design.origin]), float(design.unit)
    local = {}
    for name in design.names:
        x, y, z = ((places[name] - origin) / unit).T
        local[name] = (x, y, z)
    return local


def jacobian_of(values: Sequence[Scalar], known: Known, part: Callable[[Scalar], Scalar] = value_of) -> Array:
    """The Jacobian or its slope, (..., N, size, size)."""
    entries = [(i, j, part(entry)) for i, j, entry in known.linkage.jacobian(values, known)]
    shape = np.broadcast_shapes(*(np.shape(entry) for *_, entry in entries))
    matrix = np.zeros((*shape, known.linkage.size, known.linkage.size))
    for i, j, entry in entries:
        matrix[..., i, j] = entry
    return matrix


def inverse_of(matrix: Array) -> Array:
    """Of matrices (N, size, size); of one without an inverse what comes nearest to one."""
    try:
        return np.asarray(np.linalg.inv(matrix), dtype=float)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.pinv(matrix), dtype=float)


def newton_step(values: Array, inverse: Array, known: Known) -> Array:
    """What Newton's method takes off unknowns, (size, N)."""
    rows = known.linkage.residual(list(values), known)
    stacked = np.array([np.broadcast_to(row, values.shape[1:]) for row in rows])
    return np.asarray(np.einsum("nij,jn->in", inverse, stacked))


def unknown_jets_of(values: Sequence[Array], inverse: Array, known: Known) -> list[Jet]:
    """The unknowns with their rates, as in `kinematics.unknown_jets`."""
    zero = np.zeros_like(values[0])

    def solved(rows: Sequence[Scalar]) -> Array:
        stacked = np.array([np.broadcast_to(row, zero.shape) for row in rows])
        return np.asarray(-np.einsum("nij,jn->in", inverse, stacked))

    still = [Jet(value, zero, zero) for value in values]
    velocity = solved([row.rate for row in known.linkage.residual(still, known)])
    moving = [Jet(jet.value, rate, zero) for jet, rate in zip(still, velocity, strict=True)]
    bend = solved([row.acceleration for row in known.linkage.residual(moving, known)])
    return [Jet(jet.value, jet.rate, second) for jet, second in zip(moving, bend, strict=True)]


def changes_of(
    jets: Sequence[Jet], inverse: Array, known: Known, directions: int, first: Array | None = None
) -> Array:
    """What each direction makes of the unknowns, by order, unknown, direction and instant.

    C' dy = -dC, C' dy' = -d(C' y' + C_t) with dy, and so on: dC of what `known` has slopes of.

    Args:
        first: dy, (size, directions, N), where it is known already.
    """
    size, count = known.linkage.size, len(inverse)
    found = np.zeros((ORDERS, size, directions, count))
    start = 0
    if first is not None:
        found[0], start = first, 1
    for d in range(start, ORDERS):
        rows = known.linkage.residual(with_slopes(jets, found), known)
        moved = np.array([np.broadcast_to(slope_of(part_of(row, d)), (directions, count)) for row in rows])
        found[d] = -np.einsum("nij,jkn->ikn", inverse, moved)
    return found


def with_slopes(jets: Sequence[Jet], slopes: Array) -> list[Jet]:
    """Jets of duals, the slopes by order and unknown."""
    return [Jet(*(Dual(part_of(jet, d), slopes[d, i]) for d in range(ORDERS))) for i, jet in enumerate(jets)]


def part_of(jet: Jet, order: int) -> Scalar:
    """Value, rate or acceleration."""
    return (jet.value, jet.rate, jet.acceleration)[order]


def order_of(point: Vector, order: int) -> Vector:
    """The same of a vector of jets."""
    x, y, z = (part_of(component, order) for component in point)
    return x, y, z


def values_of(vector: Vector, count: int) -> Array:
    """Values of a vector of duals, (N, 3)."""
    return np.stack([np.broadcast_to(value_of(x), count) for x in vector], axis=-1)


def floats_of(vector: Vector) -> Vector:
    """Three fractions as doubles."""
    x, y, z = (float(x) for x in vector)
    return x, y, z


def floats_of_jet(jet: Jet) -> tuple[float, float, float]:
    """A jet of balls as doubles."""
    return float(jet.value), float(jet.rate), float(jet.acceleration)


def _still(vector: Vector, count: int) -> Vector:
    x, y, z = (Jet(np.full(count, float(x)), np.zeros(count), np.zeros(count)) for x in vector)
    return x, y, z
