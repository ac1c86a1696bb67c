r"""Some blocks of a quadratic map, as a smaller map: what the others solve for is known to it.

With the unknowns u = [v, s], s those of the blocks that are left out, the map's coordinates are the same
y in another order, [v, s, w]; it has the rows of the blocks that are kept, and v is what it solves for. What
moves when some known coordinates do is such a part: a block that reads an unknown that moves moves too, so
the blocks that are left out read none, and their s, once solved, is right for good.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.quadratic import Product, QuadraticMap

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PartialMap:
    """A part of a map.

    Attributes:
        whole: what it is a part of.
        system: the part.
        order: by coordinate of the part, its number in the whole, shape (size,).
    """

    whole: QuadraticMap
    system: QuadraticMap
    order: NDArray[np.intp]

    @property
    def unknowns(self) -> NDArray[np.intp]:
        """By unknown of the part, its number in the whole."""
        return self.order[: self.system.unknowns]

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left out."""
        return self.system is self.whole

    def taken(self, y: Array) -> Array:
        """Coordinates of the whole in the order of the part, shape (..., size)."""
        return y if self.is_whole else y.take(self.order, axis=-1)

    def back(self, y: Array) -> Array:
        """Coordinates of the part in the order of the whole, shape (..., size)."""
        if self.is_whole:
            return y
        found = np.empty_like(y)
        found[..., self.order] = y
        return found

    def unknowns_back(self, y: Array, series: Array) -> Array:
        """Series of the part's unknown coordinates as those of the whole; what stands still is as in y.

        Args:
            y: of the part, shape (..., size). series: shape (..., powers, unknowns of the part).
        """
        if self.is_whole:
            return series
        found = np.zeros((*series.shape[:-1], self.whole.unknowns))
        found[..., 0, :] = self.back(y)[..., : self.whole.unknowns]
        found[..., self.unknowns] = series
        return found

    def known(self, y: Array, known: Array) -> Array:
        """What is known to the part: what stays as it is in y, and series of what is known to the whole.

        Args:
            y: of the part, shape (..., size).
            known: shape (..., order + 1, known coordinates of the whole).
        Returns:
            Shape (..., order + 1, known coordinates of the part).
        """
        if self.is_whole:
            return known
        first, last = self.system.unknowns, self.whole.unknowns
        batch = () if y.ndim + 1 == known.ndim == 2 else np.broadcast_shapes(y.shape[:-1], known.shape[:-2])
        both = np.zeros((*batch, known.shape[-2], last - first + known.shape[-1]))
        both[..., 0, : last - first] = y[..., first:last]
        both[..., last - first :] = known
        return both


@lru_cache(maxsize=64)
def moving_part(system: QuadraticMap, driven: frozenset[int]) -> PartialMap:
    """The blocks that move when some known coordinates do; all of them if none would.

    Args:
        driven: the known coordinates that move.
    """
    structure = system.structure
    moved = structure.moved_by(driven)
    blocks = [block for block, moves in zip(structure.blocks, moved, strict=True) if moves or not any(moved)]
    rows = sorted(row for block in blocks for row in block.rows)
    if len(rows) == len(system.rows):
        return PartialMap(system, system, np.arange(system.size))
    solved = sorted(unknown for block in blocks for unknown in block.unknowns)
    chosen = set(solved)
    order = [*solved, *(i for i in range(system.size) if i not in chosen)]
    place = {number: i for i, number in enumerate(order)}
    kept = tuple(
        tuple(
            Product(
                p.coefficient, (place[p.left[0]], place[p.left[1]]), (place[p.right[0]], place[p.right[1]])
            )
            for p in system.rows[row]
        )
        for row in rows
    )
    return PartialMap(
        system,
        QuadraticMap(kept, len(solved), system.size),
        np.array(order, dtype=np.intp),
    )
