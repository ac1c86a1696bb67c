r"""Newton and Kantorovich's theorem block by block, for many members, a member a column.

C_u is block triangular (see `structure`): each block of rows determines its own unknowns, given known
coordinates and the unknowns of earlier blocks. So one assembly after another can be proven to lie near a
predictor y + p(s), 0 <= s <= 1, each in the norm of its own few unknowns, where the whole system in one norm
would need steps a tenth as long. For a block b with X = C_b^-1 at y (of its own rows and unknowns) and
earlier unknowns within R_e of their predictors,

    eta   = |X C_b(y + p)| + |X| (|C_e(y + p)| R_e + sum |B_ee'| R_e R_e'),
    z     = |X C_b'(p)| + |X| sum |2 B_be| R_e,
    omega = max_i sum_r |X_ir| sum_jk |2 B_rjk|         over the unknowns j and k of the block,

say by 2 omega eta <= (1 - z)^2 that exactly one assembly of the block lies within
R_b = 2 eta / ((1 - z)(1 + sqrt(1 - h))), h = 2 omega eta / (1 - z)^2. All of it grows with s if p does, so
what holds at the end of a step holds all along it: the assemblies along it are one branch, and by the
uniqueness in each block no other one is within (1 - z) / omega of them. The norm of a block weighs its
unknowns, max_i |u_i| / g_i, by how far they
go together, so that one that moves little counts as much as one that moves far.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.batch_last.column_map import ColumnMap
from pointcoord.numerics.batch_last.elimination import Elimination
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.structure import Structure

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class _Coupling:
    """How a block hangs on earlier ones.

    Attributes:
        rows: of the block. mine: which entries of X are its own. unknowns: its own.
        entries: those of C_u that its rows have in earlier unknowns; blocks: whose unknown each is.
        by_row: g_j where such an entry is of a row, (rows, entries).
        turning: sum |2 B_rjk| over the block's own j and the k of each earlier block, (rows, blocks).
        bending: half that over j and k of earlier blocks, (rows, pairs). pairs: these, by number.
        inverse_rows: row of each entry of X, counted in the block. sums: 1 / g_i where one is of an unknown
            i.
    """

    rows: Indices
    mine: slice
    unknowns: Indices
    entries: Indices
    blocks: Indices
    by_row: Array
    turning: Array
    bending: Array
    pairs: tuple[Indices, Indices]
    inverse_rows: Indices
    sums: Array


@dataclass(frozen=True)
class BlockProof:
    """How the constants are summed; make it with `block_proof`.

    Attributes:
        couplings: of the blocks, in the order in which they are solved.
        rows, sums: row of each entry of X, and 1 / g_i where one is of an unknown i, (unknowns, entries).
        turning, all_turning: sum |2 B_rjk| over a row's own block, and over all unknowns, of each entry of X.
        factors: entries of X and of C_u(p) in each product of a sum (X C_b(p))_ij, sorted by how often their
            sum has had one. layers: how many sums have a first product, a second, and so on.
        by_row: g_j / g_i where a sum is of unknown i, (unknowns, sums). diagonal: 1 where i = j, (sums,).
        weights: g, the largest of each block 1, (unknowns,).
    """

    couplings: tuple[_Coupling, ...]
    rows: Indices
    sums: Array
    turning: Array
    all_turning: Array
    factors: tuple[Indices, Indices]
    layers: tuple[int, ...]
    by_row: Array
    diagonal: Array
    weights: Array

    def lipschitz(self, inverse: Array) -> Array:
        """Omega of each block, shape (blocks, members), from the magnitudes of the entries of X."""
        return self.by_block(self.sums @ (inverse * self.turning[:, None]))

    def turning_of_all(self, inverse: Array) -> Array:
        """|X| sum |2 B| over all unknowns, which bounds what any correction does, shape (blocks, members)."""
        return self.by_block(self.sums @ (inverse * self.all_turning[:, None]))

    def times(self, inverse: Array, rows: Array) -> Array:
        """X times rows, block by block, by weights, shape (unknowns, members)."""
        products = rows.take(self.rows, axis=0)
        products *= inverse
        return np.asarray(self.sums @ products)

    def turns(self, inverse: Array, along: Array) -> Array:
        """|X C_b(p)| of each block, shape (blocks, members).

        Args:
            inverse: entries of X. along: entries of C_u(p), shape (entries, members).
        """
        total = self._products(inverse, along)
        return self.by_block(self.by_row @ np.abs(total, out=total))

    def defect(self, inverse: Array, jacobian: Array, doubt: Array) -> Array:
        """|I - X C_b| of each block, at most, shape (blocks, members).

        Args:
            inverse: entries of X. jacobian: of C_u, and how far they may be off, (entries, members).
        """
        total = self._products(inverse, jacobian)
        total -= self.diagonal[:, None]
        # A sum of so many products, and the 1 taken from it.
        gamma = (len(self.layers) + 2) * UNIT_ROUNDOFF
        rounded = self._products(np.abs(inverse), gamma * np.abs(jacobian) + doubt)
        rounded += np.abs(total, out=total)
        rounded += UNIT_ROUNDOFF * self.diagonal[:, None]
        return self.by_block(self.by_row @ rounded)

    def _products(self, inverse: Array, entries: Array) -> Array:
        """The sums (X C_b)_ij that are not zero by their pattern, shape (sums, members)."""
        one, other = self.factors
        products = inverse.take(one, axis=0)
        products *= entries.take(other, axis=0)
        total, first = products[: self.layers[0]], self.layers[0]
        for count in self.layers[1:]:
            total[:count] += products[first : first + count]
            first += count
        return total

    def largest(self, values: Array) -> Array:
        """Norm of the unknowns of each block, shape (blocks, members)."""
        return self.by_block(np.abs(values) / self.weights[:, None])

    def by_block(self, values: Array) -> Array:
        """The largest number of each block, shape (blocks, members)."""
        largest = np.empty((len(self.couplings), values.shape[-1]))
        for coupling, out in zip(self.couplings, largest, strict=True):
            own = values.take(coupling.unknowns, axis=0)
            own.max(axis=0, out=out)
        return largest

    def radii(
        self, inverse: Array, omega: Array, missed: Array, turns: Array, jacobian: Array
    ) -> tuple[Array, Array]:
        """R_b and z of each block, shape (blocks, members); R_b is infinite where a block is not proven.

        Args:
            inverse: magnitudes of the entries of X. omega: of each block.
            missed: |X C_b(y + p)| by weights, shape (unknowns, members). turns: |X C_b(p)| of each block.
            jacobian: magnitudes of the entries of C_u(y + p), at most.
        """
        found, turned = np.zeros_like(omega), np.empty_like(omega)
        for number, c in enumerate(self.couplings):
            eta, z = missed.take(c.unknowns, axis=0), turns[number]
            if len(c.entries):
                mine = inverse[c.mine]
                rows = c.by_row @ (jacobian.take(c.entries, axis=0) * found.take(c.blocks, axis=0))
                if len(c.pairs[0]):
                    rows += c.bending @ (found.take(c.pairs[0], axis=0) * found.take(c.pairs[1], axis=0))
                eta += c.sums @ (mine * rows.take(c.inverse_rows, axis=0))
                extra = (c.turning @ found).take(c.inverse_rows, axis=0)
                z = z + (c.sums @ (mine * extra)).max(axis=0)
            turned[number] = z
            found[number] = kantorovich_radius(eta.max(axis=0), z, omega[number])
        return found, turned


def kantorovich_radius(eta: Array, z: Array, omega: Array) -> Array:
    """2 eta / ((1 - z)(1 + sqrt(1 - h))); infinite where nothing is proven."""
    room = 1.0 - z
    constant = 2.0 * omega * eta / (room * room)
    radius = 2.0 * eta / (room * (1.0 + np.sqrt(np.maximum(1.0 - constant, 0.0))))
    return np.where((room > 0.0) & (constant < 1.0), radius, np.inf)


def block_proof(columns: ColumnMap, plan: Elimination, structure: Structure, g: Array) -> BlockProof:
    """How the constants are summed for matrices of a pattern and their blocks, with weights g."""
    table, first, second = columns.system.curvature
    magnitude = np.abs(table) * (g[first] * g[second])
    n, blocks = columns.unknowns, structure.blocks
    block_of = {unknown: number for number, block in enumerate(blocks) for unknown in block.unknowns}
    row_block = {row: number for number, block in enumerate(blocks) for row in block.rows}
    owner = np.array([block_of[i] for i in range(n)])
    one, other = owner[first], owner[second]
    entries = plan.inverse_program.entries
    sums = np.zeros((n, len(entries)))
    sums[[i for i, _ in entries], np.arange(len(entries))] = [1.0 / g[i] for i, _ in entries]
    rows = np.array([row for _, row in entries], dtype=np.intp)
    of_row = np.array([row_block[row] for row in range(len(table))])
    own = (one == of_row[:, None]) & (other == of_row[:, None])
    couplings = []
    low = 0
    for number, block in enumerate(blocks):
        mine = [place for place, (i, _) in enumerate(entries) if block_of[i] == number]
        if mine != list(range(low, low + len(mine))):
            raise ValueError("the inverse's entries are not sorted by blocks")
        inside = {row: place for place, row in enumerate(block.rows)}
        unknown_place = {unknown: place for place, unknown in enumerate(block.unknowns)}
        outside = [
            (place, row, column)
            for place, (row, column) in enumerate(plan.entries)
            if row in inside and block_of[column] != number
        ]
        by_row = np.zeros((len(block.rows), len(outside)))
        for place, (_, row, column) in enumerate(outside):
            by_row[inside[row], place] = g[column]
        of_block = magnitude[list(block.rows)]
        turning = np.zeros((len(block.rows), len(blocks)))
        for earlier in range(len(blocks)):
            if earlier != number:
                turning[:, earlier] = of_block[:, (one == number) & (other == earlier)].sum(axis=-1)
        bending: dict[tuple[int, int], Array] = {}
        for place in np.flatnonzero((one != number) & (other != number) & of_block.any(axis=0)).tolist():
            pair = (int(min(one[place], other[place])), int(max(one[place], other[place])))
            bending[pair] = bending.get(pair, np.zeros(len(block.rows))) + 0.5 * of_block[:, place]
        block_sums = np.zeros((len(block.unknowns), len(mine)))
        for place, entry in enumerate(mine):
            unknown = entries[entry][0]
            block_sums[unknown_place[unknown], place] = 1.0 / g[unknown]
        couplings.append(
            _Coupling(
                rows=np.array(block.rows, dtype=np.intp),
                mine=slice(low, low + len(mine)),
                unknowns=np.array(block.unknowns, dtype=np.intp),
                entries=np.array([place for place, _, _ in outside], dtype=np.intp),
                blocks=np.array([block_of[column] for _, _, column in outside], dtype=np.intp),
                by_row=by_row,
                turning=turning,
                bending=np.array(list(bending.values())).reshape(-1, len(block.rows)).T.copy(),
                pairs=(
                    np.array([a for a, _ in bending], dtype=np.intp),
                    np.array([b for _, b in bending], dtype=np.intp),
                ),
                inverse_rows=np.array([inside[entries[entry][1]] for entry in mine], dtype=np.intp),
                sums=block_sums,
            )
        )
        low += len(mine)
    factors, layers, by_unknown, diagonal = _products(plan, entries, block_of, g)
    return BlockProof(
        tuple(couplings),
        rows,
        sums,
        (magnitude * own).sum(axis=-1)[rows],
        magnitude.sum(axis=-1)[rows],
        factors,
        layers,
        by_unknown,
        diagonal,
        g,
    )


def _products(
    plan: Elimination, entries: tuple[tuple[int, int], ...], block_of: dict[int, int], g: Array
) -> tuple[tuple[Indices, Indices], tuple[int, ...], Array, Array]:
    """The products in X C_b(p), in layers."""
    in_row: dict[int, list[tuple[int, int]]] = {}
    for place, (row, column) in enumerate(plan.entries):
        in_row.setdefault(row, []).append((place, column))
    found: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for number, (i, row) in enumerate(entries):
        for place, column in in_row.get(row, ()):
            if block_of[column] == block_of[i]:
                found.setdefault((i, column), []).append((number, place))
    by_length = sorted(found.items(), key=lambda each: -len(each[1]))
    longest = max(len(products) for products in found.values())
    layers = [
        [products[place] for _, products in by_length if len(products) > place] for place in range(longest)
    ]
    flat = np.array([product for layer in layers for product in layer], dtype=np.intp)
    by_row = np.zeros((len(g), len(by_length)))
    for place, ((i, j), _) in enumerate(by_length):
        by_row[i, place] = g[j] / g[i]
    diagonal = np.array([float(i == j) for (i, j), _ in by_length])
    return (flat[:, 0].copy(), flat[:, 1].copy()), tuple(len(layer) for layer in layers), by_row, diagonal
