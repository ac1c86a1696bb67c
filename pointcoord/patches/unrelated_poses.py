r"""Many poses of one car at unrelated inputs, each with a proven bound.

Patches cover the inputs that are asked for, outwards from the drawing's pose (see `flood`): each pose on one
is a sum of its series, within the bound that is proven of the patch. What no patch covers, or where there are
few poses, goes along a path of its own from the closed drawing, and is proven by itself (see
`numerics.kantorovich`); where the path ends it says what stops it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import AssemblyError, InputOutOfRange, PointcoordError
from pointcoord.linkage.carried_points import carried_gain, carried_place
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.mechanism.freedoms import locked
from pointcoord.numerics.rounding import EPS
from pointcoord.patches.domain import Domain
from pointcoord.patches.evaluation import sum_series
from pointcoord.patches.flood import Limits, Patches, flood
from pointcoord.patches.lookup import Lookup, Marked
from pointcoord.patches.reported_points import moving_points
from pointcoord.patches.way_map import HALVINGS, order_for, widened
from pointcoord.solve.assembly import assemble, assembled, close_drawing
from pointcoord.solve.follower import Path

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]

# Poses that are worth a map, and how many of them are worth a factorisation of one: of a strut, an off-axis
# strut and a double wishbone 100 poses on paths of their own took 40, 44 and 24 ms, and maps 40 to 90 ms.
FEW, WORTH = 200, 2
# Patches at most; poses on paths of their own, and poses on patches, at a time.
MOST, PATHS, SUMS = 1024, 256, 16384


@dataclass(frozen=True)
class UnrelatedPoses:
    """Poses of one car, in the chassis' frame.

    Attributes:
        places: of every point that moves, (N, 3), mm from the mechanism's origin; NaN where there is no pose.
        bound: proven distance of every coordinate of a solved point to the exact assembly, once the origin
            is added, (N,), mm, for what the inputs and the drawing mean; infinite where there is none.
        carried_bound: the same of points that ride on a body.
        failures: by number, what stopped a pose.
    """

    places: Mapping[str, Array]
    bound: Array
    carried_bound: Array
    failures: Mapping[int, PointcoordError]


def solve_unrelated(mechanism: Mechanism, inputs: Mapping[str, Array], tolerance: float) -> UnrelatedPoses:
    """The poses of one car at any inputs, on the branch of its drawing.

    Args:
        inputs: value of each input that drives the linkage, each (N,), rad or mm.
        tolerance: bound that a pose should keep, mm; rounding may leave more.
    Raises:
        AssemblyError: the drawing cannot be closed.
        InputOutOfRange, UnknownName: as `Mechanism.known_series`.
    """
    closed = close_drawing(mechanism)
    count = len(next(iter(inputs.values())))
    places = {name: np.full((count, 3), np.nan) for name in moving_points(mechanism.topology)}
    poses = UnrelatedPoses(places, np.full(count, np.inf), np.full(count, np.inf), {})
    rest = np.arange(count)
    # Where some rows are left out of the equations they are looked at pose by pose.
    if count >= FEW and not mechanism.topology.left_out:
        rest = rest[~_by_patches(mechanism, closed, inputs, tolerance, poses)]
    failures: dict[int, PointcoordError] = {}
    for low in range(0, len(rest), PATHS):
        failures |= _by_paths(mechanism, closed, inputs, rest[low : low + PATHS], poses)
    return UnrelatedPoses(places, poses.bound, poses.carried_bound, failures)


def _by_patches(
    mechanism: Mechanism, closed: Path, inputs: Mapping[str, Array], tolerance: float, poses: UnrelatedPoses
) -> NDArray[np.bool_]:
    """Put poses into their places that lie on patches; which these are, (N,)."""
    count = len(poses.bound)
    nobody = np.zeros(count, dtype=bool)
    ranges = {name: (float(values.min()), float(values.max())) for name, values in inputs.items()}
    ranges = {name: widened(*ends) if ends[0] < ends[1] else ends for name, ends in ranges.items()}
    free = sum(low < high for low, high in ranges.values())
    if free not in HALVINGS:
        return nobody
    domain = Domain(mechanism, ranges, HALVINGS[free])
    values = np.stack([inputs[name] for name in domain.free], axis=-1)
    try:
        patches = _patches(domain, closed, values, tolerance)
    except (AssemblyError, InputOutOfRange):
        # A path of its own says which pose it is.
        return nobody
    if patches is None:
        return nobody
    number = Lookup.of(domain, patches.low, patches.high).at(values)
    off = patches.off.value
    solved = 3 * len(mechanism.topology.moving)
    origin = EPS * float(np.abs(mechanism.origin).max())
    covered = np.flatnonzero(number >= 0)
    poses.bound[covered] = off[:, :solved].max(axis=-1)[number[covered]] + origin
    poses.carried_bound[covered] = off.max(axis=-1)[number[covered]] + origin
    middle, half = domain.middle_and_half(patches.low, patches.high)
    order = _order(domain, tolerance)
    for low in range(0, len(covered), SUMS):
        some = covered[low : low + SUMS]
        (found,) = sum_series(patches.coefficients, middle, half, order, number[some], [values[some]])
        for i, place in enumerate(poses.places.values()):
            place[some] = found[:, 3 * i : 3 * i + 3]
    return np.asarray(number >= 0)


def _order(domain: Domain, tolerance: float) -> int:
    return order_for(tolerance, float(domain.mechanism.unit), 0, len(domain.free))


def _patches(domain: Domain, closed: Path, values: Array, tolerance: float) -> Patches | None:
    """Patches where poses are asked for, from that of the domain's place that is nearest to the drawing."""
    mechanism = domain.mechanism
    domain.known_at(np.stack(domain.ends))
    twice = domain.nearest_place(mechanism.input_values(closed.y[mechanism.map.unknowns :]))
    held = {name: np.array(low) for name, (low, high) in domain.ranges.items() if low == high}
    inputs = held | dict(zip(domain.free, domain.inputs_at(twice), strict=True))
    start = assemble(mechanism, inputs, None, closed)
    wanted = Marked.touched_by(domain, values, values)
    effort = len(values) // WORTH
    cover = flood(
        domain, _order(domain, tolerance), Limits(tolerance), (twice, start.y), MOST, wanted, effort
    )
    return cover.patches


