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
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.patches.domain import Domain, widened
from pointcoord.patches.flood import Limits, flood
from pointcoord.patches.lookup import Marked
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.path import covered_until, way_of
from pointcoord.solve.assembly import Pose
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

# How often a range is halved at most, by how many inputs move: 65,536 to 262,144 of the smallest boxes.
HALVINGS = {1: 16, 2: 9, 3: 6}
# Patches of one motion, and factorisations that are spent on them: some seconds.
MOST, ENOUGH = 1024, 40000

NOWHERE = "the pose at the start cannot be proven to be the patch's"
MANY = "more than three inputs move at once"


@dataclass(frozen=True)
class WayMap:
    """Patches along the way of the inputs.

    Attributes:
        until: the way is covered up to here, s; minus infinity where its start is not.
        reason: why not further; empty where all of it is covered.
        work: what making it took.
    """

    patches: ProvenPatches
    limits: Limits
    until: float
    reason: str
    work: Work

    @property
    def notes(self) -> tuple[str, ...]:
        """Where rounding alone keeps a patch from being as near as was asked."""
        bounds = self.patches.off.value.max(axis=-1)
        count = int(np.count_nonzero(bounds > self.limits.tolerance))
        if not count:
            return ()
        return (
            f"rounding keeps {count} of {len(bounds)} patches of the map from being proven to the tolerance "
            f"everywhere: positions to {bounds.max():.2g} mm",
        )


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
    moving = sum(low < high for low, high in ranges.values())
    domain = Domain(mechanism, ranges, HALVINGS.get(moving, 0))
    if moving not in HALVINGS:
        none = ProvenPatches.none(domain, domain.order_for(limits.tolerance, limits.derivative))
        return WayMap(none, limits, -np.inf, MANY, Work())
    domain.known_at(np.stack(domain.ends))
    spans = spans.along([list(functions).index(name) for name in domain.free])
    wanted = Marked.touched_by(domain, spans.low, spans.high)
    laws = [functions[name] for name in domain.free]
    first = np.array([float(law.series(start, 0)[..., 0]) for law in laws])
    limits = replace(limits, most=MOST, effort=ENOUGH if effort is None else effort)
    cover = flood(domain, limits, (domain.nearest_place(first), pose.y), wanted)
    begun = cover.patches.holds(first, pose.y)
    until = covered_until(laws, spans, cover.patches.lookup) if begun else -np.inf
    reason = "" if until == stop else "; ".join(cover.reasons) or NOWHERE
    return WayMap(cover.patches, limits, until, reason, cover.work)
