"""Proven error bounds of the poses of a motion, computed when asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.carried import carried_errors
from pointcoord.certificate import INFLATION, Certificate, certify
from pointcoord.linear import EPS, Factors, factorise
from pointcoord.mechanism import Mechanism

Array = NDArray[np.float64]

# Poses per batch: their matrices (two of n x n and one of n x pairs each) stay below 100 MB.
BLOCK = 4096


@dataclass(frozen=True)
class Proof:
    """What is proven of each pose, and how its rates depend on it.

    Attributes:
        times: shape (N,), s.
        bound: distance from every reported coordinate of a point to the exact assembly, at most, (N,), mm;
            infinite where nothing is proven. See `certificate` for what it covers.
        carried_bound: the same for carried points, (N,), mm.
        carried_gain: how many times as far as its carriers a carried point moves, at most, (N,).
        condition: condition number of the Jacobian, (N,).
        velocity_sensitivity: change of a velocity per displacement of the pose, at most, (N,), 1/s;
            zero where no velocity was solved for.
        acceleration_sensitivity: the same of an acceleration, at given velocities, (N,), 1/s^2.
        residual: largest row of C(y), (N,), in the mechanism's units.
    """

    times: Array
    bound: Array
    carried_bound: Array
    carried_gain: Array
    condition: Array
    velocity_sensitivity: Array
    acceleration_sensitivity: Array
    residual: Array


def prove(
    mechanism: Mechanism,
    times: Array,
    states: Callable[[Array], Sequence[Array]],
    reported: Mapping[str, Array],
    chassis_moves: NDArray[np.bool_],
) -> Proof:
    """Prove poses in blocks.

    What is reported was summed, and shifted to the user's origin, apart from the coordinates y that are
    proven. Both are at hand, and the difference of two numbers this close together is exact, so what lies
    between them is measured.

    Args:
        times: instants, shape (N,), s.
        states: gives the coordinates y, shape (n, size), at some of the instants, and as many of their
            time derivatives as were solved for.
        reported: position of every point at the times, (N, 3), mm.
        chassis_moves: along which axes the chassis is not where it is drawn, (N, 3).
    """
    parts = []
    for low in range(0, len(times), BLOCK):
        y, *rates = states(times[low : low + BLOCK])
        factors = factorise(mechanism.map.jacobian(y))
        residual = np.abs(mechanism.map.residual(y)).max(axis=-1)
        first, second = (
            _sensitivity(mechanism, factors, rates[order]) if order < len(rates) else np.zeros(len(y))
            for order in (0, 1)
        )
        lacking, uncertainty = mechanism.known_data(y, chassis_moves[low : low + BLOCK])
        certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
        local = {
            name: (place[low : low + BLOCK] - mechanism.origin) / mechanism.unit
            for name, place in reported.items()
        }
        bound = mechanism.unit * _reported_bound(mechanism, y, local, certificate, uncertainty)
        carried, gain = carried_errors(mechanism, y, local, certificate)
        parts.append((bound, mechanism.unit * carried, gain, factors.condition, first, second, residual))
    columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Proof(times, *columns)


def _reported_bound(
    mechanism: Mechanism, y: Array, local: Mapping[str, Array], certificate: Certificate, uncertainty: Array
) -> Array:
    """Bound on the reported coordinates of solved points and of the chassis, shape (...,), in units."""
    topology, layout = mechanism.topology, mechanism.layout
    own = np.concatenate([certificate.coordinates, uncertainty[..., layout.unknowns :]], axis=-1)
    places = {name: list(layout.vector(name)) for name in (*topology.moving, *topology.chassis)}
    each = [own[..., place] + np.abs(local[name] - y[..., place]) for name, place in places.items()]
    return np.asarray(INFLATION * np.concatenate(each, axis=-1).max(axis=-1))


def _sensitivity(mechanism: Mechanism, factors: Factors, rate: Array) -> Array:
    """max_i (|C_u^-1| |2 B(., rate)|)_i: how a displaced pose changes what solves C_u rate = ..."""
    effect = mechanism.map.displacement_effect(rate)[..., None]
    return np.asarray((np.abs(factors.preconditioner) @ effect)[..., 0].max(axis=-1))


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    lacking, uncertainty = mechanism.known_data(y)
    certificate = certify(mechanism.map, y, factors, uncertainty, lacking)
    points = certificate.coordinates[..., : 3 * len(mechanism.topology.moving)].max(axis=-1)
    return np.asarray(points * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))
