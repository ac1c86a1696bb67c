"""Proven error bounds of every number that a motion reports, computed on request."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pointcoord.bounds.certified_poses import CertifiedPoses, Groups, grouped, with_known
from pointcoord.bounds.enclosed_points import (
    EnclosedPoses,
    Numbers,
    Points,
    enclosed_coordinates,
    enclosed_points,
)
from pointcoord.effects.effect import Effect
from pointcoord.linkage.drives import Drive
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import GAP, ByGap, ByInput, Way, shifted, way_slopes
from pointcoord.numerics.arrays import Array, Indices
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.vectors import LAST, NEXT
from pointcoord.results.readout import Readout
from pointcoord.results.samples import Samples
from pointcoord.results.solved_scene import SolvedScene

Arrays = dict[str, dict[str, Array]]
Laws = Mapping[str, Sequence[Enclosed]]

POSITION = "position"
# Instants of a block: the arrays of a coordinate stay in a cache, and all arrays take less than 50 MB.
BLOCK = 4096
# Factor of the expected error. Solving rounds a few times as often as evaluating an equation: factorisation,
# solution and refinement. The truncation error is less than the last two terms, which the expected error has.
ROUNDINGS = 3.0
# Largest exponent of a unit of time as a power of two: the square of the unit is still finite.
LONGEST = 400


@dataclass(frozen=True)
class Proof:
    """Proven error bounds and condition of each pose.

    Attributes:
        times: instants, shape (N,), s.
        pose_bound: error bound of the coordinates of the solved points against the exact assembly, in the
            chassis' frame from the mechanism's origin, (N,), mm; infinite where nothing is proven.
        bound: error bound of the reported coordinates of the solved points, (N,), mm: includes the rounding
            by the user's origin and the chassis' motion. See `kantorovich` for the errors that it covers.
        carried_bound: error bound of the reported coordinates of the carried points, (N,), mm.
        carried_gain: largest ratio of the movement of a carried point to that of its carriers, (N,).
        condition: condition number of the Jacobian, (N,). Between the middle poses of groups that share an
            inverse it is interpolated, to a few per cent, and to a third where the power of two that scales
            a row changes.
        residual: largest row of C(y), for the exact values of the user's numbers, (N,), in the mechanism's
            units.
        proven: error bound of every reported number, rates and angles included, by quantity and name; empty
            unless requested.
        expected: largest error of every number that the method makes if nothing is wrong; likewise.
    """

    times: Array
    pose_bound: Array
    bound: Array
    carried_bound: Array
    carried_gain: Array
    condition: Array
    residual: Array
    proven: Numbers = field(default_factory=dict)
    expected: Numbers = field(default_factory=dict)

    def __repr__(self) -> str:
        """One line with the number of instants and the largest bounds."""
        largest = (float(np.max(each, initial=0.0)) for each in (self.bound, self.carried_bound))
        solved, carried = (f"{bound:.2g} mm" for bound in largest)
        count = len(self.times)
        return f"<Proof of {count} instants: solved points within {solved}, carried ones within {carried}>"


def prove(
    solved: SolvedScene,
    samples: Samples,
    *,
    rates: bool = False,
    certain: bool = False,
    left: Array | None = None,
) -> Proof:
    """Prove poses, in blocks of instants.

    The reported numbers were summed, and moved by the user's origin and the chassis' motion, separately from
    the coordinates y that are proven. So the bounds compare the reported numbers with the exact points.

    Args:
        solved: the scene whose poses are proven.
        samples: the reported numbers, at instants of shape (N,).
        rates: whether to bound each number separately.
        certain: whether the computed values of the laws count as exact; used for positions only.
        left: distance of each pose to its assembly at which the solver stopped, (N,), in units; from
            `solved.unsolved` unless given.
    """
    times, effects = samples.times, solved.readout.plan.computed
    order = np.argsort(times, kind="stable")
    columns = np.empty((6, len(times)))
    bounds: tuple[Arrays, Arrays] = ({}, {})
    for low in range(0, len(times), BLOCK):
        here = order[low : low + BLOCK]
        numbers = {q: {n: a[here] for n, a in arrays.items()} for q, arrays in samples.numbers.items()}
        with np.errstate(all="ignore"):  # an overflow gives an infinite bound
            unsolved = solved.unsolved(times[here]) if left is None else left[here]
            poses, exact = _exact(solved, times[here], unsolved, rates, certain)
            together = poses.groups.together
            if rates:
                by_group = {q: {n: together(a) for n, a in arrays.items()} for q, arrays in numbers.items()}
                for whole, part in zip(bounds, bounds_of_numbers(exact, effects, by_group), strict=True):
                    _put(whole, part, here, poses.groups, len(times))
            columns[:, here] = _of_poses(times[here], poses, exact, numbers[POSITION])
    own, bound, carried, gain, condition, residual = columns
    return Proof(times, own, bound, carried, gain, condition, residual, *bounds)


def _put(whole: Arrays, part: Numbers, here: Indices, groups: Groups, count: int) -> None:
    """Write bounds by group into those of all instants, at the instants `here`."""
    for quantity, arrays in part.items():
        found = whole.setdefault(quantity, {})  # also for a quantity without numbers
        for name, array in arrays.items():
            if name not in found:
                # Components first in memory, so that reads and writes run over contiguous instants.
                found[name] = np.empty((*array.shape[2:], count)).T
            found[name][here] = groups.apart(array)


def _exact(
    solved: SolvedScene, times: Array, unsolved: Array, rates: bool, certain: bool
) -> tuple[CertifiedPoses, EnclosedPoses]:
    """Certified poses at some instants, and enclosures of their exact points and, if asked, of their rates.

    Args:
        unsolved, rates, certain: `left`, `rates` and `certain` of `prove`.
    """
    readout, mechanism = solved.readout, solved.readout.mechanism
    highest = max(readout.plan.derivative, 2) if rates else 0
    y, *computed = solved.coordinates(times, highest)
    drives, unknowns = _drives(mechanism), mechanism.map.unknowns
    groups, factors = grouped(mechanism.map, y, drives)
    together, laws = groups.together, {}
    for name, law in {**solved.functions, **readout.chassis.functions}.items():
        if rates or name not in solved.functions:
            parts = law.enclosed(times, highest)
        else:
            doubt = 0.0 if certain else law.rounding(times)
            parts = [Enclosed.of(law.series(times, 0)[:, 0], 0.0, doubt, doubt)]
        laws[name] = [part.together(together) for part in parts]
    driven = {place: drive.enclosed(laws[drive.input], mechanism.drawing) for place, drive in drives.items()}
    pose, *known = ({place: each[d] for place, each in driven.items()} for d in range(len(computed) + 1))
    poses = CertifiedPoses.of(mechanism, groups, factors, together(y), pose)
    found = [with_known(together(r), unknowns, of) for r, of in zip(computed, known, strict=True)]
    time = unit_of_time([poses.pose.size, *(rate.size for rate in found)])
    powers = [time**d for d in range(len(found) + 1)]
    found = [rate.scaled(power[:, None, None]) for rate, power in zip(found, powers[1:], strict=True)]
    cut = _left_out(poses, times, solved, (y, *computed), powers) if rates else []
    most = together(unsolved).max(axis=1)[:, None]
    points = enclosed_points(mechanism, enclosed_coordinates(mechanism, poses, found, most, cut))
    own = {name: laws[name] for name in readout.chassis.functions}
    exact = enclosed_poses(readout, points, own, [power[:, None] for power in powers])
    ways = readout.plan.ways(mechanism.topology) if rates else ()
    # A slope has no series: it is solved for at the pose, which is off by what its series leaves out.
    off = most + cut[0][:, :unknowns] if cut else most
    slopes = {
        way: _slopes(readout, poses, slope, laws, off, way)
        for way, slope in zip(ways, way_slopes(mechanism, y, ways), strict=True)
    }
    return poses, replace(exact, slopes=slopes)


def _slopes(
    readout: Readout, poses: CertifiedPoses, slopes: Array, laws: Laws, unsolved: Array, way: Way
) -> tuple[Points, Points]:
    """Enclosures of the derivatives of positions along a way, after and before the chassis' rotations.

    They are rates of a motion in which only the input, or the gap, of the way moves, by 1 per unit of time.

    Args:
        slopes: computed derivatives of y along the way, (N, size).
    """
    mechanism, chassis = readout.mechanism, readout.chassis
    known, driven = {}, way.input if isinstance(way, ByInput) else ""
    for place, drive in _drives(mechanism).items() if driven else ():
        value = laws[drive.input][0]
        rate, still = (
            value.like(np.full(value.middle.shape, float(r))) for r in (drive.input == driven, 0.0)
        )
        known[place] = drive.travel.enclosed((value, rate, still), mechanism.drawing)[1]
    rates = [with_known(poses.groups.together(slopes), mechanism.map.unknowns, known)]
    opened = shifted(mechanism.topology, way) if isinstance(way, ByGap) else None
    coordinates = enclosed_coordinates(mechanism, poses, rates, unsolved, (), opened)
    places = enclosed_points(mechanism, coordinates)
    if isinstance(way, ByGap):
        for points, gap in zip(places, (np.zeros(3), np.eye(3)[way.axis]), strict=True):
            points[GAP] = Enclosed.of(np.broadcast_to(gap, (len(slopes), 3))).together(poses.groups.together)
    held = {}
    for name in chassis.turning:
        value = laws[name][0]
        held[name] = [value, value.like(np.full(value.middle.shape, float(name == driven)))]
    return chassis.turned_exactly(held, places, float(mechanism.unit))[1], places[1]


def _left_out(
    poses: CertifiedPoses,
    times: Array,
    solved: SolvedScene,
    states: Sequence[Array],
    powers: Sequence[Array],
) -> list[Array]:
    """Largest truncation and rounding error of the series in each group, by derivative, (G, size).

    Args:
        states: coordinates and their derivatives, (N, size), units per s^d.
        powers: powers of the unit of time of each group, s^d, each (G,).
    """
    groups, found = poses.groups, []
    condition = np.repeat(poses.factors.condition, groups.size)[: groups.count]
    for state, summed, power in zip(states, solved.summed(times), powers, strict=False):
        time = np.repeat(power, groups.size)[: groups.count]
        error = summed.expected(state * time[:, None], condition, time)
        found.append(groups.together(error).max(axis=1))
    return found


def enclosed_poses(
    readout: Readout, points: Sequence[Points], laws: Laws, powers: Sequence[Array]
) -> EnclosedPoses:
    """Enclosures of points with the motion of the chassis added.

    Args:
        points: points in the chassis' frame, by time derivative, in units per unit of time^d.
        laws: laws of the inputs that move the chassis, mm or rad and s.
        powers: powers of the unit of time of each group, s^d, each (G, 1).
    """
    mechanism, chassis = readout.mechanism, readout.chassis
    scaled = {
        name: [part.scaled(power) for part, power in zip(parts, powers, strict=False)]
        for name, parts in laws.items()
        if name in chassis.centres
    }
    turned = chassis.turned_exactly(scaled, points, float(mechanism.unit))
    added = chassis.enclosed(laws, mechanism.origin, len(powers) - 1)
    return EnclosedPoses(mechanism, readout.axes, turned, points, added, powers)


def _of_poses(
    times: Array, poses: CertifiedPoses, exact: EnclosedPoses, positions: Mapping[str, Array]
) -> tuple[Array, ...]:
    """The arrays of a `Proof` at some instants, for the reported positions."""
    mechanism, groups, certificate = exact.mechanism, poses.groups, poses.certificate
    topology = mechanism.topology
    own = certificate.coordinates[..., : 3 * len(topology.moving)].max(axis=-1)
    # The bound of solved points starts at 0, as the mechanism may report carried points only. If the pose is
    # not proven, both bounds are infinite.
    bound, carried = np.where(np.isfinite(own), 0.0, np.inf), np.zeros_like(own)
    gain = np.ones_like(own)
    for name, place in positions.items():
        error = INFLATION * exact.reported(name, 0).apart(groups.together(place)).max(axis=-1)
        error = np.where(np.isnan(error), np.inf, error)
        if name in topology.carried:
            carried = np.maximum(carried, error)
            gain = np.maximum(gain, _gain(exact, name))
        else:
            bound = np.maximum(bound, error)
    middle = groups.together(times)[:, groups.size // 2]
    condition = (
        np.interp(times, middle, poses.factors.condition) if groups.size > 1 else poses.factors.condition
    )
    residual = np.abs(certificate.residual).max(axis=-1)
    own, bound, carried, gain, residual = (groups.apart(a) for a in (own, bound, carried, gain, residual))
    return float(mechanism.unit) * own, bound, carried, gain, condition, residual


def _gain(exact: EnclosedPoses, name: str) -> Array:
    """Largest ratio of the movement of a carried point to that of its carriers, (G, m).

    The derivatives of the carried point by its carriers are K1 = a I - c [e2]x, K2 = b I + c [e1]x and
    K0 = (1 - a - b) I + c [e2 - e1]x.
    """
    mechanism = exact.mechanism
    a, b, c = mechanism.carrier_weights[name]
    base, first, second = (exact.points[0][point].middle for point in mechanism.topology.carried[name])
    e1, e2 = first - base, second - base
    rows = sum(
        abs(along) + abs(c) * (edge[..., NEXT] + edge[..., LAST])
        for along, edge in ((1.0 - a - b, np.abs(e2 - e1)), (a, np.abs(e2)), (b, np.abs(e1)))
    )
    return np.asarray(INFLATION * np.max(rows, axis=-1))


def bounds_of_numbers(
    poses: EnclosedPoses, effects: Sequence[Effect], numbers: Numbers
) -> tuple[Arrays, Arrays]:
    """Proven error bound of every number, and the largest error that the method makes if nothing is wrong."""
    bounds: tuple[Arrays, Arrays] = ({q: {} for q in numbers}, {q: {} for q in numbers})
    for effect in effects:
        for quantity, errors in effect.errors(poses, numbers).items():
            for name, both in errors.items():
                for found, bound, factor in zip(bounds, both, (INFLATION, ROUNDINGS), strict=True):
                    bound *= factor
                    np.copyto(bound, np.inf, where=np.isnan(bound))
                    found[quantity][name] = bound
    return bounds


def _drives(mechanism: Mechanism) -> dict[int, Drive]:
    """The drives by the place of their coordinate in y."""
    return {mechanism.layout.scalar(drive.coordinate): drive for drive in mechanism.topology.drives}


def unit_of_time(states: Sequence[Array]) -> Array:
    """Units of time, powers of two, in which the largest rate or root of an acceleration is about 1, (G,), s.

    Args:
        states: coordinates and their derivatives, each (G, ...); the values of a row share a unit.
    """
    fastest = np.zeros(len(states[0]))
    for d, state in enumerate(states[1:], 1):
        largest = np.abs(state).max(axis=tuple(range(1, state.ndim)))
        fastest = np.maximum(fastest, largest ** (1.0 / d))
    exponent = np.frexp(np.where(np.isfinite(fastest) & (fastest > 0.0), fastest, 1.0))[1]
    return np.asarray(np.ldexp(1.0, -np.clip(exponent, -LONGEST, LONGEST)))
