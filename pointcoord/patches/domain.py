"""The ranges of the inputs of a map, divided into boxes.

A box results from halving the range of each input several times. The corners of boxes are whole numbers, in
units of the smallest box. So it is known exactly whether boxes touch.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Integers
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.jet import Jet
from pointcoord.time_functions import middle_and_half

# Lowest order from which convergence can be seen; digits of a double; and highest order by number of inputs:
# with three inputs order 12 has 455 powers.
LEAST_ORDER, MOST_DIGITS, MOST_ORDER = 6, 16, {1: 20, 2: 20, 3: 12}
# Smallest width of the range of an input that hardly moves, relative to its largest value or to 1.
NARROWEST = 2.0**-20


@dataclass(frozen=True)
class Domain:
    """Ranges of the inputs of a mechanism of one car.

    Attributes:
        ranges: range of every input that drives the mechanism, rad or mm; an input with equal ends is held.
        halvings: most halvings of the range of an input.
    """

    mechanism: Mechanism
    ranges: Mapping[str, tuple[float, float]]
    halvings: int

    @cached_property
    def free(self) -> tuple[str, ...]:
        """The inputs that are not held: the variables of the series."""
        names = self.mechanism.topology.required_inputs
        return tuple(name for name in names if self.ranges[name][0] < self.ranges[name][1])

    @property
    def parts(self) -> int:
        """Number of smallest boxes along a range."""
        return 1 << self.halvings

    @cached_property
    def ends(self) -> tuple[Array, Array]:
        """The lower and the upper ends of the free inputs, each (p,)."""
        low, high = np.array([self.ranges[name] for name in self.free]).reshape(-1, 2).T
        return low, high

    def inputs_at(self, twice: Integers) -> Array:
        """Values of the free inputs at places in units of half the smallest box, shape (..., p)."""
        low, high = self.ends
        share = twice / (2.0 * self.parts)
        return np.asarray(np.where(share >= 1.0, high, low + (high - low) * share))

    def middle_and_half(self, low: Integers, high: Integers) -> tuple[Array, Array]:
        """Middles of boxes, and half widths that include both ends in spite of rounding, each (..., p)."""
        return middle_and_half(self.inputs_at(2 * low), self.inputs_at(2 * high))

    def known_at(self, values: Array) -> Array:
        """Known coordinates at values of the free inputs, shape (..., p) to (..., known coordinates)."""
        batch = values.shape[:-1]
        series = {
            name: np.full((*batch, 1), self.ranges[name][0])
            for name in self.mechanism.topology.required_inputs
        }
        series |= {name: values[..., i, None] for i, name in enumerate(self.free)}
        return self.mechanism.known_series(series)[..., 0, :]

    def in_boxes(self, values: Array) -> Array:
        """Distance of values from the lower ends, in smallest boxes, for the free inputs, (..., p)."""
        low, high = self.ends
        return np.asarray((values - low) * (self.parts / (high - low)))

    def nearest_place(self, values: Array) -> Integers:
        """The place nearest to values of the free inputs, in units of half the smallest box, (p,)."""
        low, high = self.ends
        share = (values - low) / (high - low)
        return np.clip(np.round(share * 2 * self.parts), 0, 2 * self.parts).astype(np.int64)

    def order_for(self, tolerance: float, derivative: int = 0) -> int:
        """Total degree of the series: the digits of the tolerance, relative to the mechanism's size.

        The cost of a pose is in proportion to the number of powers, order^p, and the number of patches falls
        with the order. Between half and twice this order the total cost changes little. A derivative loses as
        many digits as two more orders gain. With more inputs an order has more powers, so the order is
        limited.

        Args:
            tolerance: mm.
            derivative: highest derivative that the limits hold.
        """
        digits = round(-np.log10(tolerance / float(self.mechanism.unit)))
        kept = int(np.clip(digits, LEAST_ORDER, MOST_DIGITS))
        return min(kept + 2 * derivative, MOST_ORDER.get(len(self.free), LEAST_ORDER))

    def known_over(self, middle: Array, half: Array, order: int) -> tuple[Array, Array, Jet]:
        """Series of the known coordinates over boxes.

        Args:
            middle, half: middles and half widths of the boxes, (P, p).
        Returns:
            Coefficients, (P, powers, known coordinates); rounding errors of those of the middle, to be added
            to them, (P, size); and error bounds of the series after that correction, (P, size).
        """
        mechanism, count = self.mechanism, len(self.free)
        layout, every = mechanism.layout, powers(count, order)
        boxes, first = len(middle), layout.unknowns
        known = np.zeros((boxes, every.count, layout.size - first))
        known[:, 0] = mechanism.drawn[first:]
        lacking = np.tile(mechanism.drawn_lacks, (boxes, 1))
        value = np.tile(mechanism.drawn_doubt, (boxes, 1))
        rates = np.zeros((boxes, count, layout.size))
        curves = np.zeros((boxes, count, count, layout.size))
        for drive in mechanism.topology.drives:
            place, moves = layout.scalar(drive.coordinate), drive.input in self.free
            i = self.free.index(drive.input) if moves else 0
            at = middle[:, i] if moves else np.full(boxes, self.ranges[drive.input][0])
            width = half[:, i] if moves else np.zeros(boxes)
            series, doubts = drive.series_over(at, width, order, mechanism.drawing)
            known[:, 0, place - first] = series[:, 0]
            lacking[:, place] = drive.rounding(series[:, 0], mechanism.drawing, 0.0)[0]
            value[:, place] = doubts[0]
            if moves:
                along = [every.power_of(i, k) for k in range(1, order + 1)]
                known[:, along, place - first] = series[:, 1:]
                rates[:, i, place], curves[:, i, i, place] = doubts[1:]
        return known, lacking, Jet(value, rates, curves)


def widened(low: float, high: float) -> tuple[float, float]:
    """A range, widened if it is too narrow to be divided."""
    room = NARROWEST * max(abs(low), abs(high), 1.0) - (high - low)
    return (low - 0.5 * room, high + 0.5 * room) if room > 0.0 else (low, high)
