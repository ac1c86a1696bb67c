r"""The motion of many designs as one series in their inputs, where that is cheaper than a chain in time.

What a linkage does depends on time through its inputs only. Where these go over their ranges several times,
one series in the inputs, about the middle of the ranges, holds the motion of a design however often it comes
back,

    y(t) = sum_k c_k s(t)^k,        s_i = (input_i - middle_i) / half_i,        |s_i| <= 1,

and the powers s(t)^k are the same for all designs. It must be as exact as a segment of a chain is (see
`taylor`): its last two degrees, summed over their powers, are to it what the last two terms are to a segment
of length 1. At every corner of the ranges Newton's method finds the assembly, from a first step of no more
than the tolerance and rounding; and it is proven that no other branch is met in the ranges, of which the
middle is reached from the start by proven steps (see `proven_step`). Designs of which that is not so are
followed in time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import product
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import InputOutOfRange
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.monomials import monomials
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.numerics.power_series import expand_moving
from pointcoord.solve.assembly import Pose
from pointcoord.solve.follower import follow
from pointcoord.solve.place import starting_place
from pointcoord.solve.proven_step import prove_box
from pointcoord.solve.step_rule import MOST, SEGMENT, Settings, degrees_lacking
from pointcoord.solve.taylor import SOLVED, Segment, confirmed
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]
Flags = NDArray[np.bool_]

# Inputs of a series, at most: of three or more the powers are too many.
INPUTS = 2
# Powers of a series, at most: where products of pairs of them are looked up, all pairs are listed.
POWERS = 400
# Spans of time by which the ranges of inputs are found, and how fast they go; their edges are multiples of
# the golden ratio, which fall in step with no swing.
SPANS, GOLDEN = 256, 0.5 * (5.0**0.5 - 1.0)
# A start is taken for the middle of a range if it is no farther from it, in parts of half of it: a way there
# costs as much as some 20 powers, and so wide a margin at most one degree more.
NEAR_MIDDLE = 0.02
# Ranges narrower than this part of the input's size, or of 1, are as wide.
NARROWEST = 2.0**-20
# Powers of less are nothing beside the first, 1.
SMALLEST = 1e-200
# Designs that need more degrees than this multiple of what the middle one does are followed in time.
STANDS_OUT = 1.25
# Degree of the first series, which so many designs have, and how many are made of all until one is enough.
FEWEST, ASKED, TRIED = 8, 16, 2
# Early degrees fall faster than later ones: so many times as many are added as they tell, so that the first
# series of all is enough.
SLOWER = 1.2
# What a box costs beside its powers, in powers, and segments that a chain takes for a way over the range.
BOX, SEGMENTS = 100.0, 2.0


@dataclass(frozen=True)
class InputSeries(Segment):
    """One series in inputs: y(t) = sum_k coefficients[k] s(t)^k, powers ordered by degree (`multi_index`).

    It has no unit of time, `scale`: summed in time it is no number. Of the known coordinates it has none.

    Attributes:
        laws: of the inputs that move. middle, half: of their ranges.
        degree: of the series.
    """

    laws: tuple[TimeFunction, ...] = ()
    middle: Array = field(default_factory=lambda: np.zeros(0))
    half: Array = field(default_factory=lambda: np.ones(0))
    degree: int = 0

    def powers(self, instants: Array, derivatives: int) -> list[Array]:
        """The powers of s(t) and their time derivatives, `derivatives` in all, each (powers, N)."""
        series = np.stack([law.series(instants, derivatives - 1) for law in self.laws])
        series[..., 0] -= self.middle[:, None]
        series /= self.half[:, None, None]
        states = [np.ascontiguousarray(series[..., d]) * factorial(d) for d in range(derivatives)]
        found = monomials(states, self.degree)
        for each in found:
            # High powers near the middle would leave the normal numbers, which takes a hundred times as long.
            each[np.abs(each) < SMALLEST] = 0.0
        return found


def follow_by_inputs(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    settings: Settings,
) -> tuple[Numbers, InputSeries | None, Work]:
    """The numbers of the designs that one box is confirmed of, and the box of these, if it is cheaper.

    Args:
        functions: the inputs as functions of time. pose: assembled at `start`, one batch dimension.
    """
    nobody = np.zeros(0, dtype=np.intp), None, Work()
    laws = {name: law for name, law in functions.items() if not law.still}
    if not (len(pose.y) and start < stop and 1 <= len(laws) <= INPUTS):
        return nobody
    ranges = _Ranges.of(tuple(laws.values()), start, stop)
    if not np.isfinite(ranges.half).all():
        return nobody
    held = {name: law.series(start, 0) for name, law in functions.items() if law.still}
    part = mechanism.moving_part(functions)
    course = _Boxed(mechanism, part, tuple(laws), held, ranges, settings.kept)
    try:
        return course.solve(pose, start, stop)
    except InputOutOfRange:
        # The range reaches a little farther than the way does: who follows it in time decides.
        return nobody


@dataclass(frozen=True)
class _Ranges:
    """Where the inputs go.

    Attributes:
        laws: of each. middle, half: shape (inputs,). passes: how often they go over their ranges.
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
    """What is expanded over ranges of some inputs, the others held, and how finely."""

    mechanism: Mechanism
    part: PartialMap
    names: tuple[str, ...]
    held: Mapping[str, Array]
    ranges: _Ranges
    settings: Settings

    @property
    def inputs(self) -> int:
        """How many move."""
        return len(self.names)

    def known(self, s: Array) -> Array:
        """Known coordinates of the mechanism at a place of the box, shape (designs, known)."""
        values = self.ranges.middle + self.ranges.half * s
        inputs = {**self.held, **{name: values[i : i + 1] for i, name in enumerate(self.names)}}
        return np.asarray(self.mechanism.known_series(inputs)[..., 0, :])

    def driven(self) -> tuple[list[int], list[int]]:
        """The coordinates that move with the inputs: their places among the known ones, and in the part."""
        topology, system = self.mechanism.topology, self.part.whole
        drives = zip(topology.drives, topology.driven, strict=True)
        numbers = [number for drive, number in drives if drive.input in self.names]
        places = self.part.order.argsort()
        return [number - system.unknowns for number in numbers], places[numbers].tolist()

    def known_series(self, order: int, columns: list[int]) -> Array:
        """The series in s of some of them, powers first, shape (powers, designs, columns)."""
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

    def solve(self, pose: Pose, start: float, stop: float) -> tuple[Numbers, InputSeries | None, Work]:
        """The designs that the box is confirmed of, and the box."""
        system, everyone = self.part.system, np.arange(len(pose.y))
        nobody = everyone[:0], None, Work()
        here = starting_place(self.part, pose)
        y, factors, left, work = here.y, here.factors, here.left, here.work
        wanted = self.part.known(y, self.known(np.zeros(self.inputs))[..., None, :])[..., 0, :]
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
            ends[:, i, system.unknowns :] = self.part.known(y, self.known(sign)[..., None, :])[..., 0, :]
        reached = newton_refine(system, ends, tolerance=SOLVED * self.settings.tolerance)
        places, edges = [*range(system.unknowns), *self.driven()[1]], powers(self.inputs, order).edges
        sizes = np.zeros((order, *y.shape))
        sizes[..., places] = np.add.reduceat(np.abs(moving), edges[1:-1], axis=0)
        proof = prove_box(system, y, moving, places, sizes, system.residual(y))
        apart = np.abs(reached.y - ends)[..., : system.unknowns].swapaxes(0, 1)
        good &= (proof.length == 1.0) & proof.within(apart).all(axis=0)
        good &= confirmed(system, reached, self.settings.tolerance).all(axis=-1)
        work += reached.work
        coefficients, ranges = self.part.unknowns_back(y, np.moveaxis(series, 0, -2)), self.ranges
        box = InputSeries(
            start, stop, np.nan, coefficients, left, ranges.laws, ranges.middle, ranges.half, order
        )
        numbers = np.flatnonzero(good)
        return numbers, box if good.all() else box.taken(numbers), work

    def series(self, y: Array, factors: Factors) -> tuple[Array, int, Flags] | None:
        """Series of all that moves, powers first, their degree, and of which designs it is enough.

        None where a chain is less work.
        """
        most = min(self.ranges.passes * SEGMENTS * (MOST + SEGMENT) - BOX, POWERS)
        system, order, (columns, driven) = self.part.system, FEWEST, self.driven()
        everyone = np.arange(len(y))
        # Some tell the degree as a rule.
        for some in (everyone[:: max(len(y) // ASKED, 1)], *[everyone] * TRIED):
            if comb(order + self.inputs, order) > most:
                return None
            known = self.known_series(order, columns)[:, some]
            with np.errstate(all="ignore"):
                series = expand_moving(system, factors.taken(some), y[some], known, driven, self.inputs)
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
