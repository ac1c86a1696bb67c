"""The inputs that a map is made over, and their range cut into boxes.

A box halves the range of each input some times over. Its place is kept in whole numbers, in parts of the
smallest box, so that boxes that touch are known to, exactly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.jet import Jet
from pointcoord.time_functions import middle_and_half

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# Orders: fewer show nothing, a double has no more digits; of three inputs 12 are 455 powers.
LEAST_ORDER, MOST_DIGITS, MOST_ORDER = 6, 16, {1: 20, 2: 20, 3: 12}
# Least width of a range, in parts of its size or of 1, of an input that hardly moves.
NARROWEST = 2.0**-20


@dataclass(frozen=True)
class Domain:
    """Ranges of the inputs of a mechanism of one car.

    Attributes:
        ranges: of every input that drives it, rad or mm; one whose ends are the same is held there.
        halvings: how often the range of an input is halved at most.
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
        """How many of the smallest boxes lie along a range."""
        return 1 << self.halvings

    @cached_property
    def ends(self) -> tuple[Array, Array]:
        """The lower and the upper ends of the free inputs, each (p,)."""
        low, high = np.array([self.ranges[name] for name in self.free]).reshape(-1, 2).T
        return low, high

    def inputs_at(self, twice: Whole) -> Array:
        """Values of the free inputs at places given in halves of the smallest box, shape (..., p)."""
        low, high = self.ends
        share = twice / (2.0 * self.parts)
        return np.asarray(np.where(share >= 1.0, high, low + (high - low) * share))

    def middle_and_half(self, low: Whole, high: Whole) -> tuple[Array, Array]:
        """Middles of boxes, and half widths that reach both ends whatever is rounded, each (..., p)."""
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
        """How many of the smallest boxes values of the free inputs lie above the lower ends, (..., p)."""
        low, high = self.ends
        return np.asarray((values - low) * (self.parts / (high - low)))

    def nearest_place(self, values: Array) -> Whole:
        """The place that is nearest to values of the free inputs, in halves of the smallest box, (p,)."""
        low, high = self.ends
        share = (values - low) / (high - low)
        return np.clip(np.round(share * 2 * self.parts), 0, 2 * self.parts).astype(np.int64)

    def order_for(self, tolerance: float, derivative: int = 0) -> int:
        """Total degree of the series: one for each digit of a tolerance, relative to the mechanism's size.

        A pose costs in proportion to the number of powers, order^p, and the number of patches falls with the
        order; between half and twice this order both together change little. A derivative loses as many
        digits as two orders gain; of more inputs fewer orders are as many powers.

        Args:
            tolerance: mm. derivative: highest that the limits hold.
        """
        digits = round(-np.log10(tolerance / float(self.mechanism.unit)))
        kept = int(np.clip(digits, LEAST_ORDER, MOST_DIGITS))
        return min(kept + 2 * derivative, MOST_ORDER.get(len(self.free), LEAST_ORDER))

    def known_over(self, middle: Array, half: Array, order: int) -> tuple[Array, Array, Jet]:
        """Series of the known coordinates over boxes, shapes (P, p).

        Returns:
            Coefficients, (P, powers, known coordinates); what those of the middle lack, (P, size); and how
            far the series are off beside that, (P, size).
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
    """A range that is no narrower than can be divided."""
    room = NARROWEST * max(abs(low), abs(high), 1.0) - (high - low)
    return (low - 0.5 * room, high + 0.5 * room) if room > 0.0 else (low, high)
