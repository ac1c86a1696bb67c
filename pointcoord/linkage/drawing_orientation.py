"""Whether a drawing says which way the pieces of a line point.

A drawing need not be assembled: its points are put on one line first. Pieces that are drawn more than a
right angle apart, each in its own direction, would turn over against each other on the way, and nothing
tells which of them was meant.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Piece

Array = NDArray[np.float64]


def turned_over(mechanism: Mechanism, y: Array) -> tuple[NDArray[np.bool_], tuple[Piece, Piece] | None]:
    """Members of a batch in which two pieces turn over between the drawing and y, and such a pair."""
    pairs, places = mechanism.topology.paired_pieces
    if not pairs:
        return np.zeros(y.shape[:-1], dtype=bool), None
    drawn, closed = (np.sign(_products(coordinates, places)) for coordinates in (mechanism.drawn, y))
    flipped = np.broadcast_to(drawn != closed, (*y.shape[:-1], len(pairs)))
    bad = np.asarray(flipped.any(axis=-1))
    if not bad.any():
        return bad, None
    return bad, pairs[int(np.argmax(flipped.reshape(-1, len(pairs)).any(axis=0)))]


def _products(y: Array, places: NDArray[np.intp]) -> Array:
    """Scalar products of the pieces of each pair, (..., pairs)."""
    ends = y[..., places]
    edges = ends[..., 1, :] - ends[..., 0, :]
    return np.asarray((edges[..., 0, :] * edges[..., 1, :]).sum(axis=-1))
