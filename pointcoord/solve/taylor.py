r"""A motion as a chain of short power series.

A segment is as long as its last two terms allow (see `step_rule`). Newton's method then solves the pose at
the end. So the next segment starts without inherited error, and the first Newton step shows the error of the
segment. A segment is halved if this error is too large, or if the segment is not proven to stay on one branch
(see `proven_step`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Self

import numpy as np

from pointcoord.errors import InputOutOfRange, NotFollowed
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.arrays import Array, Flags, Indices
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors
from pointcoord.numerics.newton import Converged, factors_at, newton_refine, rounding_of
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import Pose, blocked
from pointcoord.solve.proven_step import hidden, prove_segment
from pointcoord.solve.status import COMPLETE, Status
from pointcoord.solve.step_rule import COARSEST, SAFE, Settings, lengths_by_sizes, log_sizes, order_for
from pointcoord.time_functions import TimeFunction

# A motion stops where a segment would be shorter than this share of the motion. Near a singular pose lengths
# shrink in proportion to the time that is left, so the instant of that pose is then known to as many digits.
SHORTEST = 1e-15
# A motion of more segments would take more than about ten seconds. It is refused, with that reason.
MOST_SEGMENTS = 2000
# Number of segments after which the number of segments of the whole motion is estimated.
TELLING = 64
# A pose with a smaller condition number is far from any lock.
REGULAR = 1e3
# Shortest unit of time of a series, s, and the limit of a unit raised to its order, 2^-SMALLEST. The limit is
# so far above the smallest number, 2^-1022, that no coefficient is lost, however short the motion.
SHORTEST_UNIT, SMALLEST = 2.0**-50, 1000
# Coefficients up to this size leave room for a length in mm and for its derivatives. If the unit of time is
# so long that a coefficient is larger, a shorter unit is found from the first few coefficients.
LARGEST, FEW = 2.0**900, 8
# A member whose terms allow less than this share of the median length leaves the others: following all of
# them with its short segments would take twice as long as following this member separately.
STANDS_OUT = 0.5
# Share of the tolerance that the pose at the end of a segment may be off when Newton's method stops.
SOLVED = 0.1


@dataclass(frozen=True)
class Segment:
    """One series: y(start + s scale) = sum_k coefficients[k] s^k until `stop`.

    Attributes:
        start, stop: first and last instant, s.
        scale: unit of time, s.
        coefficients: shape (..., order + 1, size), in the mechanism's units.
        left: proven distance of the pose at `start` to the exact assembly, without rounding, shape (...,).
    """

    start: float
    stop: float
    scale: float
    coefficients: Array
    left: Array | float = 0.0

    @property
    def order(self) -> int:
        """Order of the series."""
        return int(self.coefficients.shape[-2]) - 1

    def taken(self, members: Indices) -> Self:
        """The segment of some members of a batch of one dimension."""
        left = np.broadcast_to(self.left, self.coefficients.shape[:1])[members]
        return replace(self, coefficients=self.coefficients[members], left=left)


@dataclass(frozen=True)
class Chain:
    """Segments in order of time, the work that they took, and how the chain ended.

    A chain has no segments where the motion cannot leave its start.
    """

    segments: tuple[Segment, ...]
    work: Work
    status: Status = COMPLETE

    @property
    def stop(self) -> float:
        """The last instant, s."""
        return self.segments[-1].stop


def build_chain(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    settings: Settings,
) -> Chain:
    """Follow the inputs from an assembled pose. The poses of a batch share the segments.

    Args:
        functions: the inputs as functions of time.
        pose: the pose at `start`, any leading batch dimensions.
    Returns:
        The chain up to `stop`, or up to a pose that the motion cannot pass, up to MOST_SEGMENTS, or up to an
        instant where no step follows an input though the mechanism could. The status states which.
    """
    return _Course(mechanism, functions, start, stop, settings.kept).build(pose, leaving=False)[0]


def build_chains(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    settings: Settings,
) -> list[tuple[Indices, Chain]]:
    """Chains for a batch of one dimension, each with the numbers of the members that share the chain.

    A member leaves its chain if it needs much shorter segments than the others, or if its end of a segment is
    not confirmed. The members that left are followed together in a further chain, until no member is left.
    """
    found: list[tuple[Indices, Chain]] = []
    waiting = [np.arange(len(pose.y))] if len(pose.y) else []
    while waiting:
        members = waiting.pop()
        course = _Course(mechanism.taken(members), functions, start, stop, settings.kept)
        chain, kept = course.build(pose.taken(members), leaving=len(members) > 1)
        stopped = chain.status.stopped
        too_long = isinstance(stopped, NotFollowed) and not stopped.name
        if len(kept) > 1 and not (chain.status.complete or too_long):
            # Following the members one by one shows which of them stopped.
            waiting += [members[[place]] for place in kept.tolist()]
        else:
            found.append((members[kept], chain))
        if len(kept) < len(members):
            waiting.append(np.delete(members, kept))
    return found


@dataclass(frozen=True)
class _Joint:
    """An assembled pose, or a batch of them, from which a segment starts.

    Attributes:
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y.
        left: proven distance to the exact assembly, without rounding, shape (...,), in units.
        instant: its instant, s.
        known: series of the mechanism's known coordinates about the instant, (..., order + 1, known).
        scale: unit of time for the segment, s: about the length of the segment before.
    """

    y: Array
    factors: Factors
    left: Array
    instant: float
    known: Array
    scale: float

    @property
    def members(self) -> int:
        """Number of poses in the batch."""
        return self.factors.condition.size

    def taken(self, members: Indices) -> Self:
        """The poses of some members, by number."""
        factors, left = self.factors.taken(members), self.left[members]
        return replace(self, y=self.y[members], factors=factors, left=left, known=self.known[members])


@dataclass(frozen=True)
class _Course:
    """The task of a chain: a mechanism, its inputs over a time, and the tolerance."""

    mechanism: Mechanism
    functions: Mapping[str, TimeFunction]
    start: float
    stop: float
    settings: Settings

    def build(self, pose: Pose, leaving: bool) -> tuple[Chain, Indices]:
        """The chain, and the numbers of the members that it holds for.

        Args:
            leaving: whether members may leave the chain; then the pose has one batch dimension.
        """
        course, start, stop, tolerance = self, self.start, self.stop, self.settings.tolerance
        scale = power_of_two(stop - start)
        joint = _Joint(pose.y, pose.factors, pose.left, start, self.known(start), scale)
        segments: list[Segment] = []
        work = Work()
        kept = np.arange(joint.members)

        def chain(status: Status) -> tuple[Chain, Indices]:
            return Chain(tuple(segments), work, status), kept

        def too_many(reached: float) -> NotFollowed:
            return NotFollowed(reached, limit=MOST_SEGMENTS, start=start, stop=stop)

        ambiguous = hidden(self.mechanism.map, joint.y, joint.factors)
        if start < stop and ambiguous.any():
            return chain(course.stops_at(joint, ambiguous, coarsest=False))
        while joint.instant < stop or not segments:
            if len(segments) == MOST_SEGMENTS:
                return chain(Status(too_many(joint.instant)))
            if len(segments) == TELLING and not self.settings.hopeful:
                # Refused if even segments four times as long on average would be too many.
                likely = start + MOST_SEGMENTS / TELLING * (joint.instant - start)
                if stop - start > 4.0 * (likely - start):
                    return chain(Status(too_many(likely)))
            segment, lengths = course.segment_from(joint)
            solves = segment.order * joint.members
            work += Work(
                segments=1,
                series_orders=segment.order,
                rate_solves=solves,
                unknowns_solved=solves * self.mechanism.map.unknowns,
            )
            staying = np.asarray(np.isfinite(segment.coefficients).all(axis=(-2, -1)))
            if leaving:
                staying = staying & ~(lengths < STANDS_OUT * np.median(lengths))
            coarsest = tolerance >= COARSEST and bool(staying.all())
            if staying.all() and start == stop:
                segments.append(segment)
                break
            if staying.all():
                end, staying, spent = course.step_along(segment, float(lengths.min()), joint, leaving)
                work += spent
                if end is not None:
                    segments.append(replace(segment, stop=end.instant))
                    joint = end
                    continue
            if not (leaving and staying.any()):
                return chain(course.stops_at(joint, ~staying, coarsest))
            numbers = np.flatnonzero(staying)
            kept, joint = kept[numbers], joint.taken(numbers)
            segments = [each.taken(numbers) for each in segments]
            course = replace(course, mechanism=course.mechanism.taken(numbers))
        return chain(COMPLETE)

    @property
    def shortest(self) -> float:
        """The shortest segment, s. A shorter one would be lost in the rounding of its instants."""
        largest = max(abs(self.start), abs(self.stop))
        return max(SHORTEST * (self.stop - self.start), 4.0 * EPS * largest)

    @cached_property
    def driven(self) -> list[int]:
        """Places of the driven coordinates among the known ones."""
        return [place - self.mechanism.map.unknowns for place in self.mechanism.topology.driven]

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Instants at which a derivative of a law jumps."""
        return tuple(b for function in self.functions.values() for b in function.breaks)

    @cached_property
    def order(self) -> int:
        """Order of the series."""
        least = max(self.settings.derivative, 1)
        return least if self.start == self.stop else order_for(self.settings.tolerance)

    def known(self, instant: float) -> Array:
        """Series of the mechanism's known coordinates about an instant, shape (..., order + 1, known).

        If the rates of a law are too large for numbers at that order, the order is SAFE.
        """
        if self.order > SAFE:
            try:
                return self.known_to(instant, self.order)
            except InputOutOfRange:
                pass
        return self.known_to(instant, min(self.order, SAFE))

    def known_to(self, instant: float, order: int) -> Array:
        """Series of the mechanism's known coordinates about an instant, of a given order."""
        laws = {name: function.series(instant, order) for name, function in self.functions.items()}
        return self.mechanism.known_series(laws)

    def next_break(self, instant: float) -> float:
        """The next instant at which a derivative of an input jumps: the inputs are analytic up to there."""
        return min((b for b in self.breaks if instant < b < self.stop), default=self.stop)

    def segment_from(self, joint: _Joint) -> tuple[Segment, Array]:
        """The series about a joint, up to `stop`, and the lengths that its members allow, s, (members,)."""
        segment = self.series_about(joint)
        if not (np.abs(segment.coefficients) < LARGEST).all():
            few = replace(joint, known=joint.known[..., : FEW + 1, :])
            shortest = float(self.lengths(self.series_about(few)).min())
            segment = self.series_about(replace(joint, scale=power_of_two(min(shortest, joint.scale))))
        return segment, self.lengths(segment)

    def lengths(self, segment: Segment) -> Array:
        """The longest segment that each member's terms allow, s, (members,); infinite for a polynomial."""
        logs = log_sizes(segment.coefficients[..., : self.mechanism.map.unknowns])
        return lengths_by_sizes(logs, self.settings) * segment.scale

    def series_about(self, joint: _Joint) -> Segment:
        """The series about a joint, of the order of the known coordinates there.

        The unit of time is at most that of the joint, or SHORTEST_UNIT. It is so small that no coefficient of
        a driven coordinate exceeds the mechanism's size. So no product of two series overflows, however fast
        the inputs are.
        """
        scale = max(joint.scale, SHORTEST_UNIT)
        # The rates of very slow or fast inputs, in 1/s^k, are finite and not zero up to some order k only.
        order = min(joint.known.shape[-2] - 1, max(SAFE, int(SMALLEST / max(abs(np.log2(scale)), 1.0))))
        known, orders = joint.known[..., : order + 1, :], np.arange(order + 1.0)
        size = np.abs(known[..., 1:, self.driven]).max(axis=(*range(known.ndim - 2), -1))
        with np.errstate(over="ignore", divide="ignore"):
            fastest = float((size ** (-1.0 / orders[1:])).min())
        if fastest < scale:
            scale = power_of_two(fastest)
        # Within rounding of a singular pose the unknown coordinates still overflow: then no step is found.
        with np.errstate(over="ignore", invalid="ignore"):
            series = expand(self.mechanism.map, joint.factors, joint.y, known * (scale**orders)[:, None])
        return Segment(joint.instant, self.stop, scale, series, joint.left)

    def step_along(
        self, segment: Segment, length: float, joint: _Joint, leaving: bool
    ) -> tuple[_Joint | None, Flags, Work]:
        """Shorten a segment until Newton's method confirms its end and it is proven to stay on one branch.

        Args:
            length: first length to try, s, the one that the terms allow.
            leaving: whether the confirmation of some members is enough.
        Returns:
            The joint at the end, None unless all members are confirmed; the confirmed members; and the work.
        """
        system, limit, tolerance = self.mechanism.map, self.next_break(joint.instant), self.settings.tolerance
        order, solved, work = np.arange(segment.order + 1.0), SOLVED * tolerance, Work()
        begun = system.residual(segment.coefficients[..., 0, :])
        good = np.zeros(joint.y.shape[:-1], dtype=bool)
        while length >= self.shortest or joint.instant + length >= limit:
            end = limit if joint.instant + length >= limit else joint.instant + length
            known = self.known(end) if end < self.stop else self.known_to(end, 0)
            s = (end - segment.start) / segment.scale
            guess = s**order @ segment.coefficients
            guess[..., system.unknowns :] = known[..., 0, :]
            reached = newton_refine(system, guess, tolerance=solved)
            good = confirmed(system, reached, tolerance, partial(self.law_noise, reached, end), leaving)
            work += reached.work
            if good.any():
                proof = prove_segment(system, segment.coefficients, s, begun)
                good = good & proof.holds
                good = good & proof.within(np.abs(reached.y - guess)[..., : system.unknowns])
                ahead, factorised = factors_at(system, reached, solved)
                work += factorised
                if end < self.stop:
                    good = good & ~hidden(system, reached.y, ahead)
                if good.all():
                    scale = power_of_two(length if np.isfinite(length) else end - joint.instant)
                    return _Joint(reached.y, ahead, reached.left, end, known, scale), good, work
                if leaving and good.any():
                    break
            length = 0.5 * (end - joint.instant)
        return None, good, work

    def law_noise(self, reached: Converged, end: float) -> Array:
        """The largest change of any coordinate by the rounding of the inputs' laws, shape (...,)."""
        off = {name: function.rounding(np.array(end)) for name, function in self.functions.items()}
        if not any(rounding.any() for rounding in off.values()):
            return np.zeros(reached.y.shape[:-1])
        _, data = self.mechanism.known_data(reached.y, off)
        rows = self.mechanism.map.uncertainty(reached.y, data)
        return np.asarray(np.matvec(np.abs(reached.factors.preconditioner), rows).max(axis=-1))

    def stops_at(self, joint: _Joint, unfinished: Flags, coarsest: bool) -> Status:
        """The reason why no segment leads on from a joint.

        Args:
            unfinished: the members of the batch that have no next segment.
            coarsest: whether no larger tolerance is left to try.
        """
        instant = joint.instant
        goal = self.known_to(min(self.stop, instant + 1e-6 * (self.stop - instant)), 0)[..., 0, :]
        # The difference between that goal and the pose may be nothing but rounding. The direction is taken
        # from the laws instead: their first rate that is not zero.
        laws = self.known_to(instant, 4)
        moving = [laws[..., k, :] for k in range(1, 5) if laws[..., k, :].any()]
        change = moving[0] if moving else np.zeros_like(laws[..., 0, :])
        problem = "the motion cannot pass a singular pose"
        # Members share their segments. Where these become too short, the member nearest to a lock is blamed.
        condition = np.where(unfinished, joint.factors.condition, 0.0)
        unfinished = unfinished & (condition >= condition.max())
        error = blocked(self.mechanism, problem, joint.y, joint.factors, goal, unfinished, instant, change)
        # Near a lock the condition number has grown as the inverse root of the shortest step.
        locked = error.condition > REGULAR
        return Status(error if locked else NotFollowed(instant, name=error.reduce, coarsest=coarsest))


def confirmed(
    system: QuadraticMap,
    reached: Converged,
    tolerance: float,
    law_noise: Callable[[], Array] | None = None,
    leaving: bool = True,
) -> Flags:
    """Whether solved ends agree with the ends of the series, up to a tolerance, shape (...,).

    Args:
        law_noise: the largest change of any coordinate by the rounding of the inputs' laws, shape (...,).
        leaving: whether the confirmation of some members is enough.
    """
    # A Newton step that is only rounding is no truncation error, however small the tolerance.
    good = reached.converged & (reached.first_step <= tolerance)
    if not good.all() and (leaving or reached.converged.all()):
        noise = rounding_of(system, reached) + (law_noise() if law_noise is not None else 0.0)
        good = reached.converged & (reached.first_step <= tolerance + 2.0 * noise)
    return np.asarray(good)


def power_of_two(length: float) -> float:
    """The power of two at or above a length, so that scaling by it rounds nothing; 1 for zero."""
    return float(np.ldexp(1.0, np.frexp(length)[1])) if length > 0.0 else 1.0
