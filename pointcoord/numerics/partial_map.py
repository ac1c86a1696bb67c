r"""Partial maps: some blocks of a quadratic map as a smaller map, to which all other unknowns are known.

With the unknowns u = [v, s], s those of the blocks left out, the partial map has the same coordinates y in
another order, [v, s, w]. It has the rows of the kept blocks and solves for v. For example, the blocks that
move with some known coordinates are such a part: a block that reads a moving unknown moves too. So the blocks
left out read no moving unknown, and their s needs to be solved only once.

With several inputs, each moves some blocks, and a block depends on all inputs that the unknowns it reads
depend on. The blocks that depend on the same inputs are a part too, a stage. The unknowns of stages with
fewer inputs are known to it.
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
        whole: the whole map.
        system: the part as a map.
        rows: row of the part -> its number in the whole map.
        order: coordinate of the part -> its number in the whole map, shape (size,).
    """

    whole: QuadraticMap
    system: QuadraticMap
    rows: NDArray[np.intp]
    order: NDArray[np.intp]

    @property
    def unknowns(self) -> NDArray[np.intp]:
        """Unknown of the part -> its number in the whole map."""
        return self.order[: self.system.unknowns]

    @property
    def is_whole(self) -> bool:
        """Whether nothing is left out."""
        return self.system is self.whole

    def taken(self, y: Array) -> Array:
        """Coordinates of the whole map in the order of the part, shape (..., size)."""
        return y if self.is_whole else y.take(self.order, axis=-1)

    def back(self, y: Array) -> Array:
        """Coordinates of the part in the order of the whole map, shape (..., size)."""
        if self.is_whole:
            return y
        found = np.empty_like(y)
        found[..., self.order] = y
        return found

    def unknowns_back(self, y: Array, series: Array) -> Array:
        """Series of the whole map's unknowns from the part's; unknowns that stand still are constant as in y.

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
        """Series of what is known to the part: constants from y, and the known series of the whole map.

        Args:
            y: of the part, shape (..., size).
            known: shape (..., order + 1, known coordinates of the whole map).
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
    """The blocks that move with some known coordinates; all blocks if none would move.

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
        reads: moving coordinates that the blocks read, without their own unknowns, as numbers of the whole
            map, ascending.
    """

    inputs: tuple[int, ...]
    part: PartialMap
    reads: tuple[int, ...]

    @property
    def moving(self) -> NDArray[np.intp]:
        """All moving coordinates that the rows read, as numbers of the whole map."""
        return np.array([*self.part.unknowns, *self.reads], dtype=np.intp)


@lru_cache(maxsize=64)
def stages(system: QuadraticMap, driven: tuple[tuple[int, frozenset[int]], ...]) -> tuple[Stage, ...]:
    """The moving blocks grouped by the inputs that move them; each stage comes after those that it reads.

    Blocks that stand still are in no stage.

    Args:
        driven: pairs of a moving known coordinate and the inputs that move it.
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
    """The part with some blocks, by number; the map itself if these are all blocks."""
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
