r"""Some blocks of a quadratic map, as a smaller map: what the others solve for is known to it.

With the unknowns u = [v, s], s those of the blocks that are left out, the map's coordinates are the same
y in another order, [v, s, w]; it has the rows of the blocks that are kept, and v is what it solves for. What
moves when some known coordinates do is such a part: a block that reads an unknown that moves moves too, so
the blocks that are left out read none, and their s, once solved, is right for good.

Of several inputs each moves some blocks, and a block that reads an unknown hangs on all the inputs that this
one does. So the blocks that hang on the same inputs are a part too, a stage: to it the unknowns of the stages
of fewer inputs are known.
"""

from __future__ import annotations

from collections.abc import Sequence
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
        rows: by row of the part, its number in the whole.
        order: by coordinate of the part, its number in the whole, shape (size,).
    """

    whole: QuadraticMap
    system: QuadraticMap
    rows: NDArray[np.intp]
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
    moved = system.block_order.moved_by(dict.fromkeys(driven, frozenset({0})))
    numbers = [number for number, causes in enumerate(moved) if causes]
    return _part_of(system, numbers or range(len(moved)))


@dataclass(frozen=True)
class Stage:
    """The blocks that the same inputs move.

    Attributes:
        inputs: ascending. part: the blocks, as a map.
        reads: what moves that they read, beside their own unknowns, as numbers of the whole, ascending.
    """

    inputs: tuple[int, ...]
    part: PartialMap
    reads: tuple[int, ...]

    @property
    def moving(self) -> NDArray[np.intp]:
        """All that moves of what its rows read, as numbers of the whole."""
        return np.array([*self.part.unknowns, *self.reads], dtype=np.intp)


@lru_cache(maxsize=64)
def stages(system: QuadraticMap, driven: tuple[tuple[int, frozenset[int]], ...]) -> tuple[Stage, ...]:
    """The blocks by the inputs that move them, each stage after those that it reads.

    What stands still is in none.

    Args:
        driven: the known coordinates that move, and which inputs move each.
    """
    order = system.block_order
    moved = order.moved_by(dict(driven))
    moving = {number for number, inputs in driven if inputs}
    for block, inputs in zip(order.blocks, moved, strict=True):
        moving.update(block.unknowns if inputs else ())
    found = []
    for inputs in sorted({*moved} - {frozenset()}, key=lambda inputs: (len(inputs), sorted(inputs))):
        numbers = [number for number, own in enumerate(moved) if own == inputs]
        part = _part_of(system, numbers)
        read = {i for number in numbers for i in order.blocks[number].reads}
        reads = tuple(sorted((read & moving).difference(part.unknowns.tolist())))
        found.append(Stage(tuple(sorted(inputs)), part, reads))
    return tuple(found)


def _part_of(system: QuadraticMap, numbers: Sequence[int]) -> PartialMap:
    """Some blocks, by number; the map itself if they are all."""
    blocks = [system.block_order.blocks[number] for number in numbers]
    rows = sorted(row for block in blocks for row in block.rows)
    if len(rows) == len(system.rows):
        return PartialMap(system, system, np.arange(len(rows)), np.arange(system.size))
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
        np.array(rows, dtype=np.intp),
        np.array(order, dtype=np.intp),
    )
