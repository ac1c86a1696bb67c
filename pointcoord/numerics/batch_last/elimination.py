r"""Gaussian elimination of many small sparse matrices at once, a member a column.

The pattern of the matrix is the same for all members, so the pivots are chosen once, by one member's numbers:
of the entries that are at least a tenth of the largest of their column, the one that fills in least
(Markowitz). What is left is a list of operations on rows of members, each one numpy call. By a block
triangular pattern it stays block triangular: no multiplier joins two blocks but those that do.

Nothing keeps another member's pivots large. Its multipliers show it: they are at most 10 for the member that
the pivots were chosen by, and whoever has one beyond `LARGEST_MULTIPLIER`, or a pivot of zero, is marked and
must be solved by LAPACK. Up to there elimination loses at most some three digits more than by the best pivots
(Higham, Accuracy and Stability of Numerical Algorithms, ch. 9: the backward error grows with the entries on
the way), and whatever it gives is checked by the residual of what was solved for.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.numerics.structure import Block

Array = NDArray[np.float64]
Entry = tuple[int, int]

THRESHOLD = 0.1
LARGEST_MULTIPLIER = 1e3


@dataclass(frozen=True)
class Pivot:
    """One pivot: its row and column, the rows below that it clears, and its row's other entries."""

    row: int
    column: int
    below: tuple[int, ...]
    across: tuple[int, ...]


@dataclass(frozen=True)
class Level:
    """Blocks that can be solved at once, after those of earlier levels.

    Attributes:
        rows, unknowns: of the blocks. inverse: which entries of the inverse are theirs, and their row,
            counted among the rows; sums: 1 where one is of an unknown, (unknowns, entries).
        outside: entries of the matrix that the rows have in earlier unknowns, and these; taken: 1 where such
            an entry is of a row, (rows, entries).
    """

    rows: NDArray[np.intp]
    unknowns: NDArray[np.intp]
    inverse: NDArray[np.intp]
    inverse_rows: NDArray[np.intp]
    sums: Array
    outside: NDArray[np.intp]
    earlier: NDArray[np.intp]
    taken: Array


