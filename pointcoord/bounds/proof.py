"""Proven error bounds of the poses of a motion, computed when asked for."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.body_fixed import apart, carried_errors
from pointcoord.bounds.certified_poses import CertifiedPoses, Certifier
from pointcoord.bounds.proven_groups import GroupProver, Instants
from pointcoord.bounds.reported_bounds import (
    POSITION,
    Numbers,
    Proven,
    Reported,
    driven_coordinates,
    reported_bounds,
)
from pointcoord.linkage.chassis import SPREAD
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import Pair, two_sum
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION, certify
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]

# Instants at a time: a row of them stays in a first-level cache, and all rows of a block below 20 MB.
BLOCK = 2048
# The same with their rates, where what is done for a group takes as long as for some hundred instants.
WITH_RATES = 16384


@dataclass(frozen=True)
class Proof:
    """What is proven of each pose.

    Attributes:
        times: shape (N,), s.
        pose_bound: distance from every coordinate of a solved point, in the chassis' frame and near the
            mechanism, to the exact assembly, at most, (N,), mm; infinite where nothing is proven.
        bound: distance from every reported coordinate of a point to the exact assembly, at most, (N,), mm:
            what adding the user's origin and the chassis' motion rounds comes to it, and of a car that turns
            no coordinate is off by more than the length of what the pose may be. See `kantorovich`
            for what it covers.
        carried_bound: the same for carried points, (N,), mm.
        carried_gain: how many times as far as its carriers a carried point moves, at most, (N,).
        condition: condition number of the Jacobian, (N,); between neighbours that share an inverse it is
            interpolated, to a few per cent, and to a third where the power of two that scales a row changes.
        residual: largest row of C(y) about what the user's numbers mean, (N,), in the mechanism's units.
        proven: by quantity and name, the error of every reported number, rates and angles too, at most; empty
            unless asked for.
        expected: the error that the method makes of each at most where nothing is wrong; likewise.
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
        """In a line: how many instants, and the largest bounds."""
        largest = (float(np.max(each, initial=0.0)) for each in (self.bound, self.carried_bound))
        solved, carried = (f"{bound:.2g} mm" for bound in largest)
        count = len(self.times)
        return f"<Proof of {count} instants: solved points within {solved}, carried ones within {carried}>"


def prove(
    mechanism: Mechanism,
    times: Array,
    reported: Reported,
    *,
    rates: bool = False,
    certain: bool = False,
) -> Proof:
    """Prove poses, in blocks of instants.

    What is reported was summed, and shifted to the user's origin and by the chassis' motion, apart from
    the coordinates y that are proven. Both are at hand, so what lies between them is measured, without
    rounding.

    Args:
        times: instants, shape (N,), s.
        reported: the numbers, and what went into them.
        rates: bound each number by itself.
        certain: take the values of the laws as they are computed for exact.
    """
    order = None if (times[1:] >= times[:-1]).all() else np.argsort(times, kind="stable")
    columns = np.empty((6, len(times)))
    certifier = Certifier(mechanism)
    prover = GroupProver(mechanism, certifier)
    bounds = _Bounds(len(times))
    block = WITH_RATES if rates else BLOCK
    for low in range(0, len(times), block):
        here = slice(low, low + block) if order is None else order[low : low + block]
        part = reported.part(here)
        if rates:
            asked = Instants.of(times[here], part)
            certified = _with_rates(asked, prover, certain, bounds, here)
            y = asked.states[0]
        else:
            y = np.ascontiguousarray(part.solved.coordinates(times[here], 0)[0].T)
            certified = certifier.certify(times[here], y, part.doubts(times[here], certain))
        columns[:, here] = _positions(mechanism, times[here], part, y, certified)
    own, bound, carried, gain, condition, residual = columns
    return Proof(times, own, bound, carried, gain, condition, residual, bounds.proven, bounds.expected)


