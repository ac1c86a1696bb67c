r"""Power series of many members at once, a member a column: `power_series.expand` with the batch last.

    C_u u_k = -( C_w w_k + sum_{0<i<k} B(y_i, y_{k-i}) ),     k = 1, 2, 3, ...

Each sum over the orders is one call for all terms and members; terms whose factors do not both move drop out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.batch_last.column_map import ColumnMap, Convolution
from pointcoord.numerics.batch_last.elimination import BlockSolver, Eliminated

Array = NDArray[np.float64]


@dataclass
class ColumnSeries:
    """Series of all coordinates about a pose of each member, which can be carried on.

    Attributes:
        rows: the map. convolution: its terms of which both factors move.
        factors: of C_u at the pose.
        driving: by coordinate that is driven which rows of C_w it enters, and these, each (rows, members).
        y: coefficients, shape (orders, size, members), of which `count` are known.
        squares, left, right: differences of them, by term.
    """

    rows: ColumnMap
    convolution: Convolution
    factors: BlockSolver
    driving: list[tuple[int, NDArray[np.intp], Array]]
    y: Array
    squares: Array
    left: Array
    right: Array
    count: int

    @classmethod
    def begin(
        cls,
        rows: ColumnMap,
        factors: Eliminated,
        y: Array,
        driven: list[int],
        most: int,
        spare: ColumnSeries | None = None,
        follows: NDArray[np.bool_] | None = None,
    ) -> ColumnSeries:
        """The pose itself, with room for so many orders.

        Args:
            y: coordinates, shape (size, members). driven: the known coordinates that move.
            spare: a series that is not carried on any more; its room is used again if it suits.
            follows: the unknowns that move with these, shape (unknowns,); all if not given.
        """
        size, members = y.shape
        first, second = rows.ends
        moving = np.zeros(size, dtype=bool)
        moving[: rows.unknowns] = True if follows is None else follows
        moving[driven] = True
        convolution = rows.convolution.of_moving(moving[first] | moving[second])
        d = rows.differences(y)
        driving = []
        for coordinate in driven:
            unit = np.zeros((size, 1))
            unit[coordinate] = 1.0
            along = rows.derivative(d, np.broadcast_to(rows.differences(unit), d.shape))
            enters = np.flatnonzero(along.any(axis=-1))
            driving.append((coordinate, enters, along[enters]))
        series = np.zeros((most + 1, size, members))
        series[0] = y
        shapes = (len(convolution.squares), len(convolution.left), len(convolution.left))
        rooms = (None,) * 3 if spare is None else (spare.squares, spare.left, spare.right)
        squares, left, right = (
            room
            if room is not None and room.shape[0] > most and room.shape[1:] == (count, members)
            else np.empty((most + 1, count, members))
            for count, room in zip(shapes, rooms, strict=True)
        )
        return cls(rows, convolution, BlockSolver.of(factors), driving, series, squares, left, right, 1)

    def longer(self, most: int) -> None:
        """Make room for more orders."""
        more = most + 1 - len(self.y)
        if more > 0:
            self.y = np.concatenate([self.y, np.zeros((more, *self.y.shape[1:]))])
        self.squares, self.left, self.right = (
            room
            if len(room) > most
            else np.concatenate([room, np.empty((most + 1 - len(room), *room.shape[1:]))])
            for room in (self.squares, self.left, self.right)
        )

    def sums(self, k: int) -> Array:
        """sum B(y_i, y_{k-i}) over 0 < i < k, i and k - i among the known orders, shape (rows, members)."""
        low, high = max(1, k - self.count + 1), min(self.count - 1, k - 1)
        count = len(self.convolution.squares)
        products = np.empty((count + len(self.convolution.left), self.y.shape[-1]))
        middle = (k + 1) // 2
        if low < middle:
            upper = slice(k - low, k - middle, -1)
            np.einsum("itb,itb->tb", self.squares[low:middle], self.squares[upper], out=products[:count])
            products[:count] *= 2.0
        else:
            products[:count] = 0.0
        if k % 2 == 0 and k // 2 <= high:
            products[:count] += self.squares[k // 2] ** 2
        if low <= high:
            last = k - high - 1
            upper = slice(k - low, None if last < 0 else last, -1)
            np.einsum("itb,itb->tb", self.left[low : high + 1], self.right[upper], out=products[count:])
        else:
            products[count:] = 0.0
        return np.asarray(self.convolution.sums @ products)

    def carry_on(self, known: Array, extra: Array | None = None) -> None:
        """One more order.

        Args:
            known: coefficients of the driven coordinates, shape (driven,) or (driven, members).
            extra: what the rows are to be of this order, shape (rows, members); zero unless given.
        """
        k, n = self.count, self.rows.unknowns
        right = np.zeros((n, self.y.shape[-1])) if k == 1 else self.sums(k)
        for (coordinate, enters, rows), value in zip(self.driving, known, strict=True):
            self.y[k, coordinate] = value
            right[enters] += rows * value
        if extra is not None:
            right -= extra
        self.factors.solve(np.negative(right, out=right), self.y[k, :n])
        self._remember(k)
        self.count = k + 1

    def _remember(self, k: int) -> None:
        first, second = self.rows.ends
        y, c = self.y[k], self.convolution
        for places, kept in ((c.squares, self.squares), (c.left, self.left), (c.right, self.right)):
            np.take(y, first[places], axis=0, out=kept[k], mode="clip")
            kept[k] -= y.take(second[places], axis=0)

    def at(self, s: Array | float) -> Array:
        """The sum at s, shape (size, members)."""
        total = self.y[self.count - 1].copy()
        for k in range(self.count - 2, -1, -1):
            total *= s
            total += self.y[k]
        return np.asarray(total)
