r"""A motion as a chain of short power series.

A segment is as long as its last two terms allow: at its end they, and what they contribute to the
derivatives that are asked for, are below the tolerance relative to the size of that derivative. The
terms that were left out are smaller still. The end is then solved by Newton, which starts the next
segment without inherited error and shows what the error was; a segment that missed, or that ended on
another branch (see `branch`), is halved.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.branch import on_branch, orientation
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import Converged, newton_refine
from pointcoord.numerics.power_series import expand
from pointcoord.numerics.rounding import EPS
from pointcoord.solve.assembly import Pose, blocked
from pointcoord.solve.status import COMPLETE, Status, TooLong, TooRough
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]

# A motion stops where a segment is this much shorter than the whole: near a singular pose lengths
# shrink in proportion to the time that is left, so its place is then known to as many digits.
SHORTEST = 1e-15
# A smaller truncation than this, relative to a derivative's size, drowns in the rounding of its sum.
FINEST = 4.0 * EPS
# A larger one could take a neighbouring branch for the same motion, and would hardly save a segment.
COARSEST = 1e-6
# A motion of more segments would take more than some ten seconds; it is refused with that reason.
MOST_SEGMENTS = 2000
# A pose with a smaller condition number is far from any lock.
REGULAR = 1e3
# Unit of time of a series, s, at least: raised to an order of 20 it stays far above the smallest
# number, 2^-1022, so that no coefficient is lost in a motion however short.
SHORTEST_UNIT = 2.0**-50
# Trial lengths of a segment, in units of where its last terms grow as large as earlier ones.
TRIALS = np.geomspace(1.0, 1e-5, 160)


@dataclass(frozen=True)
class Segment:
    """One series: y(start + s scale) = sum_k coefficients[k] s^k until `stop`.

    Attributes:
        start, stop: s. scale: unit of time, s.
        coefficients: shape (..., order + 1, size), in the mechanism's units.
    """

    start: float
    stop: float
    scale: float
    coefficients: Array


@dataclass(frozen=True)
class Chain:
    """Segments in order of time, what they cost, and how the last one ended.

    There is none where the motion cannot leave its start.
    """

    segments: tuple[Segment, ...]
    work: Work
    status: Status = COMPLETE

    @property
    def stop(self) -> float:
        """The last instant, s."""
        return self.segments[-1].stop


@dataclass(frozen=True)
class Settings:
    """How a chain is cut.

    Attributes:
        tolerance: allowed truncation, in the mechanism's units, between 4 eps and 1e-6; for a derivative
            the same fraction of that derivative's size.
        derivative: highest time derivative that will be evaluated.
        order: of each series.
    """

    tolerance: float
    derivative: int
    order: int = 20


def build_chain(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    settings: Settings,
) -> Chain:
    """Follow the inputs from an assembled pose; a batch of poses shares its segments.

    Args:
        functions: the inputs as functions of time.
        pose: assembled at `start`, any leading batch dimensions.
    Returns:
        The chain up to `stop`, or up to a pose that the motion cannot pass, to the most segments, or to where
        no step follows an input though the mechanism could; its status says which.
    """
    settings = replace(settings, tolerance=min(max(settings.tolerance, FINEST), COARSEST))
    course = _Course(mechanism, functions, start, stop, settings)
    # Of the pose itself, whatever place its own factors are of.
    joint = _Joint(start, pose.y, factorise(mechanism.map.jacobian(pose.y)), _power_of_two(stop - start))
    side, members = orientation(joint.factors), joint.members
    work = Work(factorisations=members)
    segments: list[Segment] = []

    def chain(status: Status) -> Chain:
        return Chain(tuple(segments), work, status)

    while joint.instant < stop or not segments:
        if len(segments) == MOST_SEGMENTS:
            return chain(TooLong(MOST_SEGMENTS, joint.instant, start, stop))
        segment = course.segment_from(joint)
        orders = settings.order
        work += Work(segments=1, series_orders=orders, rate_solves=orders * members)
        finite = np.asarray(np.isfinite(segment.coefficients).all(axis=(-2, -1)))
        if not finite.all():
            return chain(course.stops_at(joint, ~finite, coarsest=False))
        if start == stop:
            segments.append(segment)
            break
        step = course.step_along(segment, joint, side)
        work += step.work
        if step.end is None:
            return chain(course.stops_at(joint, ~step.good, coarsest=settings.tolerance >= COARSEST))
        segments.append(replace(segment, stop=step.end.instant))
        joint = step.end
    return chain(COMPLETE)


@dataclass(frozen=True)
class _Joint:
    """An assembled pose from which a segment starts.

    Attributes:
        y: coordinates, shape (..., size). factors: of C_u there.
        scale: a unit of time for the segment, s, as long as the one before it.
    """

    instant: float
    y: Array
    factors: Factors
    scale: float

    @property
    def members(self) -> int:
        """How many poses it is."""
        return int(np.prod(self.y.shape[:-1]))


@dataclass(frozen=True)
class _Step:
    """How a segment was cut: its end, or which members of the batch have none, and what that cost."""

    end: _Joint | None
    good: NDArray[np.bool_]
    work: Work


@dataclass(frozen=True)
class _Course:
    """What a chain follows, a mechanism and its inputs over a time, and how finely."""

    mechanism: Mechanism
    functions: Mapping[str, TimeFunction]
    start: float
    stop: float
    settings: Settings

    @property
    def shortest(self) -> float:
        """The shortest segment, s; still shorter ones are lost in the rounding of the instant itself."""
        largest = max(abs(self.start), abs(self.stop))
        return max(SHORTEST * (self.stop - self.start), 4.0 * EPS * largest)

    def known(self, instant: float, order: int) -> Array:
        """Series of the known coordinates about an instant, shape (..., order + 1, known coordinates)."""
        laws = {name: function.series(instant, order) for name, function in self.functions.items()}
        return self.mechanism.known_series(laws)

    def next_break(self, instant: float) -> float:
        """Up to where the inputs are analytic: the next instant at which a derivative of one jumps."""
        breaks = {b for function in self.functions.values() for b in function.breaks}
        return min((b for b in breaks if instant < b < self.stop), default=self.stop)

    def segment_from(self, joint: _Joint) -> Segment:
        """The series about a joint, not yet cut.

        Its unit of time is at most the joint's, or SHORTEST_UNIT, and small enough for no known coefficient
        to exceed the mechanism's size, so that no product of two series overflows however fast the inputs
        are.
        """
        order = self.settings.order
        known = self.known(joint.instant, order)
        scale = max(joint.scale, SHORTEST_UNIT)
        size = np.abs(known[..., 1:, :]).max(axis=tuple(i for i in range(known.ndim) if i != known.ndim - 2))
        orders = np.arange(order + 1.0)
        if size.any():
            with np.errstate(over="ignore"):
                fastest = float(np.min(size[size > 0.0] ** (-1.0 / orders[1:][size > 0.0])))
            scale = min(scale, _power_of_two(min(fastest, scale)))
        # Within rounding of a singular pose the unknown ones overflow all the same: no step is found then.
        with np.errstate(over="ignore", invalid="ignore"):
            scaled = known * (scale**orders)[:, None]
            series = expand(self.mechanism.map, joint.factors, joint.y, scaled)
        return Segment(joint.instant, self.stop, scale, series)

    def step_along(self, segment: Segment, joint: _Joint, side: Array) -> _Step:
        """Cut a segment where its last terms say, or shorter: until Newton's method confirms its end.

        Args:
            side: orientation of the branch, which the end must have.
        """
        system, limit = self.mechanism.map, self.next_break(joint.instant)
        length = _length(segment.coefficients[..., : system.unknowns], self.settings) * segment.scale
        good, work = np.zeros(joint.y.shape[:-1], dtype=bool), Work()
        while length >= self.shortest or joint.instant + length >= limit:
            end = limit if joint.instant + length >= limit else joint.instant + length
            reached = self.solved_end(segment, end)
            work += reached.work
            # What rounding alone makes of a step is no truncation, however small the tolerance.
            noise = reached.noise + self.law_noise(reached, end)
            good = reached.converged & (reached.first_step <= self.settings.tolerance + 2.0 * noise)
            if good.all():
                ahead = factorise(system.jacobian(reached.y))
                work += Work(factorisations=joint.members)
                s = (end - segment.start) / segment.scale
                good = on_branch(system, side, segment.coefficients, s, reached, ahead)
            if good.all():
                return _Step(_Joint(end, reached.y, ahead, _power_of_two(length)), good, work)
            length = 0.5 * (end - joint.instant)
        return _Step(None, good, work)

    def solved_end(self, segment: Segment, end: float) -> Converged:
        """The end of a segment, by the series and then by Newton."""
        s, series = (end - segment.start) / segment.scale, segment.coefficients
        guess = np.einsum("k,...ki->...i", s ** np.arange(series.shape[-2]), series)
        guess[..., self.mechanism.map.unknowns :] = self.known(end, 0)[..., 0, :]
        return newton_refine(self.mechanism.map, guess)

    def law_noise(self, reached: Converged, end: float) -> Array:
        """What the rounding of the inputs' laws may move any coordinate by, shape (...,)."""
        off = {name: function.rounding(np.array(end)) for name, function in self.functions.items()}
        if not any(doubt.any() for doubt in off.values()):
            return np.zeros(reached.y.shape[:-1])
        _, data = self.mechanism.known_data(reached.y, off)
        rows = self.mechanism.map.uncertainty(reached.y, data)
        return np.asarray((np.abs(reached.factors.preconditioner) @ rows[..., None])[..., 0].max(axis=-1))

    def stops_at(self, joint: _Joint, unfinished: NDArray[np.bool_], coarsest: bool) -> Status:
        """Why no segment leads on from a joint.

        Args:
            unfinished: the members of the batch that have none.
            coarsest: whether no larger tolerance is left to try.
        """
        instant = joint.instant
        goal = self.known(min(self.stop, instant + 1e-6 * (self.stop - instant)), 0)[..., 0, :]
        # What is left of the way to that goal may be nothing but rounding; what the laws say is not: the
        # first of their rates that is not zero.
        laws = self.known(instant, 4)
        moving = [laws[..., k, :] for k in range(1, 5) if laws[..., k, :].any()]
        change = moving[0] if moving else np.zeros_like(laws[..., 0, :])
        problem = "the motion cannot pass a singular pose"
        status = blocked(self.mechanism, problem, joint, goal, unfinished, instant, change)
        # Near a lock the condition number has grown as the inverse root of the shortest step.
        return status if status.condition > REGULAR else TooRough(status.reduce, instant, coarsest)


