r"""A chain of series that many members share, a member a column: `taylor.build_chain` with the batch last.

Segments are cut where the coarsest of their members' last terms say, each end is solved by Newton's method
and checked as there: the first step must be no more than the tolerance and rounding, the end on its branch,
and what is left proven to be small, block by block (see `block_proof`). The order is the one that costs least
here, where a segment beside its orders costs less than one by one, and the products of a high order more.

A member that asks for much shorter segments than the others, or whose end is not confirmed, is reported:
whoever asked solves it by itself, and either takes it out or says that it is to stay.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.data_classes import dataclass
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.batch_last.elimination import Eliminated
from pointcoord.numerics.batch_last.series import ColumnSeries
from pointcoord.numerics.counters import Work
from pointcoord.solve.ends_together import confirm, noise
from pointcoord.solve.paths_together import Columns
from pointcoord.solve.taylor import (
    MOST,
    MOST_SEGMENTS,
    SHORTEST,
    Decay,
    Segment,
    Settings,
    decay_by_sizes,
    least_order,
    length_by_sizes,
    power_of_two,
)
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Orders of the first segment, by which the order of the others is chosen, and at least of any.
BEGUN = 8
# What a segment costs beside its orders, in orders, and what the products of an order cost for each order
# below.
SEGMENT, PRODUCTS = 12.0, 0.015
# A member whose last terms alone would make the segments this much shorter than the middle one's stands out.
# A choice: 512 designs of three kinds took 0.34 to 0.68 s with 0.25, 0.53 to 0.64 s with 0.5, and 0.55 to
# 0.80 s with 0.75, on a machine so busy that these do not tell them apart.
STANDS_OUT = 0.5


class NotTogether(Exception):
    """The members cannot be followed together; the plain form must say what there is to say."""


@dataclass(frozen=True)
class Course:
    """What members follow: their mechanisms, the laws of the inputs, and how finely.

    Attributes:
        judge: whether a member, by its number among those that began, goes on by itself.
    """

    columns: Columns
    functions: Mapping[str, TimeFunction]
    start: float
    stop: float
    settings: Settings
    judge: Callable[[int], bool]

    def build(self, mechanism: Mechanism, y: Array, left: Array) -> tuple[Numbers, tuple[Segment, ...], Work]:
        """The chain of all members that go on, with their numbers.

        Args:
            y: start, shape (size, members). left: proven distance to the exact assembly there, (members,).
        Raises:
            NotTogether: it takes the plain form.
        """
        alive = np.arange(y.shape[-1])
        joint = _Joint(self.start, y, left, self.stop - self.start)
        segments: list[Segment] = []
        stays: set[int] = set()
        spare: ColumnSeries | None = None
        work = Work()
        mechanism_now = mechanism
        while joint.instant < self.stop or not segments:
            if len(segments) == MOST_SEGMENTS or not len(alive):
                raise NotTogether
            staying = np.array([int(number) in stays for number in alive])
            step = _Step(self, mechanism_now, joint, staying, spare)
            ended = step.take()
            spare = step.begun
            work += step.work
            if isinstance(ended, _Joint):
                segments.append(step.segment(ended.instant))
                joint = ended
                continue
            # Some members stand out: each goes by itself or not at all.
            kept = np.ones(len(alive), dtype=bool)
            for place in np.flatnonzero(ended).tolist():
                if self.judge(int(alive[place])):
                    stays.add(int(alive[place]))
                else:
                    kept[place] = False
            if not kept.any():
                raise NotTogether
            if kept.all() and step.failed:
                raise NotTogether
            alive = alive[kept]
            numbers = np.flatnonzero(kept)
            mechanism_now = mechanism_now.taken(numbers)
            joint = joint.part(numbers)
            segments = [
                Segment(s.start, s.stop, s.scale, s.coefficients[numbers], np.asarray(s.left)[numbers])
                for s in segments
            ]
        return alive, tuple(segments), work


@dataclass(frozen=True)
class _Joint:
    """Where a segment starts; length: of the one before it, or of the whole motion. decay: see `Decay`."""

    instant: float
    y: Array
    left: Array
    length: float
    decay: Decay | None = None

    def part(self, numbers: Numbers) -> _Joint:
        return _Joint(
            self.instant,
            np.ascontiguousarray(self.y[:, numbers]),
            self.left[numbers],
            self.length,
            self.decay,
        )


class _Step:
    """One segment from a joint, as far as it goes.

    Attributes:
        failed: whether members could not be confirmed, however short the segment.
    """

    def __init__(
        self,
        course: Course,
        mechanism: Mechanism,
        joint: _Joint,
        stays: NDArray[np.bool_],
        spare: ColumnSeries | None,
    ) -> None:
        self.course, self.mechanism, self.joint = course, mechanism, joint
        self.stays = stays
        self.failed = False
        self.begun: ColumnSeries | None = None
        self.spare = spare
        self.work = Work()
        self.scale = power_of_two(joint.length)
        columns = course.columns
        with np.errstate(all="ignore"):
            self.factors: Eliminated = columns.factorise(columns.map.differences(joint.y))
        members = joint.y.shape[-1]
        self.work += Work(segments=1, factorisations=members)

    def take(self) -> _Joint | NDArray[np.bool_]:
        """The end of the segment, or who is not confirmed there."""
        course, joint = self.course, self.joint
        if not self.factors.sound.all():
            return self._unsound(~self.factors.sound)
        limit = self._next_break()
        time = limit - joint.instant
        if course.start == course.stop:
            self._expand(max(course.settings.derivative, 1))
            return _Joint(course.stop, joint.y, joint.left, joint.length)
        order = BEGUN if joint.decay is None else _order(joint.decay, time)
        order = min(max(order, least_order(course.functions)), MOST)
        self._expand(order)
        length = self._length()
        if np.isfinite(length):
            decay = self._decay(length)
            wanted = max(_order(decay, time), order)
            if joint.decay is None and wanted > order:
                self._expand(wanted)
                length = self._length()
        if not np.isfinite(self.sizes).all():
            raise NotTogether
        if (out := self._standing_out()).any():
            return out
        fallen = self._decay(length) if np.isfinite(length) else None
        shortest = SHORTEST * (course.stop - course.start)
        # Where already the first length is too short for all of them, none is confirmed.
        good = np.zeros(joint.y.shape[-1], dtype=bool)
        for _ in range(8):
            if length < shortest and joint.instant + length < limit:
                break
            end = limit if joint.instant + length >= limit else joint.instant + length
            good, y, left = self._end(end)
            if good.all():
                return _Joint(end, y, left, min(length, end - joint.instant), fallen)
            if np.count_nonzero(~good) <= len(good) // 4 and not self.stays[~good].all():
                return self._unsound(~good)
            length = 0.5 * (end - joint.instant)
        return self._unsound(~good)

    @property
    def series(self) -> ColumnSeries:
        """What is expanded."""
        if self.begun is None:
            raise ValueError("nothing is expanded yet")
        return self.begun

    def segment(self, stop: float) -> Segment:
        """The segment up to an instant, its members first."""
        series = self.series.y[: self.series.count]
        return Segment(self.joint.instant, stop, self.scale, series.transpose(2, 0, 1), self.joint.left)

    def _unsound(self, members: NDArray[np.bool_]) -> NDArray[np.bool_]:
        self.failed = bool((members & self.stays).any())
        if self.failed:
            raise NotTogether
        return members

    def _next_break(self) -> float:
        breaks = {b for function in self.course.functions.values() for b in function.breaks}
        return min((b for b in breaks if self.joint.instant < b < self.course.stop), default=self.course.stop)

    def _known(self, instant: float, order: int) -> Array:
        """Coefficients of the driven coordinates, shape (order + 1, driven, members), per s^k."""
        topology, drawing = self.mechanism.topology, self.mechanism.drawing
        found = []
        for drive in topology.drives:
            series = drive.series(self.course.functions[drive.input].series(instant, order), drawing)
            found.append(np.broadcast_to(series, (self.joint.y.shape[-1], order + 1)).T)
        return np.stack(found, axis=1)

    def _law(self, most: int) -> None:
        joint = self.joint
        self.law = self._known(joint.instant, most) * (self.scale ** np.arange(most + 1.0))[:, None, None]
        if not np.isfinite(self.law).all():
            raise NotTogether

    def _begin(self, most: int) -> None:
        joint, columns = self.joint, self.course.columns
        self._law(most)
        functions = self.course.functions
        drives = zip(self.mechanism.topology.drives, columns.driven, strict=True)
        # Every order counts: a law may stand still in its first ones.
        moving = [
            place for drive, place in drives if functions[drive.input].series(joint.instant, MOST)[1:].any()
        ]
        self.moving = [columns.driven.index(place) for place in moving]
        self.begun = ColumnSeries.begin(columns.map, self.factors, joint.y, moving, most, self.spare)
        self.sizes = np.abs(joint.y[None, : columns.map.unknowns]).max(axis=1)

    def _expand(self, order: int) -> None:
        if self.begun is None:
            self._begin(order)
        elif order >= len(self.law):
            self._law(order)
            self.begun.longer(order)
        n, members = self.course.columns.map.unknowns, self.joint.y.shape[-1]
        self.work += Work(series_orders=order, rate_solves=order * members)
        with np.errstate(all="ignore"):
            while self.series.count <= order:
                self.series.carry_on(self.law[self.series.count, self.moving])
            new = np.abs(self.series.y[len(self.sizes) : self.series.count, :n]).max(axis=1)
            self.sizes = np.concatenate([self.sizes, new])

    def _logs(self) -> tuple[Array, Array]:
        with np.errstate(divide="ignore"):
            return np.log(self.sizes.max(axis=-1))[None], np.log(self.sizes.min(axis=-1))[None]

    def _length(self) -> float:
        """How long the segment may be, s."""
        largest, smallest = self._logs()
        return length_by_sizes(largest, self.course.settings, smallest) * self.scale

    def _decay(self, length: float) -> Decay:
        decay = decay_by_sizes(self._logs()[0], length / self.scale)
        return Decay(decay.radius * self.scale, decay.spread)

    def _standing_out(self) -> NDArray[np.bool_]:
        """Members whose last terms are so large that they alone shorten the segment."""
        last = np.maximum(self.sizes[-1], self.sizes[-2])
        middle = float(np.median(last))
        factor = STANDS_OUT ** -(len(self.sizes) - 1.0)
        return np.asarray((last > max(middle, 1e-300) * factor) & ~self.stays)

    def _end(self, end: float) -> tuple[NDArray[np.bool_], Array, Array]:
        """Whether members are confirmed at an instant; their coordinates there, and what is left of them."""
        course, joint, columns = self.course, self.joint, self.course.columns
        n, tolerance = columns.map.unknowns, course.settings.tolerance
        members = joint.y.shape[-1]
        s = (end - joint.instant) / self.scale
        y = self.series.at(s)
        y[n:] = joint.y[n:]
        y[columns.driven] = self._known(end, 0)[0]
        largest = self.sizes[-2:] * np.array([[s ** (len(self.sizes) - 2)], [s ** (len(self.sizes) - 1)]])
        found = confirm(columns, y, self.factors, largest.sum(axis=0), tolerance)
        self.work += Work(residuals=found.steps * members, factorisations=found.steps * members)
        good, first_step = found.good, found.first_step
        doubtful = good & ~(first_step <= tolerance)
        if doubtful.any():
            good[doubtful] = first_step[doubtful] <= tolerance + 2.0 * self._noise(found.y, end, doubtful)
        return good, found.y, found.left

    def _noise(self, y: Array, end: float, members: NDArray[np.bool_]) -> Array:
        """Rounding of Newton's step of some members, the rounding of the laws included, shape (members,)."""
        numbers = np.flatnonzero(members)
        mechanism = self.mechanism.taken(numbers)
        here = np.ascontiguousarray(y[:, numbers])
        off = {name: function.rounding(np.array(end)) for name, function in self.course.functions.items()}
        data = np.zeros(len(here))
        if any(doubt.any() for doubt in off.values()):
            _, data = mechanism.known_data(np.ascontiguousarray(here.T), off)
        return noise(self.course.columns, here, data)


def _order(decay: Decay, time: float) -> int:
    """The order that costs least over a time, s; two to spare because the law of lengths is not exact."""
    orders = np.arange(BEGUN, MOST + 1)
    reach = decay.radius * np.exp(-decay.spread / np.maximum(orders - 1, 1))
    with np.errstate(divide="ignore", over="ignore"):
        count = np.maximum(np.ceil(time / np.maximum(reach, 1e-300)), 1.0)
    cost = count * (SEGMENT + orders + PRODUCTS * orders**2)
    return int(orders[int(np.argmin(cost))])
