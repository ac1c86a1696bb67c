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
from pointcoord.numerics.newton import Converged, polish
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
    breaks = sorted({b for f in functions.values() for b in f.breaks if start < b < stop} | {stop})
    y, members = pose.y, int(np.prod(pose.y.shape[:-1]))
    # Newton's factors are of the place before its last step, which may be farther off than the bound.
    factors, work = factorise(mechanism.map.jacobian(y)), Work(factorisations=members)
    scale = _power_of_two(stop - start)
    segments: list[Segment] = []
    instant, side = start, orientation(factors)
    # Shorter steps in time than this are lost in the rounding of the instant itself.
    shortest = max(SHORTEST * (stop - start), 4.0 * EPS * max(abs(start), abs(stop)))
    while instant < stop or not segments:
        if len(segments) == MOST_SEGMENTS:
            return Chain(tuple(segments), work, TooLong(MOST_SEGMENTS, instant, start, stop))
        limit = next((b for b in breaks if b > instant), stop)
        series, scale = _expand(mechanism, functions, y, factors, instant, scale, settings.order)
        work += Work(
            segments=1,
            series_orders=settings.order,
            rate_solves=settings.order * members,
        )
        finite = np.asarray(np.isfinite(series).all(axis=(-2, -1)))
        if not finite.all():
            status = _cannot_pass(mechanism, functions, y, factors, ~finite, instant, stop, False)
            return Chain(tuple(segments), work, status)
        if limit == instant:
            segments.append(Segment(instant, stop, scale, series))
            break
        length = _length(series[..., : mechanism.map.unknowns], settings) * scale
        good = np.zeros(y.shape[:-1], dtype=bool)
        while length >= shortest or instant + length >= limit:
            end = limit if instant + length >= limit else instant + length
            s = (end - instant) / scale
            reached = _end(mechanism, functions, series, end, s)
            work += reached.work
            # What rounding alone makes of a step is no truncation, however small the tolerance.
            noise = reached.noise + _law_noise(mechanism, functions, reached, end)
            good = reached.converged & (reached.first_step <= settings.tolerance + 2.0 * noise)
            if good.all():
                ahead = factorise(mechanism.map.jacobian(reached.y))
                work += Work(factorisations=members)
                good = on_branch(mechanism.map, side, series, s, reached, ahead)
            if good.all():
                break
            length = 0.5 * (end - instant)
        else:
            coarsest = settings.tolerance >= COARSEST
            status = _cannot_pass(mechanism, functions, y, factors, ~good, instant, stop, coarsest)
            return Chain(tuple(segments), work, status)
        segments.append(Segment(instant, end, scale, series))
        instant, y, factors = end, reached.y, ahead
        scale = _power_of_two(length)
    return Chain(tuple(segments), work)


def _expand(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    y: Array,
    factors: Factors,
    instant: float,
    scale: float,
    order: int,
) -> tuple[Array, float]:
    """The series about an instant and its unit of time, at most `scale` or SHORTEST_UNIT.

    The unit is small enough for no known coefficient to exceed the mechanism's size, so that no product
    of two series overflows however fast the inputs are.
    """
    known = mechanism.known_series({name: f.series(instant, order) for name, f in functions.items()})
    scale = max(scale, SHORTEST_UNIT)
    size = np.abs(known[..., 1:, :]).max(axis=tuple(i for i in range(known.ndim) if i != known.ndim - 2))
    orders = np.arange(order + 1.0)
    if size.any():
        with np.errstate(over="ignore"):
            fastest = float(np.min(size[size > 0.0] ** (-1.0 / orders[1:][size > 0.0])))
        scale = min(scale, _power_of_two(min(fastest, scale)))
    # Within rounding of a singular pose the unknown ones overflow all the same: no step is found then.
    with np.errstate(over="ignore", invalid="ignore"):
        return expand(mechanism.map, factors, y, known * (scale**orders)[:, None]), scale


def _end(
    mechanism: Mechanism, functions: Mapping[str, TimeFunction], series: Array, end: float, s: float
) -> Converged:
    """The end of a segment, by the series and then by Newton."""
    guess = np.einsum("k,...ki->...i", s ** np.arange(series.shape[-2]), series)
    known = mechanism.known_series({name: f.series(end, 0) for name, f in functions.items()})
    guess[..., mechanism.map.unknowns :] = known[..., 0, :]
    return polish(mechanism.map, guess)


def _law_noise(
    mechanism: Mechanism, functions: Mapping[str, TimeFunction], reached: Converged, end: float
) -> Array:
    """What the rounding of the inputs' laws may move any coordinate by, shape (...,)."""
    off = {name: f.rounding(np.array(end)) for name, f in functions.items()}
    if not any(doubt.any() for doubt in off.values()):
        return np.zeros(reached.y.shape[:-1])
    _, data = mechanism.known_data(reached.y, off)
    rows = mechanism.map.uncertainty(reached.y, data)
    return np.asarray((np.abs(reached.factors.preconditioner) @ rows[..., None])[..., 0].max(axis=-1))


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


def _cannot_pass(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    y: Array,
    factors: Factors,
    unfinished: NDArray[np.bool_],
    instant: float,
    stop: float,
    coarsest: bool,
) -> Status:
    ahead = min(stop, instant + 1e-6 * (stop - instant))
    goal = mechanism.known_series({name: f.series(ahead, 0) for name, f in functions.items()})[..., 0, :]
    # What is left of the way to `ahead` may be nothing but rounding; what the laws say is not: the first of
    # their rates that is not zero.
    laws = mechanism.known_series({name: f.series(instant, 4) for name, f in functions.items()})
    moving = [laws[..., k, :] for k in range(1, 5) if laws[..., k, :].any()]
    change = moving[0] if moving else np.zeros_like(laws[..., 0, :])
    problem = "the motion cannot pass a singular pose"
    status = blocked(mechanism, problem, y, goal, factors, unfinished, instant, change)
    # Near a lock the condition number has grown as the inverse root of the shortest step.
    if status.condition > REGULAR:
        return status
    return TooRough(status.reduce, instant, coarsest)
