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
        bound: distance from every coordinate of every point to the exact assembly, at most, (N,), mm;
            infinite where nothing is proven. See `certificate` for what it covers.
        condition: condition number of the Jacobian, (N,).
        velocity_sensitivity: change of a velocity per displacement of the pose, at most, (N,), 1/s;
            zero where no velocity was solved for.
        acceleration_sensitivity: the same of an acceleration, at given velocities, (N,), 1/s^2.
        residual: largest row of C(y), (N,), in the mechanism's units.
    """

    times: Array
    bound: Array
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
        parts.append((pose_bound(mechanism, y, factors), factors.condition, first, second, residual))
    columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Proof(times, *columns)


def _sensitivity(mechanism: Mechanism, factors: Factors, rate: Array) -> Array:
    """max_i (|C_u^-1| |2 B(., rate)|)_i: how a displaced pose changes what solves C_u rate = ..."""
    effect = mechanism.map.displacement_effect(rate)[..., None]
    return np.asarray((np.abs(factors.preconditioner) @ effect)[..., 0].max(axis=-1))


def pose_bound(mechanism: Mechanism, y: Array, factors: Factors) -> Array:
    """Proven bound on every coordinate of every point of poses, carried points included, (...,), mm.

    A carried point p_0 + a e1 + b e2 + c e1 x e2 moves by at most
    1 + 2 (|a| + |b|) + 4 |c| (|e1| + |e2|) times as much as its carriers do, and its evaluation and the
    shift to the user's origin round once more.
    """
    radius = certify(mechanism.map, y, factors, mechanism.known_uncertainty(y)).radius
    reach = np.maximum(1.0, mechanism.carried_reach)
    rounding = 8 * EPS * reach * np.abs(y).max(axis=-1)
    shift = EPS * np.abs(mechanism.origin).max(axis=-1)
    return np.asarray((radius * reach + rounding) * mechanism.unit + shift)
