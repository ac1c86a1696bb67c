"""The blocks of a system, held to scipy's graph algorithms and to the definition of a block triangle."""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from pointcoord.numerics.block_order import BlockOrder, block_order_of


class Pattern(NamedTuple):
    """Rows of which only is known what they read."""

    reads: Sequence[Collection[int]]
    unknowns: int


@st.composite
def patterns(draw: st.DrawFn) -> Pattern:
    """Square patterns, most with a perfect matching: some entries on a hidden permutation, some not."""
    n = draw(st.integers(1, 12))
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    density = draw(st.sampled_from((0.03, 0.1, 0.2, 0.4)))
    entries = rng.random((n, n + 3)) < density
    if draw(st.booleans()):
        entries[np.arange(n), rng.permutation(n)] = True
    return Pattern([set(np.flatnonzero(row).tolist()) for row in entries], n)


def by_scipy(pattern: Pattern) -> set[tuple[frozenset[int], frozenset[int]]] | None:
    """Rows and unknowns of each block by scipy; None if there is no perfect matching."""
    n = pattern.unknowns
    matrix = np.zeros((n, n), dtype=int)
    for row, read in enumerate(pattern.reads):
        matrix[row, [i for i in read if i < n]] = 1
    row_of = maximum_bipartite_matching(csr_array(matrix), perm_type="row")
    if (row_of < 0).any():
        return None
    # Column j of the reordered matrix belongs to row j of it: the unknown that row determines.
    unknown_of = np.argsort(row_of)
    count, labels = connected_components(csr_array(matrix[:, unknown_of]), connection="strong")
    return {
        (
            frozenset(np.flatnonzero(labels == c).tolist()),
            frozenset(unknown_of[np.flatnonzero(labels == c)].tolist()),
        )
        for c in range(count)
    }


def require_blocks(order: BlockOrder, pattern: Pattern) -> None:
    """Each row and unknown in one block, and no row reads an unknown of a later block."""
    n = pattern.unknowns
    assert sorted(r for b in order.blocks for r in b.rows) == list(range(n))
    assert sorted(u for b in order.blocks for u in b.unknowns) == list(range(n))
    solved: set[int] = set()
    for block in order.blocks:
        assert len(block.rows) == len(block.unknowns)
        read = set().union(*(pattern.reads[row] for row in block.rows))
        assert set(block.reads) == read - set(block.unknowns)
        assert {i for i in block.reads if i < n} <= solved
        solved |= set(block.unknowns)


@given(patterns())
def test_blocks_of_a_random_pattern_are_those_of_scipy(pattern: Pattern) -> None:
    found, wanted = block_order_of(*pattern), by_scipy(pattern)
    if wanted is None:
        assert [(b.rows, b.unknowns) for b in found.blocks] == [(tuple(range(pattern.unknowns)),) * 2]
        return
    require_blocks(found, pattern)
    assert {(frozenset(b.rows), frozenset(b.unknowns)) for b in found.blocks} == wanted
