r"""Many instants close together: the rows of a table as polynomials in cells, by one matrix product.

A cell is a stretch of consecutive instants inside one series, so short that every number is a polynomial of
degree `DEGREE` there, to rounding. Its numbers are computed by the plain formulas (series, effects) at that
many and one more Chebyshev points, and all instants of the cell take

    rows = [coefficients, directions] [s^n .. s^0, laws of the chassis],

a product whose result is written where it belongs. What is made of states, an angle or a turn, costs there
what a coordinate costs. A law of the chassis is taken at the instants themselves. Numbers are analytic in
a cell: where the second half of their coefficients is below `HALFWAY`, what lies beyond them is below the
square of that and more. A cell that is too long for that, or in which a rate grows from nothing, is halved;
where one of few instants still is, the plain formulas are left to do. How far a number is off is proven from
it (see `bounds`), however it was found.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange, SingularConfiguration
from pointcoord.numerics.chebyshev import interpolation
from pointcoord.numerics.rounding import EPS
from pointcoord.results.readout import ENOUGH
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import narrow_product
from pointcoord.solve.taylor import Chain

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Stretch = tuple[int, int]
"""Instants from a number to before another."""

# Three products make the powers up to it.
DEGREE = 8
# Instants of a cell: at most what keeps its powers in a second-level cache, at least what pays its points.
MOST, FEWEST = 4096, 128
# Of the largest number of its kind, what is none at all: rates that are solved for together share that much
# of each other's rounding.
SHARED = 8.0 * EPS
# Where a series starts, a number is off by a part of what it is there, be it small or nothing. A cell that
# lies nearer to the start than so many times half its length is good only if each of its numbers has so much
# of its largest size at the first instant already.
NEAR, BEGUN = 16.0, 0.5
# By how much of half a cell an instant may be rounded (see `Interpolation.chebyshev`).
ROUNDED = 2.0**-24
# Largest coefficient of the second half, of a number's size.
HALFWAY = 2.0**-30
# Instants whose cells are worked out together: their tables take some 4 MB at most.
TOGETHER = 2**16


@dataclass(frozen=True, eq=False)
class CloseInstants:
    """A way to fill a table where many instants lie close together.

    Attributes:
        solved: of one car, by a chain.
    """

    solved: SolvedScene
    chain: Chain

    def fill(self, times: Array, rows: Array) -> list[Stretch]:
        """Fill the columns of a table where it pays.

        Args:
            times: instants that do not decrease, (N,), s.
            rows: shape (height, N).
        Returns:
            The columns that are left, in order.
        """
        left: list[Stretch] = []
        for low in range(0, len(times), TOGETHER):
            here = slice(low, low + TOGETHER)
            left += [(low + a, low + b) for a, b in self._fill(times[here], rows[:, here])]
        return left

    def _fill(self, times: Array, rows: Array) -> list[Stretch]:
        filled = np.zeros(len(times), dtype=bool)
        if times[0] >= self.solved.start and times[-1] <= self.solved.stop:
            try:
                cells, still = self._longest(times), self.solved.readout.table.first_still
                laws = self._laws(times) if len(cells) else np.empty((0, 0))
                for low in range(0, laws.shape[1], MOST):
                    stand = rows[still:, low : low + MOST]
                    stand[...] = self._added[still:, -1:]
                    if len(laws):
                        stand += self._added[still:, :-1] @ laws[:, low : low + MOST]
                while len(cells):
                    good = self._apart(cells, times)
                    coefficients, fits = self._coefficients(cells[good], times)
                    good[good] = fits
                    self._sum(cells[good], coefficients[fits], times, laws, rows)
                    for low, high in cells[good].tolist():
                        filled[low:high] = True
                    low, high = cells[~good & (cells[:, 1] - cells[:, 0] >= 2 * FEWEST)].T
                    middle = (low + high) // 2
                    cells = np.stack([low, middle, middle, high], axis=-1).reshape(-1, 2)
            except (InputOutOfRange, SingularConfiguration):
                # At a point of a cell that may be no instant that was asked for.
                filled[:] = False
        edges = np.flatnonzero(np.diff(filled, prepend=True, append=True))
        return [(first, last) for first, last in edges.reshape(-1, 2).tolist()]

    def _longest(self, times: Array) -> Whole:
        """The longest cells, by their first instant and the one after the last, (cells, 2)."""
        edges = [0, *np.searchsorted(times, self._starts[1:], side="left").tolist(), len(times)]
        cells = [
            (low, min(low + MOST, last))
            for first, last in pairwise(edges)
            if last - first >= ENOUGH
            for low in range(first, last, MOST)
        ]
        return np.array(cells, dtype=np.intp).reshape(-1, 2)

    @cached_property
    def _starts(self) -> Array:
        return np.array([segment.start for segment in self.chain.segments])

    def _apart(self, cells: Whole, times: Array) -> NDArray[np.bool_]:
        """Whether rounding tells the instants of a cell apart."""
        middle, half = middle_and_half(cells, times)
        return np.asarray((half > 0.0) & (EPS * np.abs(middle) <= ROUNDED * half))

    def _near(self, cells: Whole, times: Array) -> NDArray[np.bool_]:
        """Whether a cell lies so near to the start of its series that a number may begin there."""
        middle, half = middle_and_half(cells, times)
        start = self._starts[np.searchsorted(self._starts, times[cells[:, 0]], side="right") - 1]
        return np.asarray(middle - start < NEAR * half)

    def _coefficients(self, cells: Whole, times: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Of powers, highest first, of the rows that are solved for or computed; and in which cells they fit.

        The largest comes last, so that a sum is rounded by the smaller ones' size until then.

        Returns:
            Shape (cells, rows, DEGREE + 1), and (cells,).
        """
        own, (middle, half) = interpolation(DEGREE), (each[:, None] for each in middle_and_half(cells, times))
        first, last = times[cells[:, :1]], times[cells[:, 1:] - 1]
        points = np.clip(middle + half * own.points, first, last)
        values = self._at_points(points.ravel())
        values = values.reshape(len(values), *points.shape)
        found = own.chebyshev(values, (points - middle) / half - own.points)
        rows, least, kinds = self._numbers
        largest, begun, later = (
            np.maximum.reduceat(np.abs(each).max(axis=-1), rows)
            for each in (values, values[..., :1], found[..., DEGREE // 2 + 1 :])
        )
        of_kind = np.zeros((kinds.max() + 1, len(cells)))
        np.maximum.at(of_kind, kinds, largest)
        size, none = np.maximum(largest, least[:, None]), SHARED * of_kind[kinds]
        fits = (later <= HALFWAY * size + none).all(axis=0)
        grown = (np.maximum(begun, least[:, None]) < BEGUN * size - none).any(axis=0)
        powers = np.moveaxis(found @ own.powers, 1, 0)[..., ::-1]
        return np.ascontiguousarray(powers), fits & ~(grown & self._near(cells, times))

    def _sum(self, cells: Whole, coefficients: Array, times: Array, laws: Array, rows: Array) -> None:
        """Fill the columns of cells, but for the chassis' points, by their coefficients and the laws."""
        matrices = np.concatenate([coefficients, np.empty((*coefficients.shape[:-1], len(laws)))], axis=-1)
        matrices[..., DEGREE] += self._added[: matrices.shape[1], -1]
        matrices[..., DEGREE + 1 :] = self._added[: matrices.shape[1], :-1]
        room = np.ones((matrices.shape[-1], MOST))
        for (low, high), middle, half, matrix in zip(
            cells.tolist(), *middle_and_half(cells, times), matrices, strict=True
        ):
            basis = room[:, : high - low]
            power = basis[DEGREE::-1]
            np.divide(times[low:high] - middle, half, out=power[1])
            for known in (1, 2, 4):
                np.multiply(power[1 : known + 1], power[known], out=power[known + 1 : 2 * known + 1])
            basis[DEGREE + 1 :] = laws[:, low:high]
            narrow_product(matrix, basis, rows[: len(matrix), low:high])

    def _laws(self, times: Array) -> Array:
        """The laws of the chassis at instants, a row for each derivative of each.

        Raises:
            InputOutOfRange: as `ChassisMotion.law`.
        """
        chassis, reported = self.solved.readout.chassis, self.solved.readout.table.reported
        laws = [chassis.law(name, times, reported[-1])[list(reported)] for name in chassis.functions]
        return np.concatenate(laws) if laws else np.empty((0, len(times)))

    def _at_points(self, points: Array) -> Array:
        """The rows that are solved for or computed, by the plain formulas, without what reporting adds."""
        table = self.solved.readout.table
        values = np.empty((table.height, len(points)))
        self.solved.fill_plainly(points, values, add=False)
        return values[: table.first_still]

    @cached_property
    def _numbers(self) -> tuple[Whole, Array, Whole]:
        """The first row of each number, a size below which it is small, and its kind, counted from 0.

        A vector is large or small as a whole, and an angle by the side of a radian; states are of a kind with
        others of their derivative.
        """
        table = self.solved.readout.table
        found = {row: (0.0, order) for (order, _), row in table.states.items() if row < table.first_still}
        kind = self.solved.readout.plan.derivative
        for effect in table.computed:
            for quantity in effect.quantities:
                size = 1.0 if quantity.unit == "rad" else 0.0
                for place in table.places[quantity.name].values():
                    found[place.start] = size, (kind := kind + 1)
        first = sorted(found)
        least, kinds = zip(*(found[row] for row in first), strict=True)
        return np.array(first, dtype=np.intp), np.array(least), np.array(kinds, dtype=np.intp)

    @cached_property
    def _added(self) -> Array:
        """What reporting adds to each row along each derivative of each law, and what stands.

        Shape (height, laws x derivatives + 1); zero in the rows that are computed.
        """
        readout, table = self.solved.readout, self.solved.readout.table
        count = len(table.reported)
        added = np.zeros((table.height, len(readout.chassis.functions) * count + 1))
        for (derivative, name), first in table.states.items():
            place = added[first : first + 3]
            for i, law in enumerate(readout.chassis.functions):
                place[:, i * count + table.reported.index(derivative)] = readout.chassis.directions[law]
            if derivative == 0:
                stands = readout.mechanism.drawn_places[name] if first >= table.first_still else 0.0
                place[:, -1] = readout.mechanism.origin + stands
        return added


def middle_and_half(cells: Whole, times: Array) -> tuple[Array, Array]:
    """Of cells: the middle, and half the length, s."""
    first, last = times[cells[:, 0]], times[cells[:, 1] - 1]
    middle = first + 0.5 * (last - first)
    return middle, np.maximum(middle - first, last - middle)