@dataclass(frozen=True)
class Elimination:
    """How matrices of one pattern are eliminated; make one with `eliminate_like`.

    Attributes:
        size: of the matrices. entries: where they may be other than zero. pivots: in order.
        blocks: unknowns of each diagonal block.
    """

    size: int
    entries: tuple[Entry, ...]
    pivots: tuple[Pivot, ...]
    blocks: tuple[tuple[int, ...], ...]

    @cached_property
    def places(self) -> dict[Entry, int]:
        """The row of the work array of each entry and of what is filled in."""
        places = {entry: number for number, entry in enumerate(self.entries)}
        for pivot in self.pivots:
            for row in pivot.below:
                for column in pivot.across:
                    places.setdefault((row, column), len(places))
        return places

    @cached_property
    def _steps(self) -> tuple[tuple[int, tuple[int, ...], tuple[tuple[int, int, int], ...]], ...]:
        """Of each pivot its place, those of the multipliers, and updates as (changed, multiplier, other)."""
        place = self.places
        return tuple(
            (
                place[p.row, p.column],
                tuple(place[row, p.column] for row in p.below),
                tuple(
                    (place[row, column], place[row, p.column], place[p.row, column])
                    for row in p.below
                    for column in p.across
                ),
            )
            for p in self.pivots
        )

    @cached_property
    def _multipliers(self) -> NDArray[np.intp]:
        return np.array([place for _, multipliers, _ in self._steps for place in multipliers], dtype=np.intp)

    @cached_property
    def parity(self) -> float:
        """Sign of the permutation that the pivots are."""
        columns = [0] * self.size
        for pivot in self.pivots:
            columns[pivot.row] = pivot.column
        sign, seen = 1.0, [False] * self.size
        for first in range(self.size):
            length, at = 0, first
            while not seen[at]:
                seen[at], at, length = True, columns[at], length + 1
            sign *= -1.0 if length and length % 2 == 0 else 1.0
        return sign

    def factorise(self, entries: Array) -> Eliminated:
        """Eliminate matrices of these entries, shape (entries, members)."""
        members = entries.shape[-1]
        work = np.zeros((len(self.places), members))
        work[: len(entries)] = entries
        rows, inverse, spare = list(work), np.empty((self.size, members)), np.empty(members)
        with np.errstate(all="ignore"):
            for reciprocal, (pivot, multipliers, updates) in zip(inverse, self._steps, strict=True):
                np.divide(1.0, rows[pivot], out=reciprocal)
                for place in multipliers:
                    np.multiply(rows[place], reciprocal, out=rows[place])
                for changed, multiplier, other in updates:
                    np.multiply(rows[multiplier], rows[other], out=spare)
                    np.subtract(rows[changed], spare, out=rows[changed])
            largest = np.abs(work.take(self._multipliers, axis=0)).max(axis=0, initial=0.0)
            sound = (largest <= LARGEST_MULTIPLIER) & np.isfinite(inverse).all(axis=0)
        return Eliminated(self, entries, work, inverse, sound)

    @cached_property
    def _down(self) -> tuple[tuple[int, int, int], ...]:
        """Updates of a right-hand side: row, multiplier, pivot row."""
        return tuple((row, self.places[row, p.column], p.row) for p in self.pivots for row in p.below)

    @cached_property
    def levels(self) -> tuple[Level, ...]:
        """Blocks that hang on earlier ones only, level after level."""
        block_of = {unknown: number for number, block in enumerate(self.blocks) for unknown in block}
        row_block = {pivot.row: block_of[pivot.column] for pivot in self.pivots}
        depth = [0] * len(self.blocks)
        for number in range(len(self.blocks)):
            hangs = [block_of[j] for i, j in self.entries if row_block[i] == number and block_of[j] != number]
            depth[number] = max((depth[other] + 1 for other in hangs), default=0)
        inverse = self.inverse_program.entries
        found = []
        for level in range(max(depth) + 1):
            rows = [pivot.row for pivot in self.pivots if depth[row_block[pivot.row]] == level]
            unknowns = [unknown for unknown in range(self.size) if depth[block_of[unknown]] == level]
            own = [place for place, (i, _) in enumerate(inverse) if i in unknowns]
            outside = [
                place
                for place, (i, j) in enumerate(self.entries)
                if i in rows and block_of[j] != row_block[i]
            ]
            sums = np.zeros((len(unknowns), len(own)))
            sums[[unknowns.index(inverse[place][0]) for place in own], np.arange(len(own))] = 1.0
            taken = np.zeros((len(rows), len(outside)))
            taken[[rows.index(self.entries[place][0]) for place in outside], np.arange(len(outside))] = 1.0
            found.append(
                Level(
                    np.array(rows, dtype=np.intp),
                    np.array(unknowns, dtype=np.intp),
                    np.array(own, dtype=np.intp),
                    np.array([rows.index(inverse[place][1]) for place in own], dtype=np.intp),
                    sums,
                    np.array(outside, dtype=np.intp),
                    np.array([self.entries[place][1] for place in outside], dtype=np.intp),
                    taken,
                )
            )
        return tuple(found)

    @cached_property
    def inverse_program(self) -> InverseProgram:
        """How the inverses of the diagonal blocks are made."""
        return InverseProgram.of(self)


