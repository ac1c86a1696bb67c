r"""A map along the path of the inputs over some time: a motion without series in time.

Positions depend on time through the inputs only. So patches that cover the path of the inputs (see `path`)
describe the whole motion, however long or rough it is. The patches are proven outwards from the pose at the
start of the motion, and only along the path. The motion ends where the path meets a region that is not
covered. Up to this instant:

- the start lies on a patch, and the pose at the start is the assembly of this patch: any other assembly is
  farther away;
- every box that the path touches is covered, and patches that share a part of a face are the same assembly
  there (see `flood`). A path through a corner touches the boxes on both sides of the corner.

So every pose up to this instant is on the branch of the start, as if it had been followed in time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.counters import Work
from pointcoord.patches.domain import Domain, widened
from pointcoord.patches.flood import Limits, flood
from pointcoord.patches.lookup import Marked
from pointcoord.patches.patches import ProvenPatches
from pointcoord.patches.path import covered_until, way_of
from pointcoord.solve.assembly import Pose
from pointcoord.time_functions import TimeFunction

# Most halvings of a range, by number of inputs that move: 65,536 to 262,144 smallest boxes.
HALVINGS = {1: 16, 2: 9, 3: 6}
# Most patches of one motion, and most factorisations for them: some seconds.
MOST, ENOUGH = 1024, 40000

NOWHERE = "the pose at the start cannot be proven to be the assembly of a patch"
MANY = "more than three inputs move at once"


@dataclass(frozen=True)
class WayMap:
    """Patches along the path of the inputs.

    Attributes:
        patches: the patches.
        limits: the limits of a patch.
        until: instant up to which the path is covered, s; minus infinity if its start is not covered.
        reason: why the path is not covered further; empty if all of it is covered.
        work: work of making the patches.
    """

    patches: ProvenPatches
    limits: Limits
    until: float
    reason: str
    work: Work

    @property
    def notes(self) -> tuple[str, ...]:
        """A note if rounding prevents the proof of the tolerance on some patches."""
        bounds = self.patches.off.value.max(axis=-1)
        count = int(np.count_nonzero(bounds > self.limits.tolerance))
        if not count:
            return ()
        return (
            f"rounding keeps {count} of {len(bounds)} patches of the map from the tolerance: positions are "
            f"proven to {bounds.max():.2g} mm only",
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
    """Cover the path of the inputs, starting at an assembled pose.

    Args:
        functions: laws of the inputs that drive the mechanism.
        pose: the pose at `start`.
        start, stop: first and last instant, s.
        effort: number of factorisations after which no further box is tried; `ENOUGH` unless given.
    Raises:
        InputOutOfRange: an input leaves the values that it can have.
    """
    spans = way_of(functions, start, stop)
    ranges: dict[str, tuple[float, float]] = {}
    for i, (name, law) in enumerate(functions.items()):
        low, high = float(spans.low[:, i].min()), float(spans.high[:, i].max())
        # At a single instant a moving input has one value but may have rates.
        still = low == high and not law.series(spans.first, 2)[..., 1:].any()
        ranges[name] = (low, high) if still else widened(low, high)
    if all(low == high for low, high in ranges.values()):
        # A map needs at least one input.
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
