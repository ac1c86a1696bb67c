r"""Power series in two parameters of many members at once, a member a column.

    C_u u_ij = -( C_w w_ij + sum B(y_ab, y_{i-a, j-b}) ),     (0, 0) < (a, b) < (i, j).

The powers of each parameter alone are a series of its own (see `series`). Powers of both have known
coordinates only in what these two leave, and unknowns only in blocks that both parameters move; those of one
degree are solved at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.batch_last.column_map import ColumnMap
from pointcoord.numerics.batch_last.elimination import BlockSolver, Eliminated
from pointcoord.numerics.batch_last.series import ColumnSeries

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass
class MixedSeries:
    """The powers of both of two parameters, which can be carried on.

    Attributes:
        rows: the map. one, other: the series in each parameter alone, carried on before this.
        solver: of the blocks that both move. unknowns: of these.
        sums: columns of Q, for the squares and then for the other products.
        squares, left, right: differences of the powers s^i t^j, shape (i, j, terms, members).
        ends: of each kind of difference its first and second coordinate.
        places: of each coordinate its place among the unknowns; the last for those that are none of them.
        y: of each degree from 2 the coefficients of s^(k-1) t, s^(k-2) t^2, ..., and zeros last,
            (unknowns + 1, k - 1, members).
    """

    rows: ColumnMap
    one: ColumnSeries
    other: ColumnSeries
    solver: BlockSolver
    unknowns: Indices
    sums: Array
    squares: Array
    left: Array
    right: Array
    ends: tuple[tuple[Indices, Indices], ...]
    places: Indices
    y: list[Array]

    @classmethod
    def begin(
        cls,
        rows: ColumnMap,
        factors: Eliminated,
        one: ColumnSeries,
        other: ColumnSeries,
        moves: tuple[NDArray[np.bool_], NDArray[np.bool_]],
        most: int,
        spare: MixedSeries | None = None,
    ) -> MixedSeries:
        """Nothing yet, with room for so many degrees.

        Args:
            moves: the coordinates that each parameter moves, shape (size,).
            spare: one that is not carried on any more; its room is used again if it suits.
        """
        members, n = one.y.shape[-1], rows.unknowns
        both = moves[0] & moves[1]
        unknowns = np.flatnonzero(both[:n])
        first, second = rows.ends
        with_one, with_other = (move[first] | move[second] for move in moves)
        whole = rows.convolution
        squares = (with_one & with_other)[whole.squares]
        left, right = whole.left, whole.right
        pairs = (with_one[left] & with_other[right]) | (with_other[left] & with_one[right])
        kinds = (whole.squares[squares], left[pairs], right[pairs])
        rooms: list[Array] = []
        kept = (None,) * 3 if spare is None else (spare.squares, spare.left, spare.right)
        for places, room in zip(kinds, kept, strict=True):
            shape = (most + 1, most + 1, len(places), members)
            rooms.append(room if room is not None and room.shape == shape else np.empty(shape))
            # What is not known yet meets the pose itself in a sum, and the pose counts nothing.
            rooms[-1].fill(0.0)
        places = np.full(len(both), len(unknowns), dtype=np.intp)
        places[unknowns] = np.arange(len(unknowns))
        return cls(
            rows,
            one,
            other,
            BlockSolver.of(factors, frozenset(unknowns.tolist())),
            unknowns,
            np.ascontiguousarray(whole.sums[:, np.concatenate([squares, pairs])]),
            rooms[0],
            rooms[1],
            rooms[2],
            tuple((first[kind], second[kind]) for kind in kinds),
            places,
            [],
        )

    def carry_on(self) -> None:
        """One more degree, up to which the series of each parameter alone are known."""
        k, members = len(self.y) + 2, self.one.y.shape[-1]
        for degree in (1, k) if k == 2 else (k,):
            self._remember_alone(degree)
        squares, left = self.squares.shape[2], self.left.shape[2]
        products = np.zeros((squares + left, k - 1, members))
        for place, j in enumerate(range(1, k)):
            if squares:
                _add_squares(self.squares, k - j, j, products[:squares, place])
            if left:
                one = self.left[: k - j + 1, : j + 1]
                other = self.right[k - j :: -1, j::-1]
                np.einsum("abtm,abtm->tm", one, other, out=products[squares:, place])
        flat = products.reshape(len(products), -1)
        right = (self.sums @ flat).reshape(-1, k - 1, members)
        found = np.zeros((self.rows.unknowns, k - 1, members))
        self.solver.solve_many(np.negative(right, out=right), found)
        own = np.zeros((len(self.unknowns) + 1, k - 1, members))
        own[:-1] = found.take(self.unknowns, axis=0)
        for (first, second), room in zip(self.ends, (self.squares, self.left, self.right), strict=True):
            d = own.take(self.places[first], axis=0)
            d -= own.take(self.places[second], axis=0)
            for place, j in enumerate(range(1, k)):
                room[k - j, j] = d[:, place]
        self.y.append(own)

    def _remember_alone(self, degree: int) -> None:
        for (first, second), room in zip(self.ends, (self.squares, self.left, self.right), strict=True):
            for series, here in ((self.one, room[degree, 0]), (self.other, room[0, degree])):
                y = series.y[degree]
                np.take(y, first, axis=0, out=here, mode="clip")
                here -= y.take(second, axis=0)


def _add_squares(d: Array, i: int, j: int, out: Array) -> None:
    """Add sum d_ab d_{i-a, j-b}: half of it, and what is its own other half."""
    if i < j:
        d, i, j = d.swapaxes(0, 1), j, i
    middle = (i + 1) // 2
    np.einsum("abtm,abtm->tm", d[:middle, : j + 1], d[i : i - middle : -1, j::-1], out=out)
    out *= 2.0
    if i % 2 == 0:
        row = d[i // 2]
        middle = (j + 1) // 2
        if middle:
            out += 2.0 * np.einsum("btm,btm->tm", row[:middle], row[j : j - middle : -1])
        if j % 2 == 0:
            out += row[j // 2] ** 2