def _by_paths(
    mechanism: Mechanism, closed: Path, inputs: Mapping[str, Array], some: Numbers, poses: UnrelatedPoses
) -> dict[int, PointcoordError]:
    """Put poses into their places that paths of their own lead to; what stops the others, by number."""
    topology, unit = mechanism.topology, float(mechanism.unit)
    wanted = {name: values[some] for name, values in inputs.items()}
    pose, statuses = assembled(mechanism, wanted, closed, None, 0.0)
    stopped: dict[int, PointcoordError] = {
        place: error for place, status in statuses.items() if (error := status.error()) is not None
    }
    whole = np.array([place for place in range(len(some)) if place not in stopped], dtype=np.intp)
    violated = locked(mechanism, pose.y[whole], pose.bound[whole] / unit)
    stopped |= {int(whole[place]): error for place, error in violated.items()}
    done = np.array([place not in stopped for place in range(len(some))])
    y, own = pose.y[done], some[done]
    bound = pose.bound[done]
    found = {name: y[:, list(mechanism.layout.vector(name))] for name in topology.moving}
    gain = 1.0
    for name, carriers in topology.carried.items():
        weights = mechanism.carrier_weights[name]
        found[name] = carried_place(weights, *(found[carrier] for carrier in carriers))
        gain = max(gain, carried_gain(weights, mechanism.drawing, carriers))
    for name, place in found.items():
        poses.places[name][own] = unit * place
    poses.bound[own] = bound
    # Products of the weights and of edges below the mechanism's size round some ten times.
    poses.carried_bound[own] = gain * (bound + 16.0 * EPS * unit)
    return {int(some[place]): error for place, error in stopped.items()}