@dataclass(frozen=True)
class Eliminated:
    """Factors of many matrices.

    Attributes:
        entries: of the matrices, shape (entries, members).
        rows: of the entries, multipliers below the pivots, shape (places, members).
        reciprocals: of the pivots, in their order, shape (size, members).
        sound: members for which the pivots were good, shape (members,).
    """

    plan: Elimination
    entries: Array
    rows: Array
    reciprocals: Array
    sound: NDArray[np.bool_]

    @cached_property
    def orientation(self) -> Array:
        """Sign of the determinant, shape (members,)."""
        negative = np.count_nonzero(self.reciprocals < 0.0, axis=0)
        return np.asarray(self.plan.parity * np.where(negative % 2 == 0, 1.0, -1.0))

    @cached_property
    def _views(self) -> list[Array]:
        return list(self.rows)

    def solve(self, right: Array, out: Array | None = None) -> Array:
        """x with matrix x = right, shapes (size, members); the right-hand side is used up."""
        x = np.empty_like(right) if out is None else out
        factors, rows, columns = self._views, list(right), list(x)
        spare = np.empty(right.shape[-1])
        with np.errstate(all="ignore"):
            for changed, multiplier, other in self.plan._down:
                np.multiply(factors[multiplier], rows[other], out=spare)
                np.subtract(rows[changed], spare, out=rows[changed])
            places = self.plan.places
            for number in range(self.plan.size - 1, -1, -1):
                pivot = self.plan.pivots[number]
                row = rows[pivot.row]
                for column in pivot.across:
                    np.multiply(factors[places[pivot.row, column]], columns[column], out=spare)
                    np.subtract(row, spare, out=row)
                np.multiply(row, self.reciprocals[number], out=columns[pivot.column])
        return x

    def inverse(self) -> Array:
        """The entries of the inverses of the diagonal blocks, as the plan's program has them."""
        return self.plan.inverse_program.run(self)


@dataclass(frozen=True)
class BlockSolver:
    """The inverses of the diagonal blocks, for many right-hand sides: a few operations on all blocks of a
    level.

    Attributes:
        inverse, outside: by level, entries of the inverses and of the matrix in earlier unknowns.
    """

    plan: Elimination
    inverse: tuple[Array, ...]
    outside: tuple[Array, ...]

    @classmethod
    def of(cls, factors: Eliminated) -> BlockSolver:
        """Of factors."""
        inverse, levels = factors.inverse(), factors.plan.levels
        return cls(
            factors.plan,
            tuple(inverse.take(level.inverse, axis=0) for level in levels),
            tuple(factors.entries.take(level.outside, axis=0) for level in levels),
        )

    def solve(self, right: Array, out: Array) -> Array:
        """x with matrix x = right, shapes (size, members)."""
        for level, inverse, outside in zip(self.plan.levels, self.inverse, self.outside, strict=True):
            rows = right.take(level.rows, axis=0)
            if len(level.outside):
                known = out.take(level.earlier, axis=0)
                known *= outside
                rows -= level.taken @ known
            products = rows.take(level.inverse_rows, axis=0)
            products *= inverse
            out[level.unknowns] = level.sums @ products
        return out


def eliminate_like(matrix: Array, entries: Sequence[Entry], blocks: Sequence[Block]) -> Elimination | None:
    """Choose pivots for matrices of a pattern by one of them, shape (size, size); None if it is singular.

    Args:
        blocks: of the pattern; every pivot lies in one.
    """
    inside = {(row, column) for block in blocks for row in block.rows for column in block.unknowns}
    size = len(matrix)
    a = matrix / np.abs(matrix).max(axis=1, keepdims=True)
    filled, rows, columns = set(entries), set(range(size)), set(range(size))
    pivots = []
    for _ in range(size):
        in_row = {i: [j for j in columns if (i, j) in filled] for i in rows}
        in_column = {j: [i for i in rows if (i, j) in filled] for j in columns}
        largest = {
            j: max((abs(a[i, j]) for i in in_column[j] if (i, j) in inside), default=0.0) for j in columns
        }
        options = [
            ((len(in_row[i]) - 1) * (len(in_column[j]) - 1), -abs(a[i, j]) / largest[j], i, j)
            for i in sorted(rows)
            for j in in_row[i]
            if (i, j) in inside and abs(a[i, j]) >= THRESHOLD * largest[j] > 0.0
        ]
        if not options:
            return None
        _, _, row, column = min(options)
        rows.discard(row)
        columns.discard(column)
        below = tuple(i for i in in_column[column] if i != row)
        across = tuple(j for j in in_row[row] if j != column)
        for i in below:
            a[i, list(across)] -= a[i, column] / a[row, column] * a[row, list(across)]
            filled.update((i, j) for j in across)
        pivots.append(Pivot(row, column, below, across))
    return Elimination(size, tuple(entries), tuple(pivots), tuple(block.unknowns for block in blocks))


