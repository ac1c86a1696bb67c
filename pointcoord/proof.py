"""Proven error bounds of the poses of a motion, computed when asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.certificate import certify
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
        bound: distance from every coordinate of a solved point to the exact assembly, at most, (N,),
            mm; infinite where nothing is proven. See `certificate` for what it covers.
        carried_bound: the same for carried points, (N,), mm.
        condition: condition number of the Jacobian, (N,).
        velocity_sensitivity: change of a velocity per displacement of the pose, at most, (N,), 1/s;
            zero where no velocity was solved for.
        acceleration_sensitivity: the same of an acceleration, at given velocities, (N,), 1/s^2.
        residual: largest row of C(y), (N,), in the mechanism's units.
    """

    times: Array
    bound: Array
    carried_bound: Array
    condition: Array
    velocity_sensitivity: Array
    acceleration_sensitivity: Array
    residual: Array


def prove(mechanism: Mechanism, times: Array, states: Callable[[Array], Sequence[Array]]) -> Proof:
    """Prove poses in blocks.

    Args:
        times: instants, shape (N,), s.
        states: gives the coordinates y, shape (n, size), at some of the instants, and as many of their
            time derivatives as were solved for.
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
        bound = pose_bound(mechanism, y, factors)
        # The carried point's own evaluation takes some ten roundings of numbers as large as itself.
        rounding = 8 * EPS * np.abs(y).max(axis=-1) * mechanism.unit
        carried = carried_gain(mechanism, y) * (bound + rounding)
        parts.append((bound, carried, factors.condition, first, second, residual))
    columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Proof(times, *columns)


def _sensitivity(mechanism: Mechanism, factors: Factors, rate: Array) -> Array:
    """max_i (|C_u^-1| |2 B(., rate)|)_i: how a displaced pose changes what solves C_u rate = ..."""
    effect = mechanism.map.displacement_effect(rate)[..., None]
    return np.asarray((np.abs(factors.preconditioner) @ effect)[..., 0].max(axis=-1))


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of the solved points of poses, shape (...,), mm.

    The shift to the user's origin rounds each coordinate once more.
    """
    radius = certify(mechanism.map, y, factors, mechanism.known_uncertainty(y)).radius
    return np.asarray(radius * mechanism.unit + EPS * np.abs(mechanism.origin).max(axis=-1))


def carried_gain(mechanism: Mechanism, y: Array) -> Array:
    r"""How many times as far as its carriers a carried point moves, at most, shape (...,).

    p = p_0 + a e1 + b e2 + c e1 x e2 has the derivatives K1 = a I - c [e2]x and K2 = b I + c [e1]x by
    p_1 and p_2 and I - K1 - K2 by p_0; the gain is the sum of the magnitudes in a row of all three.
    Bounds are so small that the curvature of p adds less than a millionth of them.
    """
    gain = np.ones(y.shape[:-1])
    for name, carriers in mechanism.topology.carried.items():
        base, first, second = (y[..., list(mechanism.layout.vector(point))] for point in carriers)
        a, b, c = (mechanism.carrier_weights[name][..., i, None, None] for i in range(3))
        by_first = a * np.eye(3) - c * _cross_matrix(second - base)
        by_second = b * np.eye(3) + c * _cross_matrix(first - base)
        by_base = np.eye(3) - by_first - by_second
        rows = sum(np.abs(k).sum(axis=-1) for k in (by_base, by_first, by_second))
        gain = np.maximum(gain, (1.0 + 1e-6) * np.asarray(rows).max(axis=-1))
    return gain


def _cross_matrix(v: Array) -> Array:
    """[v]x with [v]x w = v x w, shape (..., 3, 3)."""
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    rows = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
