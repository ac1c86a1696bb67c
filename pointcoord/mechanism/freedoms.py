r"""Counts the freedoms of a drawing, names the free coordinates, and leaves out redundant rows.

A planar mechanism of hinges, or a Bricard linkage, has more rows than unknowns: in the closed drawing some
rows depend on the others. These are left out of the map and checked again at every solution (`locked`). If
one is violated there, the mechanism is locked; a compromise between its rows is not accepted as a solution.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from pointcoord.errors import MechanismError
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.hardpoints import dominant, drawn_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.structure import Structure
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import EPS

Place = tuple[float, float, float]

# Newton's method doubles the digits in each step: a drawing not closed after this many steps does not close.
STEPS = 12
# Residual of a closed drawing's row, relative to its size: coordinates of size 1 round by EPS, and a row has
# some tens of products.
CLOSED = 1e3 * EPS
# Residual of a row at a solution, relative to the size of its coordinates: the row has at most 24 products,
# each rounded three times with the differences in it, and their sum.
ROUNDED = 64.0 * EPS
# In symmetric mechanisms many rows are equally far from those before. The first of these is taken, since
# rounding, which differs by processor, would otherwise choose.
NEARLY = 1.0 - 1e-6
# Sines of the angle between two hinges. Directions between points given as doubles are rounded by about EPS.
PARALLEL, NEARLY_PARALLEL = 16.0 * EPS, 0.05


@dataclass(frozen=True)
class Freedoms:
    """The freedoms of a mechanism in its closed drawing.

    Attributes:
        count: freedoms with the inputs held: coordinates less independent rows.
        free: the coordinates that can still move. redundant: the rows that depend on others.
        kept: row numbers of a largest set of independent rows.
    """

    count: int
    free: tuple[str, ...]
    redundant: tuple[str, ...]
    kept: tuple[int, ...]

    @classmethod
    def of(cls, topology: Topology, points: Mapping[str, Place], axes: Mapping[str, Place]) -> Freedoms:
        """The freedoms of a drawing.

        Args:
            axes: `up` and `right` of the car.
        Raises:
            MechanismError: the drawing does not close.
        """
        mechanism = drawn_mechanism(topology, dict(points), dict(axes))
        system = mechanism.map
        matrix = system.jacobian(_closed(mechanism))
        scale = np.abs(matrix).max(axis=1, keepdims=True)
        matrix = matrix / np.where(scale > 0.0, scale, 1.0)
        kept = _independent(matrix, (_rows_of_rods(topology), _rows_of_inputs(topology)))
        rank = len(kept)
        null, left = (np.linalg.svd(each)[2][rank:] for each in (matrix, matrix.T))
        free = tuple(topology.layout.describe(i) for i in dominant(null))
        redundant = tuple(topology.labels[i] for i in dominant(left))
        return cls(system.unknowns - rank, free, redundant, tuple(sorted(kept)))


def _rows_of_inputs(topology: Topology) -> list[int]:
    """Numbers of the rows that only inputs add; a driven slide's row also holds its point on the line."""
    driven, reads = set(topology.driven), topology.map.reads
    return _rows(topology, lambda one, row: not (one.slide or driven.isdisjoint(reads[row])))


def _rows_of_rods(topology: Topology) -> list[int]:
    """Numbers of the rows of rods.

    One of two rods side by side can be left out in every pose. A row of the body that both hold cannot:
    where the rods lie across it, the other rows do not determine it.
    """
    rods = {frozenset(ends) for ends in topology.rods.values()}
    return _rows(topology, lambda one, _: any(frozenset(ends) in rods for ends in one.squared_lengths))


def _rows(topology: Topology, wanted: Callable[[Constraint, int], bool]) -> list[int]:
    each = zip(topology.constraints, topology.rows_of, strict=True)
    return [row for constraint, rows in each for row in rows if wanted(constraint, row)]


