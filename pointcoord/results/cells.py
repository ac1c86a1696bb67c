r"""Many instants close together: the rows of a table as polynomials in cells, by one matrix product.

A cell is a set of consecutive instants inside one series, so short that every number is a polynomial of
degree `DEGREE` in the cell, to rounding. The numbers are computed by the plain formulas (series, effects) at
DEGREE + 1 Chebyshev points. All instants of the cell then follow from one product,

    rows = [coefficients, directions] [s^n .. s^0, laws of the chassis],

which is written directly into the table. So an angle or another number computed from states costs no more
than a coordinate. The laws of the chassis are evaluated at the instants themselves. Numbers are analytic in
a cell: if the second half of their coefficients is below `HALFWAY`, the truncated terms are below the square
of `HALFWAY`. A cell that is too long for that, or in which a rate grows from zero, is halved. If a cell of
few instants still fails, the plain formulas are used. The error bound of a number is proven from the number
itself (see `bounds`), however the number was computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from pointcoord.errors import InputOutOfRange, SingularConfiguration
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.chebyshev import interpolation
from pointcoord.numerics.rounding import EPS
from pointcoord.results.readout import ENOUGH
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import narrow_product
from pointcoord.solve.taylor import Chain

Stretch = tuple[int, int]
"""The first instant, by number, and the one after the last."""

# Degree of the polynomials; three products make all powers up to 8.
DEGREE = 8
# Most instants of a cell, so that the powers stay in a second-level cache; and fewest instants for which the
# Chebyshev points pay.
MOST, FEWEST = 4096, 128
# A number below this share of the largest number of its kind counts as zero: rates that are solved for
# together share that much of each other's rounding error.
SHARED = 8.0 * EPS
# At the start of a series the error of a number is a share of its size there, and the number may be zero. So
# a cell nearer to the start than NEAR times half its length is good only if every number has, at the first
# instant of the cell, BEGUN times its largest size in the cell.
NEAR, BEGUN = 16.0, 0.5
# Largest rounding of an instant, as a share of half a cell (see `Interpolation.chebyshev`).
ROUNDED = 2.0**-24
# Limit of the coefficients of the second half, relative to the size of the number.
HALFWAY = 2.0**-30
# Instants whose cells are computed together: their tables take about 4 MB at most.
TOGETHER = 2**16


@dataclass(frozen=True, eq=False)
class CloseInstants:
    """Fills a table where many instants lie close together.

    Attributes:
        solved: scene of one car, solved by a chain.
        chain: the chain of series.
    """

    solved: SolvedScene
    chain: Chain

    def fill(self, times: Array, rows: Array) -> list[Stretch]:
        """Fill the columns of a table in cells, where cells pay.

        Args:
            times: instants that do not decrease, (N,), s.
            rows: the table, shape (height, N).
        Returns:
            The columns that are not filled, in order.
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
                # A Chebyshev point failed, which may be no requested instant: the plain formulas decide.
                filled[:] = False
        edges = np.flatnonzero(np.diff(filled, prepend=True, append=True))
        return [(first, last) for first, last in edges.reshape(-1, 2).tolist()]

    def _longest(self, times: Array) -> Indices:
        """The longest cells, by number of the first instant and of the one after the last, (cells, 2)."""
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

    def _apart(self, cells: Indices, times: Array) -> Flags:
        """Whether the instants of each cell differ by more than rounding, (cells,)."""
        middle, half = middle_and_half(cells, times)
        return np.asarray((half > 0.0) & (EPS * np.abs(middle) <= ROUNDED * half))

    def _near(self, cells: Indices, times: Array) -> Flags:
        """Whether each cell is near the start of its series, where a number may begin at zero, (cells,)."""
        middle, half = middle_and_half(cells, times)
        start = self._starts[np.searchsorted(self._starts, times[cells[:, 0]], side="right") - 1]
        return np.asarray(middle - start < NEAR * half)

    def _coefficients(self, cells: Indices, times: Array) -> tuple[Array, Flags]:
        """Coefficients of the rows that are solved for or computed, and in which cells the polynomials fit.

        The highest power is first and the largest coefficient, the constant, last. So the partial sums are
        rounded by the size of the smaller terms.

        Returns:
            Coefficients, shape (cells, rows, DEGREE + 1); and whether all rows fit, (cells,).
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

    def _sum(self, cells: Indices, coefficients: Array, times: Array, laws: Array, rows: Array) -> None:
        """Fill the columns of cells from coefficients and laws, except for the points of the chassis."""
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
        """The laws of the chassis at instants, one row for each reported derivative of each law.

        Raises:
            InputOutOfRange: see `ChassisMotion.law`.
        """
        chassis, reported = self.solved.readout.chassis, self.solved.readout.table.reported
        laws = [chassis.law(name, times, reported[-1])[list(reported)] for name in chassis.functions]
        return np.concatenate(laws) if laws else np.empty((0, len(times)))

    def _at_points(self, points: Array) -> Array:
        """The rows that are solved for or computed, by the plain formulas, without the rows of `_added`."""
        table = self.solved.readout.table
        values = np.empty((table.height, len(points)))
        self.solved.fill_plainly(points, values, add=False)
        return values[: table.first_still]

    @cached_property
    def _numbers(self) -> tuple[Indices, Array, Indices]:
        """The first row of each number, the smallest size with which it is compared, and its kind, from 0.

        The size of a vector is the size of its largest component, and that of an angle is at least 1 rad.
        States of the same derivative are of one kind; every other number is a kind of its own.
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
        """Factors of each reported derivative of each chassis law in each row, and a constant as last column.

        Shape (height, laws x derivatives + 1). The constant is the origin, with the drawn position for points
        of the chassis. Rows that are computed from states have zeros.
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


def middle_and_half(cells: Indices, times: Array) -> tuple[Array, Array]:
    """Middle and half length of cells, s, each (cells,)."""
    first, last = times[cells[:, 0]], times[cells[:, 1] - 1]
    middle = first + 0.5 * (last - first)
    return middle, np.maximum(middle - first, last - middle)