# What an operation of an inverse's program does with its result, a factor f and an earlier result x.
_MINUS, _LESS, _MINUS_PRODUCT, _LESS_PRODUCT, _ONE_LESS_PRODUCT, _RECIPROCAL, _SCALED = range(7)
_ONE = -1


@dataclass(frozen=True)
class InverseProgram:
    """Operations that make the inverses of the diagonal blocks column by column, without those on zeros.

    Attributes:
        entries: row and column of each entry of the inverses that may be other than zero, block by block.
        operations: kind, result, factor (or pivot), other result.
        registers: how many results there are; the entries of the inverse are the first.
    """

    entries: tuple[Entry, ...]
    operations: tuple[tuple[int, int, int, int], ...]
    registers: int

    @classmethod
    def of(cls, plan: Elimination) -> InverseProgram:
        """Of an elimination."""
        operations: list[tuple[int, int, int, int]] = []
        entries: list[Entry] = []
        place = plan.places
        count = 0
        # Registers are numbered as they come; entries get theirs at the end.
        final: dict[int, int] = {}
        units = [
            (pivot.row, block) for block in plan.blocks for pivot in plan.pivots if pivot.column in block
        ]
        for unit, block in units:
            y: dict[int, int] = {unit: _ONE}
            pivots = [(number, pivot) for number, pivot in enumerate(plan.pivots) if pivot.column in block]
            inside = {pivot.row for _, pivot in pivots}
            for _, pivot in pivots:
                own = y.get(pivot.row)
                if own is None:
                    continue
                for row in (row for row in pivot.below if row in inside):
                    factor, old = place[row, pivot.column], y.get(row)
                    if old is None:
                        y[row] = count
                        operations.append((_MINUS if own == _ONE else _MINUS_PRODUCT, count, factor, own))
                        count += 1
                    else:
                        operations.append((_LESS if own == _ONE else _LESS_PRODUCT, old, factor, own))
            x: dict[int, int] = {}
            for number, pivot in reversed(pivots):
                total = y.get(pivot.row)
                for column in pivot.across:
                    if column not in x:
                        continue
                    factor = place[pivot.row, column]
                    if total is None or total == _ONE:
                        kind = _MINUS_PRODUCT if total is None else _ONE_LESS_PRODUCT
                        operations.append((kind, count, factor, x[column]))
                        total, count = count, count + 1
                    else:
                        operations.append((_LESS_PRODUCT, total, factor, x[column]))
                if total is not None:
                    kind = _RECIPROCAL if total == _ONE else _SCALED
                    operations.append((kind, count, number, total))
                    final[count] = len(entries)
                    entries.append((pivot.column, unit))
                    x[pivot.column], count = count, count + 1
        spare = iter(range(len(entries), count))
        renumbered = {old: final[old] if old in final else next(spare) for old in range(count)} | {_ONE: _ONE}
        return cls(
            tuple(entries),
            tuple((kind, renumbered[out], factor, renumbered[x]) for kind, out, factor, x in operations),
            count,
        )

    def run(self, factors: Eliminated) -> Array:
        """The entries of the inverses, shape (entries, members)."""
        members = factors.rows.shape[-1]
        results = np.empty((self.registers, members))
        rows, f, reciprocals = list(results), list(factors.rows), factors.reciprocals
        spare = np.empty(members)
        with np.errstate(all="ignore"):
            for kind, out, factor, x in self.operations:
                result = rows[out]
                if kind == _LESS_PRODUCT:
                    np.multiply(f[factor], rows[x], out=spare)
                    np.subtract(result, spare, out=result)
                elif kind == _SCALED:
                    np.multiply(reciprocals[factor], rows[x], out=result)
                elif kind == _MINUS_PRODUCT:
                    np.multiply(f[factor], rows[x], out=result)
                    np.negative(result, out=result)
                elif kind == _ONE_LESS_PRODUCT:
                    np.multiply(f[factor], rows[x], out=result)
                    np.subtract(1.0, result, out=result)
                elif kind == _MINUS:
                    np.negative(f[factor], out=result)
                elif kind == _LESS:
                    np.subtract(result, f[factor], out=result)
                else:
                    result[:] = reciprocals[factor]
        return results[: len(self.entries)]
