"""Block order of a square system: which rows determine which unknowns, block after block.

A row reads some coordinates. A perfect matching assigns each unknown a row of its own, by augmenting paths
(Kuhn, Naval Research Logistics Quarterly 2 (1955) 83). Draw an arrow from each row to the rows of the
unknowns that it reads: rows on a common cycle belong together. These strong components (Sharir, Computers &
Mathematics with Applications 7 (1981) 67) are the blocks, found in an order in which they can be solved. In
this order the Jacobian is block triangular, so it has full rank if each diagonal block has. The blocks do not
depend on which perfect matching is found (Dulmage and Mendelsohn).

The searches use lists, so long chains cause no deep recursion. The components take one pass over the entries;
so does the matching of a linkage, where few rows must give up their unknown to another.
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

    A row takes a free unknown if it reads one; else it asks the rows of the unknowns that it reads to give
    them up, and so on, breadth first. If none can, the rows that were asked occupy all unknowns that they
    read, and are one more (Hall).
    """
    row_of, unknown_of = [FREE] * unknowns, [FREE] * len(entries)
    for start in range(len(entries)):
        asking = dict[int, int]()  # unknown -> the row that would take it
        rows = [start]
        for row in rows:
            for unknown in entries[row]:
                if unknown not in asking:
                    asking[unknown] = row
                    rows.append(row_of[unknown])
            if FREE in rows:
                break
        else:
            return row_of, tuple(sorted(rows))
        unknown = next(one for one in reversed(asking) if row_of[one] == FREE)
        while unknown != FREE:
            # Each row takes the unknown that it asked for, and gives up its own.
            row = row_of[unknown] = asking[unknown]
            unknown_of[row], unknown = unknown, unknown_of[row]
    return row_of, ()


def _strong_components(successors: Sequence[Sequence[int]]) -> list[list[int]]:
    """Nodes on common cycles, as components; each component comes after all those that it has arrows to.

    A search along the arrows finishes every node after all nodes that it found from there. Against the
    arrows, the node that was finished last then reaches the nodes of its own component only, and so on.
    """
    predecessors: list[list[int]] = [[] for _ in successors]
    finished, seen = list[int](), set[int]()
    for root in range(len(successors)):
        if root in seen:
            continue
        seen.add(root)
        path = [(root, iter(successors[root]))]
        while path:
            node, others = path[-1]
            other = next(others, None)
            if other is None:
                finished.append(node)
                path.pop()
                continue
            predecessors[other].append(node)
            if other not in seen:
                seen.add(other)
                path.append((other, iter(successors[other])))
    found, left = list[list[int]](), seen
    for root in reversed(finished):
        if root not in left:
            continue
        left.remove(root)
        component = [root]
        for node in component:
            new = left.intersection(predecessors[node])
            left -= new
            component += new
        found.append(component)
    return found[::-1]