def _independent(matrix: Array, last: Sequence[list[int]]) -> list[int]:
    """Numbers of independent rows; each group of `last` is tried after all rows before. Each time the row
    farthest from the span of the rows before is taken.

    A row is dependent if its part outside that span is below 64 n EPS of the largest row, the rounding of the
    coordinates that its numbers are made of.
    """
    count, n = matrix.shape
    rest, kept = matrix.copy(), list[int]()
    least = 64.0 * max(count, n) * EPS * float(np.linalg.norm(matrix, axis=1).max(initial=1.0))
    first = [row for row in range(count) if not any(row in group for group in last)]
    for group in (first, *last):
        waiting = list(group)
        while waiting and len(kept) < n:
            lengths = np.linalg.norm(rest[waiting], axis=1)
            best = int(np.argmax(lengths >= NEARLY * lengths.max()))
            if lengths[best] <= least:
                break
            row = waiting.pop(best)
            kept.append(row)
            unit = rest[row] / lengths[best]
            for _ in range(2):  # the second pass removes what rounding left in the first
                rest -= np.outer(rest @ unit, unit)
    return kept


def _closed(mechanism: Mechanism) -> Array:
    """Close the drawing with its inputs held, by least-squares Newton steps.

    If that fails, the drawn coordinates are returned if there are no more equations than coordinates.
    """
    y, system = mechanism.drawn.copy(), mechanism.map
    n = system.unknowns
    for _ in range(STEPS):
        rest = system.residual(y)
        if np.abs(rest).max(initial=0.0) <= CLOSED:
            return y
        y[:n] -= np.linalg.lstsq(system.jacobian(y), rest, rcond=64.0 * n * EPS)[0]
    if len(system.rows) <= n:
        return mechanism.drawn
    worst = mechanism.topology.labels[int(np.argmax(np.abs(system.residual(y))))]
    raise MechanismError(
        f"the drawing of {mechanism.topology.name} has more equations than coordinates and does not close: "
        f"{worst} does not fit the others; correct its points, or leave an input out",
        [worst],
    )


def settled(topology: Topology, points: Mapping[str, Place], axes: Mapping[str, Place]) -> Topology:
    """A topology with as many rows as unknowns: redundant rows are left out.

    The topology itself if its drawing does not close, if a freedom is left or if two inputs drive the same
    freedom; the scene's checks report these.
    """
    try:
        found = Freedoms.of(topology, points, axes)
    except MechanismError:
        return topology
    lost = [row for row in range(len(topology.labels)) if row not in found.kept]
    if found.count or not set(lost).isdisjoint(_rows_of_inputs(topology)):
        return topology
    return topology.without(tuple(lost))


def locked(mechanism: Mechanism, y: Array, off: Array) -> dict[int, MechanismError]:
    """Solutions that violate a row that was left out, by number, with the error.

    Args:
        y: coordinates, shape (N, size). off: error bound of the unknowns, (N,), in units of the mechanism; a
            row is violated if its residual is larger than this bound and rounding explain.
    """
    topology = mechanism.topology
    if not topology.left_out or not len(y):
        return {}
    system, labels = topology.left_map, topology.left_labels
    residual = np.abs(system.residual(y))
    slope = np.abs(system.jacobian(y)).sum(axis=-1)
    size = 1.0 + np.abs(y).max(axis=-1, keepdims=True)
    allowed = slope * off[:, None] + ROUNDED * size**2 + system.unknowns * off[:, None] ** 2
    share = np.where(residual <= allowed, 0.0, residual / allowed)
    found = {}
    for number in np.flatnonzero(share.any(axis=-1)).tolist():
        row = int(np.argmax(share[number]))
        found[number] = MechanismError(
            f"{topology.name} is locked: {labels[row]} follows from the other equations in the drawing only, "
            f"and is violated by {float(residual[number, row]):.3g} away from it; draw hinges that are meant "
            "to be parallel, or to meet in a point, exactly so",
            [labels[row]],
        )
    return found


def askew_hinges(structure: Structure, points: Mapping[str, Place]) -> list[str]:
    """The hinges, named by their two points, that are drawn nearly but not exactly parallel to others."""
    pairs = (structure.shared(one, other) for one, other in combinations(structure.bodies, 2))
    ends = [pair for pair in pairs if len(pair) == 2]
    lines = np.array([np.subtract(points[q], points[p]) for p, q in ends]).reshape(-1, 3)
    lines = lines / np.linalg.norm(lines, axis=-1, keepdims=True)
    sines = np.linalg.norm(np.cross(lines[:, None], lines), axis=-1)
    askew = ((sines > PARALLEL) & (sines < NEARLY_PARALLEL)).any(axis=-1)
    return [f"{p} - {q}" for (p, q), one in zip(ends, askew, strict=True) if one]
