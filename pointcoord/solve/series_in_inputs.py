r"""The motion of many designs as one series in their inputs, where that is cheaper than a chain in time.

The pose of a linkage depends on time through its inputs only. Where the inputs sweep their ranges several
times, one series in the inputs, about the middle of the ranges, describes the whole motion of a design,

    y(t) = sum_k c_k s(t)^k,        s_i = (input_i - middle_i) / half_i,        |s_i| <= 1,

and the powers s(t)^k are the same for all designs. The series must be as exact as a segment of a chain (see
`taylor`). The last two degrees, each summed over its powers, take the place of the last two terms of a
segment of length 1. At every corner of the ranges Newton's method must find the assembly with a first step of
no more than the tolerance and rounding. And the series must be proven to meet no other branch in the ranges,
whose middle is reached from the start by proven steps (see `proven_step`). Designs that fail are followed in
time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from math import comb, factorial

import numpy as np

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.power_series import expand_moving
from pointcoord.solve.assembly import Pose
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_step import prove_box
from pointcoord.solve.step_rule import MOST, SEGMENT, Settings, degrees_lacking
from pointcoord.solve.taylor import SOLVED, Segment, confirmed
from pointcoord.time_functions import TimeFunction

# Most inputs of a series: three or more inputs need too many powers.
INPUTS = 2
# Most powers of a series: the table of products of powers lists all pairs.
POWERS = 400
# Number of spans of time from which the ranges and the rates of inputs are found. The edges of the spans are
# multiples of the golden ratio, modulo 1, so that they are in step with no oscillation.
SPANS, GOLDEN = 256, 0.5 * (5.0**0.5 - 1.0)
# A start so near the middle of a range, as a share of half the range, is used as the middle: a path to the
# middle costs as much as about 20 powers, the wider range at most one degree more.
NEAR_MIDDLE = 0.02
# Smallest half width of a range, relative to the input's size, or to 1 if the input is smaller.
NARROWEST = 2.0**-20
# Smaller powers are set to zero: they are negligible next to the first power, 1.
SMALLEST = 1e-200
# Designs that need more degrees than this multiple of the median are followed in time.
STANDS_OUT = 1.25
# Degree of the first series; number of designs for which the first series is made; and number of series made
# for all designs until one is enough.
FEWEST, ASKED, TRIED = 8, 16, 2
# Early degrees fall faster than later ones. So the estimated number of further degrees is multiplied by this
# factor, and the first series for all designs is enough as a rule.
SLOWER = 1.2
# Cost of a box in addition to its powers, in powers; and segments of a chain for one sweep over the range.
BOX, SEGMENTS = 100.0, 2.0


@dataclass(frozen=True)
class InputSeries(Segment):
    """One series in inputs: y(t) = sum_k coefficients[k] s(t)^k, powers ordered by degree (`multi_index`).

    The unit of time, `scale`, is NaN, because the series cannot be summed in time. The coefficients contain
    no known coordinates.

    Attributes:
        laws: laws of the inputs that move.
        middle, half: middle and half width of the range of each of these inputs.
        degree: degree of the series.
    """

    laws: tuple[TimeFunction, ...] = ()
    middle: Array = field(default_factory=lambda: np.zeros(0))
    half: Array = field(default_factory=lambda: np.ones(0))
    degree: int = 0

    def powers(self, instants: Array, derivatives: int) -> list[Array]:
        """The powers of s(t) and their time derivatives: `derivatives` arrays in all, each (powers, N)."""
        series = np.stack([law.series(instants, derivatives - 1) for law in self.laws])
        series[..., 0] -= self.middle[:, None]
        series /= self.half[:, None, None]
        states = [np.ascontiguousarray(series[..., d]) * factorial(d) for d in range(derivatives)]
        found = monomials(states, self.degree)
        for each in found:
            # High powers near the middle would be subnormal numbers, which take a hundred times as long.
            each[np.abs(each) < SMALLEST] = 0.0
        return found


def follow_by_inputs(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    settings: Settings,
) -> tuple[Indices, InputSeries | None, Work]:
    """The numbers of the designs for which one box is confirmed, their series, and the work.

    Returns no designs and None where a chain in time is cheaper.

    Args:
        functions: the inputs as functions of time.
        pose: the poses at `start`, one batch dimension.
    """
    nobody = np.zeros(0, dtype=np.intp), None, Work()
    laws = {name: law for name, law in functions.items() if not law.still}
    if not (len(pose.y) and start < stop and 1 <= len(laws) <= INPUTS):
        return nobody
    ranges = _Ranges.of(tuple(laws.values()), start, stop)
    if not np.isfinite(ranges.half).all():
        return nobody
    held = {name: law.series(start, 0) for name, law in functions.items() if law.still}
    course = _Boxed(mechanism, tuple(laws), held, ranges, settings.kept)
    try:
        return course.solve(pose, start, stop)
    except InputOutOfRange:
        # The box is a little wider than the ranges. Following the motion in time shows whether it exists.
        return nobody


@dataclass(frozen=True)
class _Ranges:
    """Ranges of the inputs that move.

    Attributes:
        laws: law of each input.
        middle, half: middle and half width of the range of each input, shape (inputs,).
        passes: number of times that the input that moves most sweeps its range.
        rates: the largest first and second rate of each s, per s and s^2, shape (inputs, 2).
    """

    laws: tuple[TimeFunction, ...]
    middle: Array
    half: Array
    passes: float
    rates: Array

    @classmethod
    def of(cls, laws: tuple[TimeFunction, ...], start: float, stop: float) -> _Ranges:
        breaks = [b for law in laws for b in law.breaks if start < b < stop]
        inside = start + (stop - start) * (GOLDEN * np.arange(SPANS) % 1.0)
        edges = np.unique([*inside, stop, *breaks])
        bounds = [law.values_over(edges[:-1], edges[1:]) for law in laws]
        least, most = np.array([(low.min(), high.max()) for low, high in bounds]).T
        series = np.stack([law.series(edges, 2) for law in laws])
        with np.errstate(all="ignore"):
            middle, begun = 0.5 * (least + most), series[:, 0, 0]
            middle = np.where(np.abs(begun - middle) <= 0.5 * NEAR_MIDDLE * (most - least), begun, middle)
            narrowest = NARROWEST * np.maximum(np.maximum(np.abs(least), np.abs(most)), 1.0)
            half = np.maximum(np.maximum(most - middle, middle - least), narrowest)
            passes = 0.5 * np.abs(np.diff(series[..., 0])).sum(axis=-1) / half
            rates = np.abs(series[..., 1:]).max(axis=1) * (1.0, 2.0) / half[:, None]
        return cls(laws, middle, half, float(passes.max()), rates)


@dataclass(frozen=True)
class _Boxed:
    """The task of a series in inputs: inputs that sweep their ranges, held inputs, and the tolerance."""

    mechanism: Mechanism
    names: tuple[str, ...]
    held: Mapping[str, Array]
    ranges: _Ranges
    settings: Settings

    @property
    def inputs(self) -> int:
        """Number of inputs that move."""
        return len(self.names)

    def known(self, s: Array) -> Array:
        """Known coordinates of the mechanism at a point s of the box, shape (designs, known)."""
        values = self.ranges.middle + self.ranges.half * s
        inputs = {**self.held, **{name: values[i : i + 1] for i, name in enumerate(self.names)}}
        return np.asarray(self.mechanism.known_series(inputs)[..., 0, :])

    @cached_property
    def driven(self) -> list[int]:
        """The coordinates that move with the inputs."""
        topology = self.mechanism.topology
        drives = zip(topology.drives, topology.driven, strict=True)
        return [number for drive, number in drives if drive.input in self.names]

    def known_series(self, order: int) -> Array:
        """Series in s of the driven coordinates, powers first, shape (powers, designs, driven)."""
        columns = [number - self.mechanism.map.unknowns for number in self.driven]
        every, middle = powers(self.inputs, order), self.known(np.zeros(self.inputs))[:, columns]
        found = np.zeros((every.count, len(middle), len(columns)))
        found[0] = middle
        still = np.zeros(order)
        fixed = {name: np.append(series, still) for name, series in self.held.items()}
        fixed |= {name: np.append(at, still) for name, at in zip(self.names, self.ranges.middle, strict=True)}
        for i, name in enumerate(self.names):
            moved = fixed[name].copy()
            moved[1] = self.ranges.half[i]
            series = self.mechanism.known_series({**fixed, name: moved})
            places = [every.power_of(i, k) for k in range(1, order + 1)]
            found[places] += series[:, 1:, columns].swapaxes(0, 1)
        return found

    def solve(self, pose: Pose, start: float, stop: float) -> tuple[Indices, InputSeries | None, Work]:
        """The numbers of the designs for which the box is confirmed, their series, and the work."""
        system, everyone = self.mechanism.map, np.arange(len(pose.y))
        nobody = everyone[:0], None, Work()
        y, factors, left, work = pose.y, pose.factors, pose.left, Work()
        wanted = self.known(np.zeros(self.inputs))
        if (wanted != y[:, system.unknowns :]).any():
            path = follow(system, y, wanted, factors, SOLVED * self.settings.tolerance)
            if not (path.done == 1.0).all():
                return nobody
            y, factors, left, work = path.y, path.factors, path.left, work + path.work
        found = self.series(y, factors)
        if found is None:
            return nobody
        moving, order, good = found
        series = moving[..., : system.unknowns]
        solves = len(series) * len(y)
        work += Work(
            segments=1, series_orders=order, rate_solves=solves, unknowns_solved=solves * system.unknowns
        )
        signs = np.array(list(product((-1.0, 1.0), repeat=self.inputs)))
        corners = (signs[:, None] ** powers(self.inputs, order).exponents).prod(axis=-1)
        ends = np.empty((len(y), len(signs), system.size))
        ends[..., : system.unknowns] = np.tensordot(corners, series, axes=1).swapaxes(0, 1)
        for i, sign in enumerate(signs):
            ends[:, i, system.unknowns :] = self.known(sign)
        reached = newton_refine(system, ends, tolerance=SOLVED * self.settings.tolerance)
        places, edges = [*range(system.unknowns), *self.driven], powers(self.inputs, order).edges
        sizes = np.zeros((order, *y.shape))
        sizes[..., places] = np.add.reduceat(np.abs(moving), edges[1:-1], axis=0)
        begun = np.abs(system.residual(y))
        proof = prove_box(system, factors.preconditioner, y, moving, places, sizes, begun)
        apart = np.abs(reached.y - ends)[..., : system.unknowns].swapaxes(0, 1)
        good &= proof.holds & proof.within(apart).all(axis=0)
        good &= confirmed(system, reached, self.settings.tolerance).all(axis=-1)
        work += reached.work
        coefficients, ranges = np.moveaxis(series, 0, -2), self.ranges
        box = InputSeries(
            start, stop, np.nan, coefficients, left, ranges.laws, ranges.middle, ranges.half, order
        )
        numbers = np.flatnonzero(good)
        return numbers, box if good.all() else box.taken(numbers), work

    def series(self, y: Array, factors: Factors) -> tuple[Array, int, Flags] | None:
        """Series of all coordinates that move, powers first, its degree, and for which designs it is enough.

        None where a chain is cheaper.
        """
        most = min(self.ranges.passes * SEGMENTS * (MOST + SEGMENT) - BOX, POWERS)
        system, order = self.mechanism.map, FEWEST
        everyone = np.arange(len(y))
        # A few designs show the degree that all need, as a rule.
        for some in (everyone[:: max(len(y) // ASKED, 1)], *[everyone] * TRIED):
            if comb(order + self.inputs, order) > most:
                return None
            known = self.known_series(order)[:, some]
            with np.errstate(all="ignore"):
                series = expand_moving(system, factors.taken(some), y[some], known, self.driven, self.inputs)
                lacking = degrees_lacking(
                    series[..., : system.unknowns], self.inputs, order, self.ranges.rates, self.settings
                )
            # The few that need many more degrees than the others are followed in time.
            further = lacking[order + lacking <= STANDS_OUT * (order + np.median(lacking))].max(initial=0.0)
            if not further > 0.0 and len(some) == len(y):
                return series, order, lacking <= 0.0
            if further > MOST:
                break
            order += int(np.ceil(SLOWER * further))
        return None
