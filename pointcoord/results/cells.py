r"""Many instants close together: the rows of a table as polynomials in cells, by one matrix product.

A cell is a stretch of consecutive instants inside one series, so short that every number is a polynomial of
degree `DEGREE` there, to rounding. Its numbers are computed by the plain formulas (series, effects) at that
many and one more Chebyshev points, and all instants of the cell take

    rows = [coefficients, directions] [s^n .. s^0, laws of the chassis],

a product whose result is written where it belongs. What is made of states, an angle or a turn, costs there
what a coordinate costs. Whether a cell is short enough is not guessed:

- of a state, by its series. About the middle c of a cell of half the length h, sum_j c_j s^j has terms of
  order m of at most sum_j binomial(j, m) |c_j| c^(j - m) h^m, and what of those is beyond the degree bounds
  the difference (see `chebyshev`): below an eighth of a rounding of the terms' magnitudes, by which the sum
  of the series is rounded itself, whatever the terms are.
- of a number that is computed of states, analytic as these are: where the second half of its coefficients is
  below `HALFWAY`, what lies beyond them is below the square of that and more.
- a law of the chassis is taken at the instants themselves.

A cell that is too long is halved; where one of few instants still is, as where a motion begins from rest and
each number counts relative to itself, the plain formulas are left to do. How far a number is off is proven
from the number (see `bounds`), however it was found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange, SingularConfiguration
from pointcoord.numerics.chebyshev import binomials, interpolation, shares_beyond
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF
from pointcoord.results.readout import BLOCK, ENOUGH
from pointcoord.results.solved_scene import SolvedScene
from pointcoord.solve.dense_output import derivative_tables, narrow_product
from pointcoord.solve.taylor import Chain

Array = NDArray[np.float64]
Whole = NDArray[np.intp]
Stretch = tuple[int, int]
"""Instants from a number to before another."""

# Three products make the powers up to it.
DEGREE = 8
# Instants of a cell: at most what keeps its powers in a second-level cache, at least what pays its points.
MOST, FEWEST = 4096, 128
# Of the terms' magnitudes, what may be left out; and what of the largest number of its kind is none at all:
# rates that are solved for together share that much of each other's rounding.
LEFT_OUT, SHARED = UNIT_ROUNDOFF / 8.0, 8.0 * EPS
# Half the length of a cell by its distance from the start of the series: its numbers are of one size there.
NARROW = 1.0 / 16.0
# By how much of half a cell an instant may be rounded (see `Interpolation.chebyshev`).
ROUNDED = 2.0**-24
# Largest coefficient of the second half, of a number's size.
HALFWAY = 2.0**-30
# Instants whose cells are worked out together: their tables take some 15 MB at most.
TOGETHER = 2**18


@dataclass(frozen=True, eq=False)
class _Cells:
    """Cells of instants, a number each.

    Attributes:
        low, high: their instants. middle, half: s.
    """

    low: Whole
    high: Whole
    middle: Array
    half: Array

    @classmethod
    def of(cls, low: Whole, high: Whole, times: Array) -> _Cells:
        """Of consecutive instants from numbers `low` to before `high`."""
        first, last = times[low], times[high - 1]
        middle = first + 0.5 * (last - first)
        return cls(low, high, middle, np.maximum(middle - first, last - middle))

    def __len__(self) -> int:
        return len(self.low)

    def chosen(self, which: NDArray[np.bool_] | Whole) -> _Cells:
        """Some of them."""
        return _Cells(self.low[which], self.high[which], self.middle[which], self.half[which])

    @staticmethod
    def joined(parts: Sequence[_Cells]) -> _Cells:
        """All of some."""
        columns = ((each.low, each.high, each.middle, each.half) for each in parts)
        low, high, middle, half = (np.concatenate(column) for column in zip(*columns, strict=True))
        return _Cells(low, high, middle, half)

    def points(self, times: Array) -> tuple[Array, Array]:
        """Instants of each cell near the points, and by how much of half a cell; (cells, DEGREE + 1)."""
        own = interpolation(DEGREE).points
        first, last = times[self.low][:, None], times[self.high - 1][:, None]
        points = np.clip(self.middle[:, None] + self.half[:, None] * own, first, last)
        return points, (points - self.middle[:, None]) / self.half[:, None] - own

    def together(self, most: int) -> Iterator[Stretch]:
        """Cells from a number to before another that have at most so many instants, which each has too."""
        ends, first = np.cumsum(self.high - self.low), 0
        while first < len(self):
            before = ends[first - 1] if first else 0
            last = int(np.searchsorted(ends, before + most, side="right"))
            yield first, last
            first = last

    def stretches(self) -> list[Stretch]:
        """The instants of cells in order, neighbours taken together."""
        begins = np.flatnonzero(np.append(True, self.low[1:] != self.high[:-1]))
        ends = np.append(begins[1:], len(self)) - 1
        return (
            list(zip(self.low[begins].tolist(), self.high[ends].tolist(), strict=True)) if len(self) else []
        )


def _of_powers(chebyshev: Array) -> Array:
    """Coefficients of powers, highest first, of each cell, from those of Chebyshev's polynomials.

    The largest comes last, so that a sum is rounded by the smaller ones' size until then.

    Args:
        chebyshev: shape (rows, cells, DEGREE + 1).
    Returns:
        Shape (cells, rows, DEGREE + 1).
    """
    return np.ascontiguousarray(np.moveaxis(chebyshev @ interpolation(DEGREE).powers, 1, 0)[..., ::-1])


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
        whole = [(0, len(times))]
        if not (times[0] >= self.solved.start and times[-1] <= self.solved.stop):
            return whole
        cells = self._cells(times)
        if not len(cells):
            return whole
        try:
            filled = self._fill_cells(cells, times, rows).stretches()
        except (InputOutOfRange, SingularConfiguration):
            # At a point of a cell that may be no instant that was asked for.
            return whole
        ends = [0, *(end for stretch in filled for end in stretch), len(times)]
        return [(ends[i], ends[i + 1]) for i in range(0, len(ends), 2) if ends[i] < ends[i + 1]]

    def _cells(self, times: Array) -> _Cells:
        """As few cells as are short enough for every state."""
        starts, _ = self._segments
        edges = [0, *np.searchsorted(times, starts[1:], side="left").tolist(), len(times)]
        lows = [
            np.arange(first, last, MOST) if last - first >= ENOUGH else np.zeros(0, dtype=np.intp)
            for first, last in pairwise(edges)
        ]
        segment, low = np.repeat(np.arange(len(lows)), [len(each) for each in lows]), np.concatenate(lows)
        high = np.minimum(low + MOST, np.array(edges[1:])[segment])
        found = []
        while len(low):
            cells = _Cells.of(low, high, times)
            short = self._short_enough(segment, cells)
            found.append(cells.chosen(short))
            long = ~short & (high - low >= 2 * FEWEST)
            segment, low, high = segment[long].repeat(2), low[long].repeat(2), high[long].repeat(2)
            low[1::2] = high[::2] = (low[::2] + high[1::2]) // 2
        every = _Cells.joined([_Cells.of(low, high, times), *found])
        return every.chosen(np.argsort(every.low))

    def _short_enough(self, segment: Whole, cells: _Cells) -> NDArray[np.bool_]:
        """Whether every state is a polynomial of the degree in each cell.

        Args:
            segment: of each cell; they do not decrease.
        """
        starts, scales = self._segments
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            middle = (cells.middle - starts[segment]) / scales[segment]
            half = cells.half / scales[segment]
            ratio = half / middle
            rounded = EPS * np.abs(cells.middle) <= ROUNDED * cells.half
            good = rounded & (half > 0.0) & (middle > 0.0) & (ratio <= NARROW)
        if not good.any():
            return good
        segment, middle, half, ratio = segment[good], middle[good], half[good], ratio[good]
        left, terms = (np.empty((len(self._sizes[0]), len(segment))) for _ in range(2))
        places = np.searchsorted(segment, np.arange(len(self._sizes) + 1)).tolist()
        most = max(sizes.shape[-1] for sizes in self._sizes)
        powers, narrow = (each ** np.arange(most)[:, None] for each in (middle - half, ratio))
        whole = middle ** np.arange(most)[:, None]
        for sizes, (first, last) in zip(self._sizes, pairwise(places), strict=True):
            if first < last:
                here, count = slice(first, last), sizes.shape[-1]
                beyond = 2.0 * shares_beyond(DEGREE, count)[DEGREE + 1 :, None]
                own = binomials(count)[:, DEGREE + 1 :] @ (beyond * narrow[DEGREE + 1 : count, here])
                left[:, here] = sizes @ (whole[:count, here] * own)
                terms[:, here] = sizes @ powers[:count, here]
        allowed = LEFT_OUT * (terms + SHARED * self._largest_of_a_kind(terms))
        good[good] = (left <= allowed).all(axis=0)
        return good

    def _largest_of_a_kind(self, terms: Array) -> Array:
        """Of all rows that are the same derivative, in each row."""
        largest = np.empty_like(terms)
        for low, high in pairwise([0, *accumulate(map(len, self._kinds))]):
            largest[low:high] = terms[low:high].max(axis=0, initial=0.0)
        return largest

    @cached_property
    def _segments(self) -> tuple[Array, Array]:
        """Start and scale of each segment, s."""
        starts, scales = zip(*((s.start, s.scale) for s in self.chain.segments), strict=True)
        return np.array(starts), np.array(scales)

    @cached_property
    def _kinds(self) -> list[list[int]]:
        """By derivative the coordinates whose series are summed."""
        layout, kinds = self.solved.readout.mechanism.layout, dict[int, list[int]]()
        for order, name in self.solved.solved_states:
            kinds.setdefault(order, []).extend(layout.vector(name))
        return [kinds.get(order, []) for order in range(max(kinds, default=-1) + 1)]

    @cached_property
    def _sizes(self) -> tuple[Array, ...]:
        """The magnitudes of each segment's coefficients, (rows, order + 1), a row for each sum."""
        found = []
        for segment in self.chain.segments:
            tables = derivative_tables(segment.coefficients, segment.scale, len(self._kinds) - 1)
            rows = [table[:, places] for table, places in zip(tables, self._kinds, strict=True)]
            found.append(np.ascontiguousarray(np.abs(np.concatenate(rows, axis=-1)).T))
        return tuple(found)

    def _fill_cells(self, cells: _Cells, times: Array, rows: Array) -> _Cells:
        """Fill the columns of those cells in which computed numbers are polynomials too, and give these."""
        table, still, added = self.solved.readout.table, self.solved.readout.table.first_still, self._added
        coefficients, good = self._coefficients(cells, times)
        cells, coefficients = cells.chosen(good), coefficients[good]
        terms = {row: np.flatnonzero(added[row, :-1]).tolist() for row in range(still, table.height)}
        stands = [row for row, own in terms.items() if not own]
        carried = [(row, own[0], own[1:]) for row, own in terms.items() if own]
        for low, high in cells.stretches():
            for row in stands:
                rows[row, low:high] = added[row, -1]
        coefficients[..., -1] += added[:still, -1]
        room = np.ones((DEGREE + added.shape[-1], MOST))
        middle, half = cells.middle.tolist(), cells.half.tolist()
        spans = list(zip(cells.low.tolist(), cells.high.tolist(), strict=True))
        for first, last in cells.together(MOST):
            ends = [0, *accumulate(high - low for low, high in spans[first:last])]
            power = room[DEGREE::-1, : ends[-1]]
            here = np.concatenate([times[slice(*span)] for span in spans[first:last]])
            for cell, (start, end) in enumerate(pairwise(ends), first):
                np.subtract(here[start:end], middle[cell], out=power[1, start:end])
                power[1, start:end] /= half[cell]
            for known in (1, 2, 4):
                np.multiply(power[1 : known + 1], power[known], out=power[known + 1 : 2 * known + 1])
            room[DEGREE + 1 :, : ends[-1]] = self._laws(here)
            for cell, (start, end) in enumerate(pairwise(ends), first):
                low, high = spans[cell]
                basis, own = room[:, start:end], room[DEGREE + 1 :, start:end]
                matrix = np.concatenate([coefficients[cell], added[:still, :-1]], axis=-1)
                narrow_product(matrix, basis, rows[:still, low:high])
                # A product of matrices takes three times as long for rows that have one law each.
                for row, law, others in carried:
                    out = rows[row, low:high]
                    np.multiply(own[law], added[row, law], out=out)
                    for other in others:
                        out += own[other] * added[row, other]
                    out += added[row, -1]
        return cells

    def _laws(self, times: Array) -> Array:
        """The laws of the chassis at instants, a row for each derivative of each.

        Raises:
            InputOutOfRange: as `ChassisMotion.law`.
        """
        chassis, reported = self.solved.readout.chassis, self.solved.readout.table.reported
        laws = [chassis.law(name, times, reported[-1])[list(reported)] for name in chassis.functions]
        return np.concatenate(laws) if laws else np.empty((0, len(times)))

    def _coefficients(self, cells: _Cells, times: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Of the rows that are solved for or computed; and in which cells computed ones are polynomials."""
        points, moved = cells.points(times)
        values = self._at_points(points.ravel()).reshape(-1, *points.shape)
        found = interpolation(DEGREE).chebyshev(values, moved)
        first, least = self._computed
        largest, last = (
            np.maximum.reduceat(np.abs(each).max(axis=-1), first)
            for each in (values, found[..., DEGREE // 2 + 1 :])
        )
        good = np.asarray((last <= HALFWAY * np.maximum(largest, least[:, None])).all(axis=0))
        return _of_powers(found), good

    def _at_points(self, points: Array) -> Array:
        """The rows that are solved for or computed, by the plain formulas, without what reporting adds."""
        readout = self.solved.readout
        values = np.empty((readout.table.height, len(points)))
        for low in range(0, len(points), BLOCK):
            here, block = points[low : low + BLOCK], values[:, low : low + BLOCK]
            states, laws = self.solved.states(here, block), readout.laws(here)
            along_ways = readout.plan.along_ways
            slopes = readout.slopes(laws, self.solved.coordinates(here, 0)[0]) if along_ways else {}
            readout.compute(states, states, readout.added(laws), block, slopes)
        return values[: readout.table.first_still]

    @cached_property
    def _computed(self) -> tuple[Whole, Array]:
        """The first row of each number, and a size below which it is small: of those that are solved for any.

        A vector is large or small as a whole, and an angle by the side of a radian.
        """
        table, carried = self.solved.readout.table, self.solved.readout.mechanism.topology.carried
        found = {3 * i: 0.0 if name in carried else np.inf for i, (_, name) in enumerate(table.moving)}
        for effect in table.computed:
            for quantity in effect.quantities:
                size = 1.0 if quantity.unit == "rad" else 0.0
                found |= {place.start: size for place in table.places[quantity.name].values()}
        first = sorted(found)
        return np.array(first, dtype=np.intp), np.array([found[row] for row in first])

    @cached_property
    def _added(self) -> Array:
        """What reporting adds to each row along each derivative of each law, and what stands.

        Shape (height, laws x derivatives + 1); zero in the rows that are computed.
        """
        readout, table = self.solved.readout, self.solved.readout.table
        count = len(table.reported)
        added = np.zeros((table.height, len(readout.chassis.functions) * count + 1))
        for first, (derivative, name) in table.states:
            if first >= table.first_still and derivative == 0:
                added[first : first + 3, -1] = readout.mechanism.drawn_places[name]
        for place, derivative in enumerate(table.reported):
            for part in table.states_of(derivative):
                points = added[part].reshape(-1, 3, added.shape[-1])
                for i, name in enumerate(readout.chassis.functions):
                    points[..., i * count + place] = readout.chassis.directions[name]
                if derivative == 0:
                    points[..., -1] += readout.mechanism.origin
        return added
