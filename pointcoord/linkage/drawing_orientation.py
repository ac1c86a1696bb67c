"""Whether a drawing says which way the pieces of a line point.

A drawing need not be assembled: its points are put on one line first. Pieces that are drawn more than a
right angle apart, each in its own direction, would turn over against each other on the way, and nothing
tells which of them was meant.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology

Array = NDArray[np.float64]
Piece = tuple[str, str]


def pieces(topology: Topology) -> dict[Piece, tuple[Piece, ...]]:
    """By line, pairs of points that have a sense along it: links on it, and slides from its start."""
    on_lines: dict[Piece, list[str]] = {}
    for constraint in topology.constraints:
        if constraint.aligned:
            start, end, point = constraint.aligned
            on_lines.setdefault((start, end), []).append(point)
    links = [ends for constraint in topology.constraints for ends in constraint.squared_lengths]
    found: dict[Piece, tuple[Piece, ...]] = {}
    for (start, end), slides in on_lines.items():
        rigid = [link for link in links if {start, end, *slides}.issuperset(link)]
        found[start, end] = (*rigid, *((start, point) for point in slides))
    return found


def turned_over(mechanism: Mechanism, y: Array) -> tuple[NDArray[np.bool_], tuple[Piece, Piece] | None]:
    """Members of a batch in which two pieces turn over between the drawing and y, and such a pair."""
    bad = np.zeros(y.shape[:-1], dtype=bool)
    pair: tuple[Piece, Piece] | None = None
    for along in pieces(mechanism.topology).values():
        for one, other in combinations(along, 2):
            drawn, closed = (
                _product(mechanism, coordinates, one, other) for coordinates in (mechanism.drawn, y)
            )
            flipped = np.broadcast_to(np.sign(drawn) != np.sign(closed), bad.shape)
            if flipped.any():
                bad, pair = bad | flipped, pair or (one, other)
    return bad, pair


def _product(mechanism: Mechanism, y: Array, one: Piece, other: Piece) -> Array:
    vectors = (
        y[..., list(mechanism.layout.vector(end))] - y[..., list(mechanism.layout.vector(start))]
        for start, end in (one, other)
    )
    first, second = vectors
    return np.asarray(np.sum(first * second, axis=-1))
