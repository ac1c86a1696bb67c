"""Block order of a square system: which rows determine which unknowns, block after block.

A row reads some coordinates. A perfect matching assigns each unknown a row of its own (Duff's MC21: depth
first with a look ahead; ACM Trans. Math. Softw. 7 (1981) 315). Draw an arrow from each row to the rows of the
unknowns that it reads: rows on a common cycle belong together. These strong components (Tarjan, SIAM J.
Comput. 1 (1972) 146) are the blocks, found in an order in which they can be solved. In this order the
Jacobian is block triangular, so it has full rank if each diagonal block has. The blocks do not depend on
which perfect matching is found (Dulmage and Mendelsohn).

Both searches use explicit stacks, so long chains cause no deep recursion. The components take one pass over
the entries; so does the matching of a linkage, where few rows must give up their unknown to another.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.numerics.arrays import Indices

FREE = -1


@dataclass(frozen=True)
class Block:
    """Rows that determine unknowns, given the known coordinates and the unknowns of earlier blocks.

    Attributes:
        rows: row numbers, ascending.
        unknowns: the unknowns that the rows determine, one per row, ascending.
        reads: every other coordinate that the rows read, ascending.
    """

    rows: tuple[int, ...]
    unknowns: tuple[int, ...]
    reads: tuple[int, ...]


@dataclass(frozen=True)
class DiagonalBlocks:
    """Diagonal blocks of one size: block numbers, (count,), and rows and unknowns of each, (count, size)."""

    numbers: Indices
    rows: Indices
    unknowns: Indices


@dataclass(frozen=True)
class BlockOrder:
    """The blocks of a system, in an order in which they can be solved."""

    blocks: tuple[Block, ...]

    @cached_property
    def diagonal(self) -> tuple[DiagonalBlocks, ...]:
        """The diagonal blocks of a matrix, grouped by size."""
        sizes: dict[int, list[int]] = {}
        for number, block in enumerate(self.blocks):
            sizes.setdefault(len(block.rows), []).append(number)
        return tuple(
            DiagonalBlocks(
                np.array(numbers),
                np.array([self.blocks[number].rows for number in numbers]),
                np.array([self.blocks[number].unknowns for number in numbers]),
            )
            for numbers in sizes.values()
        )

    def needed(self, unknowns: Collection[int]) -> tuple[int, ...]:
        """Numbers of the blocks that determine these unknowns, including earlier blocks, in order."""
        wanted, found = set(unknowns), []
        for number in range(len(self.blocks) - 1, -1, -1):
            block = self.blocks[number]
            if not wanted.isdisjoint(block.unknowns):
                found.append(number)
                wanted.update(block.reads)
        return tuple(reversed(found))


def block_order_of(reads: Sequence[Collection[int]], unknowns: int) -> BlockOrder:
    """The blocks of a system; a single block if rows and unknowns cannot be paired.

    `QuadraticMap.block_order` caches the result.

    Args:
        reads: the coordinates that each row reads, of which the first `unknowns` are unknown.
    """
    patterns = [sorted(coordinates) for coordinates in reads]
    entries = [[i for i in pattern if i < unknowns] for pattern in patterns]
    row_of, spare = _matching(entries, unknowns)
    if spare or len(entries) != unknowns:
        return BlockOrder((_block(patterns, range(len(patterns)), range(unknowns)),))
    unknown_of = [FREE] * len(entries)
    for unknown, row in enumerate(row_of):
        unknown_of[row] = unknown
    components = _strong_components([[row_of[i] for i in row] for row in entries])
    return BlockOrder(
        tuple(_block(patterns, sorted(rows), sorted(unknown_of[row] for row in rows)) for rows in components)
    )


def rows_too_many(reads: Sequence[Collection[int]], unknowns: int) -> tuple[int, ...]:
    """Rows that together read fewer unknowns than they are, for any coefficients; empty if there are none."""
    _, spare = _matching([[i for i in row if i < unknowns] for row in reads], unknowns)
    return spare


def _block(patterns: Sequence[Collection[int]], rows: Collection[int], unknowns: Collection[int]) -> Block:
    read = {coordinate for row in rows for coordinate in patterns[row]}
    return Block(tuple(rows), tuple(unknowns), tuple(sorted(read.difference(unknowns))))


def _matching(entries: Sequence[Sequence[int]], unknowns: int) -> tuple[list[int], tuple[int, ...]]:
    """The row of each unknown, each row used once; and a set of rows that cannot all have an unknown.

    A row takes a free unknown if it reads one; else it looks for a row that can give up its unknown, and so
    on. If none can, the visited rows occupy all unknowns that they read, and are one more (Hall).
    """
    row_of = [FREE] * unknowns
    looked = [0] * len(
        entries
    )  # how far each row has looked for a free unknown; a taken one is never free again
    visited = [FREE] * unknowns  # by the search of which row
    for start in range(len(entries)):
        path, wanted, places = [start], [FREE], [0]
        while path:
            row = path[-1]
            while looked[row] < len(entries[row]) and row_of[entries[row][looked[row]]] != FREE:
                looked[row] += 1
            if looked[row] < len(entries[row]):
                # Each row on the path takes the unknown that the next row gives up.
                wanted[-1] = entries[row][looked[row]]
                for one, unknown in zip(path, wanted, strict=True):
                    row_of[unknown] = one
                break
            while places[-1] < len(entries[row]) and visited[entries[row][places[-1]]] == start:
                places[-1] += 1
            if places[-1] == len(entries[row]):
                for stack in (path, wanted, places):
                    stack.pop()
                continue
            unknown = wanted[-1] = entries[row][places[-1]]
            visited[unknown] = start
            for stack, first in ((path, row_of[unknown]), (wanted, FREE), (places, 0)):
                stack.append(first)
        if not path:
            asked = {row_of[unknown] for unknown in range(unknowns) if visited[unknown] == start}
            return row_of, tuple(sorted({start, *asked}))
    return row_of, ()


def _strong_components(successors: Sequence[Sequence[int]]) -> list[list[int]]:
    """Nodes on common cycles, as components; each component comes after all those that it has arrows to."""
    count = len(successors)
    number, low = [FREE] * count, [FREE] * count  # order of discovery, and the lowest number reached
    open_nodes: list[int] = []
    is_open = [False] * count
    found: list[list[int]] = []
    discovered = 0
    for root in range(count):
        if number[root] != FREE:
            continue
        path, places = [root], [0]
        while path:
            node = path[-1]
            if places[-1] == 0:
                number[node] = low[node] = discovered
                discovered += 1
                open_nodes.append(node)
                is_open[node] = True
            if places[-1] < len(successors[node]):
                other = successors[node][places[-1]]
                places[-1] += 1
                if number[other] == FREE:
                    path.append(other)
                    places.append(0)
                elif is_open[other]:
                    low[node] = min(low[node], number[other])
                continue
            path.pop()
            places.pop()
            if path:
                low[path[-1]] = min(low[path[-1]], low[node])
            if low[node] == number[node]:
                component = [open_nodes.pop()]
                while component[-1] != node:
                    component.append(open_nodes.pop())
                for one in component:
                    is_open[one] = False
                found.append(component)
    return found