def _with_rates(
    asked: Instants,
    prover: GroupProver,
    certain: bool,
    bounds: _Bounds,
    here: slice | NDArray[np.intp],
) -> CertifiedPoses:
    """Bound every number at some instants: of neighbours together, and of each that is left by itself.

    Args:
        bounds: where they go; here: their places.
    """
    mechanism, times = prover.mechanism, asked.times
    certified = CertifiedPoses.empty(mechanism.map.unknowns, len(times))
    groups, left = prover.prove(asked, certified)
    for group in groups:
        bounds.put_groups(places_of(here, group.members), group.sound, group.proven, group.expected)
    for low in range(0, len(left), BLOCK):
        members = left[low : low + BLOCK]
        some = (
            asked if len(members) == len(times) else Instants.of(times[members], asked.reported.part(members))
        )
        pose = _alone(mechanism, some, certain)
        certified.put_alone(members, pose.certificate, pose.factors)
        bounds.put(places_of(here, members), *reported_bounds(mechanism, pose, some.reported))
    return certified


def places_of(here: slice | NDArray[np.intp], members: NDArray[np.intp]) -> NDArray[np.intp]:
    """Where some of the instants of a block are among all of them."""
    return here.start + members if isinstance(here, slice) else here[members]


def _positions(
    mechanism: Mechanism, times: Array, reported: Reported, y: Array, certified: CertifiedPoses
) -> tuple[Array, ...]:
    """What is proven of the positions at some instants: the arrays of a `Proof`.

    Args:
        y: coordinates, (size, N).
    """
    unit, added = mechanism.unit, reported.added(times, mechanism.origin)
    doubt = reported.chassis.rounding(times, mechanism.origin).T / unit
    local = {name: _local(place.T, added, unit) for name, place in reported.numbers[POSITION].items()}
    spread = 1.0
    if reported.chassis.turns:
        # What is reported is turned back, exactly, and compared where it was solved.
        local, left = _turned_back(reported, times, local, float(unit))
        doubt, spread = SPREAD * doubt.max(axis=0) + left, SPREAD
    with np.errstate(invalid="ignore", over="ignore"):
        errors = INFLATION * (np.abs(certified.step) + certified.spread + certified.tail)
        own = errors[: 3 * len(mechanism.topology.moving)].max(axis=0)
        bound = _reported_bound(mechanism, y, local, errors, doubt)
        carried, gain = carried_errors(mechanism, y, local, certified, doubt)
    far = spread * unit
    return unit * own, far * bound, far * carried, gain, certified.condition, certified.residual


def _turned_back(
    reported: Reported, times: Array, local: Mapping[str, Pair], unit: float
) -> tuple[dict[str, Pair], Array]:
    """Reported coordinates in the chassis' frame, and how far they may be off there, (N,), in units."""
    chassis = reported.chassis
    with np.errstate(all="ignore"):  # what overflows comes out infinite, which proves nothing
        laws = {name: law.enclosed(times) for name, law in chassis.functions.items()}
        turned = {name: Enclosed.of(high.T, low.T) for name, (high, low) in local.items()}
        (found,) = chassis.turned_exactly({n: law[:1] for n, law in laws.items()}, [turned], unit, back=True)
    left = np.max([place.radius[0].max(axis=-1) for place in found.values()], axis=0, initial=0.0)
    return {name: (place.high.T, place.low.T) for name, place in found.items()}, left


def _alone(mechanism: Mechanism, some: Instants, certain: bool) -> Proven:
    """Poses that are proven each by its own inverse, with all that their rates depend on."""
    times, laws = some.times, some.laws
    y, *rates = (np.ascontiguousarray(state.T) for state in some.states)
    factors = factorise(mechanism.map.jacobian(y))
    lacking, uncertainty = mechanism.known_data(y, some.reported.doubts(times, certain))
    expected = uncertainty + np.abs(lacking)
    driven = driven_coordinates(mechanism, laws)
    lacking, uncertainty = _sharpened(y, driven, lacking, uncertainty)
    for place, (value, _, _) in driven.items():
        expected[:, place] = value.radius[1]
    certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
    data = (lacking, uncertainty, expected)
    return Proven(factors, certificate, times, (y, *rates), data, driven, laws)


