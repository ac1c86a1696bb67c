"""Proven error bounds of the poses of a motion, computed when asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.body_fixed import apart, carried_errors
from pointcoord.bounds.reported_bounds import Numbers, Proven, Reported, joined, reported_bounds
from pointcoord.bounds.solved_coordinates import SolvedCoordinates
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import Pair, two_sum
from pointcoord.numerics.enclosure import Enclosed
from pointcoord.numerics.kantorovich import INFLATION, Certificate, certify
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]

# Poses per batch: their matrices (two of n x n and one of n x pairs each) stay below 100 MB.
BLOCK = 4096


@dataclass(frozen=True)
class Proof:
    """What is proven of each pose.

    Attributes:
        times: shape (N,), s.
        pose_bound: distance from every coordinate of a solved point, in the chassis' frame and near the
            mechanism, to the exact assembly, at most, (N,), mm; infinite where nothing is proven.
        bound: distance from every reported coordinate of a point to the exact assembly, at most, (N,), mm:
            what adding the user's origin and the chassis' motion rounds comes to it. See `kantorovich`
            for what it covers.
        carried_bound: the same for carried points, (N,), mm.
        carried_gain: how many times as far as its carriers a carried point moves, at most, (N,).
        condition: condition number of the Jacobian, (N,).
        residual: largest row of C(y), (N,), in the mechanism's units.
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
    solved: SolvedCoordinates,
    reported: Mapping[str, Array],
    offset: Array,
    rounding: Array,
    laws: Mapping[str, Array],
    everything: Reported | None = None,
) -> Proof:
    """Prove poses in blocks.

    What is reported was summed, and shifted to the user's origin and by the chassis' motion, apart from
    the coordinates y that are proven. Both are at hand, so what lies between them is measured, without
    rounding.

    Args:
        times: instants, shape (N,), s.
        solved: the coordinates y and as many of their time derivatives as were solved for.
        reported: position of every point that is reported at the times, (N, 3), mm.
        offset: what was added to every point to report it, (N, 3), mm.
        rounding: of the offset itself, at most, (N, 3), mm.
        laws: how far the value of each driving input may be off, (N,), rad or mm.
        everything: all that was reported, to bound each number of it as well.
    """
    parts, bounds = [], []
    for low in range(0, len(times), BLOCK):
        here = times[low : low + BLOCK]
        y, *rates = solved.coordinates(here)
        factors = factorise(mechanism.map.jacobian(y))
        residual = np.abs(mechanism.map.residual(y)).max(axis=-1)
        off = {name: doubt[low : low + BLOCK] for name, doubt in laws.items()}
        lacking, uncertainty = mechanism.known_data(y, off)
        expected = uncertainty + np.abs(lacking)
        driven = {} if everything is None else everything.driven(mechanism, here)
        lacking, uncertainty = _sharpened(y, driven, lacking, uncertainty)
        for place, (value, _, _) in driven.items():
            expected[:, place] = value.radius[1]
        certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
        local = {
            name: _local(mechanism, place[low : low + BLOCK], offset[low : low + BLOCK])
            for name, place in reported.items()
        }
        doubt = rounding[low : low + BLOCK] / mechanism.unit
        bound = mechanism.unit * _reported_bound(mechanism, y, local, certificate, doubt)
        carried, gain = carried_errors(mechanism, y, local, certificate, doubt)
        own = mechanism.unit * certificate.coordinates[..., : 3 * len(mechanism.topology.moving)].max(axis=-1)
        if everything is not None:
            pose = Proven(factors, certificate, here, (y, *rates), (lacking, uncertainty, expected), driven)
            bounds.append(reported_bounds(mechanism, pose, everything.part(low, low + BLOCK)))
        parts.append((own, bound, mechanism.unit * carried, gain, factors.condition, residual))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    own, bound, carried, gain, condition, residual = columns
    each = (joined([part[place] for part in bounds]) for place in (0, 1))
    return Proof(times, own, bound, carried, gain, condition, residual, *each)


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


def _local(mechanism: Mechanism, reported: Array, offset: Array) -> Pair:
    high, low = two_sum(reported, -offset)
    return high / mechanism.unit, low / mechanism.unit


def _reported_bound(
    mechanism: Mechanism, y: Array, local: Mapping[str, Pair], certificate: Certificate, doubt: Array
) -> Array:
    """Bound on the reported coordinates of solved points and of the chassis, shape (...,), in units."""
    topology, layout = mechanism.topology, mechanism.layout
    # In its own frame the chassis is where it was drawn, exactly.
    drawn = np.zeros((*y.shape[:-1], layout.size - layout.unknowns))
    own = np.concatenate([certificate.coordinates, drawn], axis=-1)
    places = {name: list(layout.vector(name)) for name in (*topology.moving, *topology.chassis)}
    each = [
        own[..., place] + apart(local[name], y[..., place]) + doubt
        for name, place in places.items()
        if name in local
    ]
    # Of carried points alone there is nothing here; a pose that is not proven is not proven for them either.
    solved = np.where(np.isfinite(certificate.radius), 0.0, np.inf)
    return np.asarray(INFLATION * np.concatenate([solved[..., None], *each], axis=-1).max(axis=-1))


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    lacking, uncertainty = mechanism.known_data(y)
    certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
    points = certificate.coordinates[..., : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
