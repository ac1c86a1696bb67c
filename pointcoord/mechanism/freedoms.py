r"""Counts the freedoms of a drawing, names what is free, and leaves out rows that follow from the others.

A planar mechanism of hinges, or Bricard's, has more rows than its motion needs: at the closed drawing some
depend on the others. Those are left out of the map and looked at again at every answer (`locked`); where
one is violated there, the mechanism is locked, and no compromise between its rows is an answer.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MechanismError
from pointcoord.linkage.hardpoints import dominant, drawn_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism.structure import Structure
from pointcoord.numerics.rounding import EPS

Array = NDArray[np.float64]
Place = tuple[float, float, float]

# Newton's method doubles the digits in a step; a drawing that is not closed after so many does not close.
STEPS = 12
# Of a row of a closed drawing, in its own size: coordinates of size 1 round by EPS, and rows have some tens
# of products.
CLOSED = 1e3 * EPS
# Of a row at an answer, in the size of its coordinates: it has at most 24 products, each rounded with the
# differences in it three times, and their sum.
ROUNDED = 64.0 * EPS
# Of symmetric mechanisms many rows are as far from those before: the first one is taken, not the one that
# rounding makes the farthest, which differs by processor.
NEARLY = 1.0 - 1e-6
# Sines of the angle of two hinges. Directions of points that are drawn in doubles are rounded to EPS or so.
PARALLEL, NEARLY_PARALLEL = 16.0 * EPS, 0.05


@dataclass(frozen=True)
class Freedoms:
    """What a mechanism can do at its closed drawing.

    Attributes:
        count: freedoms with its inputs held, of coordinates less independent rows.
        free: the coordinates that move then. redundant: the rows that depend on others.
        kept: numbers of independent rows, as many as there can be.
    """

    count: int
    free: tuple[str, ...]
    redundant: tuple[str, ...]
    kept: tuple[int, ...]

    @classmethod
    def of(cls, topology: Topology, points: Mapping[str, Place], axes: Mapping[str, Place]) -> Freedoms:
        """Of a drawing.

        Args:
            axes: `up` and `right` of the car.
        Raises:
            MechanismError: it does not close.
        """
        mechanism = drawn_mechanism(topology, dict(points), dict(axes))
        system = mechanism.map
        matrix = system.jacobian(_closed(mechanism))
        scale = np.abs(matrix).max(axis=1, keepdims=True)
        matrix = matrix / np.where(scale > 0.0, scale, 1.0)
        kept = _independent(matrix, _rows_of_inputs(topology))
        rank = len(kept)
        null, left = (np.linalg.svd(each)[2][rank:] for each in (matrix, matrix.T))
        free = tuple(topology.layout.describe(i) for i in dominant(null))
        redundant = tuple(topology.labels[i] for i in dominant(left))
        return cls(system.unknowns - rank, free, redundant, tuple(sorted(kept)))


def _rows_of_inputs(topology: Topology) -> list[int]:
    """Numbers of the rows that only an input makes; a driven line of the chassis also holds its point."""
    driven = set(topology.driven)
    return [
        row
        for constraint, rows in zip(topology.constraints, topology.rows_of, strict=True)
        for row in rows
        if not (constraint.slide or driven.isdisjoint(topology.map.reads[row]))
    ]


def _independent(matrix: Array, last: Iterable[int]) -> list[int]:
    """Numbers of independent rows, those of `last` after others; of each the farthest from those before.

    A row depends on others where what they leave of it is below the rounding of coordinates that its numbers
    are made of, n EPS of the largest, 64 times.
    """
    count, n = matrix.shape
    rest, kept = matrix.copy(), list[int]()
    least = 64.0 * max(count, n) * EPS * float(np.linalg.norm(matrix, axis=1).max(initial=1.0))
    inputs = list(last)
    for group in ([row for row in range(count) if row not in inputs], inputs):
        waiting = list(group)
        while waiting and len(kept) < n:
            lengths = np.linalg.norm(rest[waiting], axis=1)
            best = int(np.argmax(lengths >= NEARLY * lengths.max()))
            if lengths[best] <= least:
                break
            row = waiting.pop(best)
            kept.append(row)
            unit = rest[row] / lengths[best]
            for _ in range(2):  # once more for what rounding leaves
                rest -= np.outer(rest @ unit, unit)
    return kept


def _closed(mechanism: Mechanism) -> Array:
    """The drawing closed by its own inputs, by the shortest steps.

    What does not close so is taken as drawn where there are no more equations than coordinates.
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
        f"{worst} cannot be kept with the others; draw its points where they belong, or leave an input out",
        [worst],
    )


def free_directions(
    topology: Topology, points: Mapping[str, Place], axes: Mapping[str, Place]
) -> tuple[str, ...]:
    """The coordinates of a drawing that its equations do not hold."""
    try:
        return Freedoms.of(topology, points, axes).free
    except MechanismError:
        return ("what a drawing that does not close cannot tell",)


def settled(topology: Topology, points: Mapping[str, Place], axes: Mapping[str, Place]) -> Topology:
    """A topology whose rows are as many as its unknowns: those that follow from the others are left out.

    Raises:
        MechanismError: something is free, or inputs fight.
    """
    found = Freedoms.of(topology, points, axes)
    lost = [row for row in range(len(topology.labels)) if row not in found.kept]
    fighting = not set(lost).isdisjoint(_rows_of_inputs(topology))
    if found.count or fighting:
        raise MechanismError(_words(topology, found, fighting), found.free or found.redundant)
    return topology.without(tuple(lost))


def _words(topology: Topology, found: Freedoms, fighting: bool) -> str:
    driven, count = ", ".join(topology.holding_inputs) or "none", len(topology.holding_inputs)
    words = []
    if fighting:
        words.append(f"has inputs that fight at the drawing: {', '.join(found.redundant)}")
    if found.count:
        more = "freedom" if found.count == 1 else "freedoms"
        words.append(f"has {found.count} {more} left; free at the drawing: {', '.join(found.free)}")
    inputs = f"{count} driven input{'' if count == 1 else 's'} ({driven})"
    return f"{topology.name} with {inputs} {'; it '.join(words)}"


def locked(mechanism: Mechanism, y: Array, off: Array) -> dict[int, MechanismError]:
    """Answers at which a row that was left out is violated, by number, with what that means.

    Args:
        y: coordinates, shape (N, size). off: how far each unknown may be off, (N,), in units; a row is
            violated where it is farther from zero than that explains.
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
            f"{topology.name} is locked: {labels[row]} follows from the other equations at the "
            f"drawing only and is violated by {float(residual[number, row]):.3g} away from it; draw hinges "
            "that are meant to be parallel or to meet in a point exactly so",
            [labels[row]],
        )
    return found


def askew_hinges(structure: Structure, points: Mapping[str, Place]) -> list[str]:
    """The hinges, each by its two points, that are drawn nearly parallel to others but not exactly."""
    pairs = (structure.shared(one, other) for one, other in combinations(structure.bodies, 2))
    ends = [pair for pair in pairs if len(pair) == 2]
    lines = np.array([np.subtract(points[q], points[p]) for p, q in ends]).reshape(-1, 3)
    lines = lines / np.linalg.norm(lines, axis=-1, keepdims=True)
    sines = np.linalg.norm(np.cross(lines[:, None], lines), axis=-1)
    askew = ((sines > PARALLEL) & (sines < NEARLY_PARALLEL)).any(axis=-1)
    return [f"{p} - {q}" for (p, q), one in zip(ends, askew, strict=True) if one]
