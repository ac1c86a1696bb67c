r"""A map of the inputs along the way that they take over some time: a motion without a series in time.

What moves depends on time through the inputs only, so patches that cover the way of the inputs (see `path`)
hold the whole motion, however long or rough it is. They are grown from the pose at the start of the motion,
and only where the way leads. Where the way meets what no patch covers, the motion ends:

- the start lies on a patch, and the pose there is the one at hand: it is nearer to the patch's assembly than
  any other is;
- every box that the way touches until then is covered, and patches that share a part of a face are the same
  assembly there (see `flood`). A way through a corner touches the boxes on both sides of it.

So every pose until then is on the branch of the start, as a path in time would have found.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import Limits, Patches, flood, unknowns_at
from pointcoord.patches.lookup import Lookup, Marked
from pointcoord.patches.path import covered_until, way_of
from pointcoord.solve.assembly import Pose
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# How often a range is halved at most, by how many inputs move: 65,536 to 262,144 of the smallest boxes.
HALVINGS = {1: 16, 2: 9, 3: 6}
# Patches of one motion, and factorisations that are spent on them: some seconds.
MOST, ENOUGH = 1024, 40000
# Orders: fewer show nothing, more gain little; of three inputs 12 are 455 powers.
LEAST_ORDER, MOST_DIGITS, MOST_ORDER = 6, 16, {1: 20, 2: 20, 3: 12}
# Least width of a range, in parts of its size or of 1, of an input that hardly moves.
NARROWEST = 2.0**-20

NOWHERE = "the pose at the start cannot be proven to be the patch's"
MANY = "more than three inputs move at once"


@dataclass(frozen=True)
class WayMap:
    """Patches along the way of the inputs.

    Attributes:
        patches: None where nothing could be proven.
        until: the way is covered up to here, s; minus infinity where its start is not.
        reason: why not further; empty where all of it is covered.
        work: what making it took.
    """

    domain: Domain
    order: int
    limits: Limits
    patches: Patches | None
    until: float
    reason: str
    work: Work

    @property
    def notes(self) -> tuple[str, ...]:
        """Where rounding alone keeps a patch from being as near as was asked."""
        if self.patches is None:
            return ()
        bounds = self.patches.off.value.max(axis=-1)
        count = int(np.count_nonzero(bounds > self.limits.tolerance))
        if not count:
            return ()
        return (
            f"rounding keeps {count} of {len(bounds)} patches of the map from being proven to the tolerance "
            f"everywhere: positions to {bounds.max():.2g} mm",
        )

    @property
    def lookup(self) -> Lookup:
        """Which patch each of the smallest boxes lies in."""
        assert self.patches is not None  # nothing is looked up where nothing is covered
        return Lookup.of(self.domain, self.patches.low, self.patches.high)


def map_way(
    mechanism: Mechanism,
    functions: Mapping[str, TimeFunction],
    pose: Pose,
    start: float,
    stop: float,
    limits: Limits,
    effort: int | None = None,
) -> WayMap:
    """Cover the way of the inputs from an assembled pose on.

    Args:
        functions: of the inputs that drive the mechanism.
        pose: assembled at `start`.
        effort: factorisations after which nothing more is tried; `ENOUGH` if not given.
    Raises:
        InputOutOfRange: an input that on its way leaves the values for which it has a meaning.
    """
    spans = way_of(functions, start, stop)
    ranges: dict[str, tuple[float, float]] = {}
    for i, (name, law) in enumerate(functions.items()):
        low, high = float(spans.low[:, i].min()), float(spans.high[:, i].max())
        # At a single instant an input has one value, and may have rates.
        still = low == high and not law.series(spans.first, 2)[..., 1:].any()
        ranges[name] = (low, high) if still else widened(low, high)
    if all(low == high for low, high in ranges.values()):
        # A map has an input.
        name = next(iter(ranges))
        ranges[name] = widened(*ranges[name])
    moving = [name for name, (low, high) in ranges.items() if low < high]
    order = order_for(limits.tolerance, float(mechanism.unit), limits.derivative, len(moving))
    domain = Domain(mechanism, ranges, HALVINGS.get(len(moving), 0))
    if len(moving) not in HALVINGS:
        return WayMap(domain, order, limits, None, -np.inf, MANY, Work())
    domain.known_at(np.stack(domain.ends))
    columns = [list(functions).index(name) for name in domain.free]
    spans = type(spans)(spans.first, spans.last, spans.low[:, columns], spans.high[:, columns])
    wanted = Marked.touched_by(domain, spans.low, spans.high)
    first = np.array([float(functions[name].series(start, 0)[..., 0]) for name in domain.free])
    least, most = domain.ends
    twice = np.clip(np.round((first - least) / (most - least) * 2 * domain.parts), 0, 2 * domain.parts)
    cover = flood(
        domain,
        order,
        limits,
        (twice.astype(np.int64), pose.y),
        MOST,
        wanted,
        ENOUGH if effort is None else effort,
    )
    reasons = tuple(dict.fromkeys(reason for _, reason in cover.given_up))
    patches = cover.patches
    if patches is None:
        return WayMap(domain, order, limits, None, -np.inf, reasons[0], cover.work)
    lookup = Lookup.of(domain, patches.low, patches.high)
    if not starts_on(domain, order, patches, lookup, first, pose.y):
        return WayMap(domain, order, limits, patches, -np.inf, NOWHERE, cover.work)
    until = covered_until([functions[name] for name in domain.free], spans, lookup)
    reason = "" if until == stop else "; ".join(reasons) or NOWHERE
    return WayMap(domain, order, limits, patches, until, reason, cover.work)


def starts_on(domain: Domain, order: int, patches: Patches, lookup: Lookup, values: Array, y: Array) -> bool:
    """Whether a pose is the assembly of the patch that its inputs lie on.

    Args:
        values: of the free inputs, (p,). y: the pose's coordinates, (size,).
    """
    number = int(lookup.at(values))
    if number < 0:
        return False
    which = np.array([number])
    unknown = unknowns_at(domain, order, patches, which, values[None])[0]
    apart = np.abs(unknown - y[: len(unknown)]) + patches.error[number]
    return bool((apart < patches.unique_within[number]).all())


def order_for(tolerance: float, size: float, derivative: int = 0, inputs: int = 1) -> int:
    """Total degree of the series: one for each digit of a tolerance, relative to the mechanism's size, mm.

    A pose costs in proportion to the number of powers, order^p, and the number of patches falls with the
    order; between half and twice this order both together change little. A derivative loses as many digits
    as two orders gain; of more inputs fewer orders are as many powers.

    Args:
        derivative: highest that the limits hold. inputs: how many move.
    """
    digits = int(np.clip(round(-np.log10(tolerance / size)), LEAST_ORDER, MOST_DIGITS))
    return min(digits + 2 * derivative, MOST_ORDER.get(inputs, LEAST_ORDER))


def widened(low: float, high: float) -> tuple[float, float]:
    """A range that is no narrower than can be divided."""
    room = NARROWEST * max(abs(low), abs(high), 1.0) - (high - low)
    return (low - 0.5 * room, high + 0.5 * room) if room > 0.0 else (low, high)