def _sharpened(
    y: Array, driven: Mapping[int, Sequence[Enclosed]], lacking: Array, uncertainty: Array
) -> tuple[Array, Array]:
    """What the known coordinates lack, and their uncertainty, with the driven ones in twice the precision."""
    lacking, uncertainty = lacking.copy(), uncertainty.copy()
    for place, (value, _, _) in driven.items():
        lacking[:, place] = (value.high - y[:, place]) + value.low
        rounded = np.abs(lacking[:, place]) + np.abs(value.low)
        uncertainty[:, place] = value.radius[0] + 2.0 * UNIT_ROUNDOFF * rounded
    return lacking, uncertainty


def _local(reported: Array, added: Array | None, unit: Array) -> Pair:
    """Reported coordinates (3, N) without what was added to report them, in units."""
    if added is None:
        return reported / unit, np.zeros(1)
    high, low = two_sum(reported, -added)
    return high / unit, low / unit


def _reported_bound(
    mechanism: Mechanism, y: Array, local: Mapping[str, Pair], errors: Array, doubt: Array
) -> Array:
    """Bound on the reported coordinates of solved points and of the chassis, shape (N,), in units.

    Args:
        errors: of the unknown coordinates, (unknowns, N).
    """
    topology, layout = mechanism.topology, mechanism.layout
    # Of carried points alone there is nothing here; a pose that is not proven is not proven for them either.
    found = np.where(np.isfinite(errors).all(axis=0), 0.0, np.inf)
    for name in (*topology.moving, *topology.chassis):
        if name not in local:
            continue
        place = list(layout.vector(name))
        each = apart(local[name], y[place]) + doubt
        # In its own frame the chassis is where it was drawn, exactly.
        if name in topology.moving:
            each += errors[place]
        found = np.maximum(found, each.max(axis=0))
    return np.asarray(INFLATION * found)


@dataclasses.dataclass
class _Bounds:
    """Bounds of every number at some instants, written block by block.

    Attributes:
        count: of the instants.
    """

    count: int
    proven: dict[str, dict[str, Array]] = field(default_factory=dict)
    expected: dict[str, dict[str, Array]] = field(default_factory=dict)

    def put(self, here: NDArray[np.intp], *parts: Numbers) -> None:
        """Write proven and expected bounds at some of them."""
        for whole, part in zip((self.proven, self.expected), parts, strict=True):
            for quantity, arrays in part.items():
                whole.setdefault(quantity, {})  # a quantity that nothing is asked of is one all the same
                for name, array in arrays.items():
                    self._room(whole, quantity, name, array.shape[1:])[here] = array

    def put_groups(
        self, members: NDArray[np.intp], sound: NDArray[np.bool_], proven: Numbers, expected: Numbers
    ) -> None:
        """Write those of the groups that are sound, members (G, m)."""
        if not sound.any():
            return
        every = sound.all()
        places = (members if every else members[sound]).ravel()
        first, last = int(places[0]), int(places[-1])
        run = every and last - first + 1 == len(places) and bool((np.diff(places) == 1).all())
        here = slice(first, last + 1) if run else places
        for whole, part in ((self.proven, proven), (self.expected, expected)):
            for quantity, arrays in part.items():
                whole.setdefault(quantity, {})
                for name, array in arrays.items():
                    room = self._room(whole, quantity, name, array.shape[2:])
                    kept = array if every else array[sound]
                    # By components, so that instants lie side by side where they are read and written.
                    room.T[..., here] = np.moveaxis(kept, (0, 1), (-2, -1)).reshape(*room.shape[1:], -1)

    def _room(
        self, whole: dict[str, dict[str, Array]], quantity: str, name: str, shape: tuple[int, ...]
    ) -> Array:
        """All bounds of a number, (N, ...)."""
        found = whole.setdefault(quantity, {})
        if name not in found:
            found[name] = np.empty((*shape[::-1], self.count)).T
        return found[name]


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    lacking, uncertainty = mechanism.known_data(y)
    certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
    points = certificate.coordinates[..., : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