def _length(series: Array, settings: Settings) -> float:
    r"""Length of a segment in its own time unit; the shortest that a member of the batch needs.

    With c_k the largest k-th coefficient, the d-th derivative of the last two terms at s is
    k!/(k-d)! c_k s^(k-d); it must not exceed tolerance times the size of the d-th derivative,
    max_k k!/(k-d)! c_k s^(k-d) (for d = 0: the mechanism's size, 1).
    """
    size = np.abs(series).max(axis=-1).reshape(-1, series.shape[-2])
    size[:, 0] = 1.0
    if not (size[:, -2:] > 0.0).any():
        return np.inf
    # In logarithms no power is too large or too small for the arithmetic, and a missing term stays one.
    with np.errstate(divide="ignore"):
        logs = np.log(size)
    known = np.maximum(logs, np.log(np.finfo(float).tiny))
    orders = np.arange(size.shape[-1], dtype=float)
    # Where the last terms grow as large as any earlier one: any useful segment is shorter.
    first = min(settings.derivative, 1)
    equal = (known[:, None, first:-2] - known[:, -2:, None]) / (orders[-2:, None] - orders[first:-2])
    trials = np.min(equal.max(axis=-1)) + np.log(TRIALS)
    fits = np.ones(len(trials), dtype=bool)
    falling = np.zeros_like(orders)
    for d in range(settings.derivative + 1):
        terms = logs[:, None, d:] + falling[d:] + (orders[d:] - d) * trials[:, None]
        whole = np.zeros(terms.shape[:2]) if d == 0 else terms.max(axis=-1)
        last = np.logaddexp(terms[..., -2], terms[..., -1])
        fits &= (last <= np.log(settings.tolerance) + whole).all(axis=0)
        falling[d + 1 :] += np.log(orders[d + 1 :] - d)
    with np.errstate(over="ignore"):
        return float(np.exp(trials[np.argmax(fits) if fits.any() else -1]))


def _power_of_two(length: float) -> float:
    """The power of two at or above a length, so that scaling by it rounds nothing; 1 for zero."""
    return float(np.ldexp(1.0, np.frexp(length)[1])) if length > 0.0 else 1.0
