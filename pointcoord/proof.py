"""Proven error bounds of the poses of a motion, computed when asked for."""

from __future__ import annotations

from collections.abc import Callable
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
    """What is proven of each pose.

    Attributes:
        times: shape (N,), s.
        bound: distance from every coordinate of every point to the exact assembly, at most, (N,), mm;
            infinite where nothing is proven. See `certificate` for what it covers.
        condition: condition number of the Jacobian, (N,).
        sensitivity: relative change of the rates per change of the pose, (N,), 1/mm: the Lipschitz
            constant of X C_u in the maximum norm.
        residual: largest row of C(y), (N,), in the mechanism's units.
    """

    times: Array
    bound: Array
    condition: Array
    sensitivity: Array
    residual: Array


def prove(mechanism: Mechanism, times: Array, poses: Callable[[Array], Array]) -> Proof:
    """Prove poses in blocks.

    Args:
        times: instants, shape (N,), s.
        poses: gives the coordinates y, shape (n, size), at some of the instants.
    """
    parts = []
    for low in range(0, len(times), BLOCK):
        y = poses(times[low : low + BLOCK])
        factors = factorise(mechanism.map.jacobian(y))
        ones = np.ones((*y.shape[:-1], mechanism.map.unknowns))
        sensitivity = mechanism.map.lipschitz(factors.preconditioner, ones) / mechanism.unit
        residual = np.abs(mechanism.map.residual(y)).max(axis=-1)
        parts.append((pose_bound(mechanism, y, factors), factors.condition, sensitivity, residual))
    columns = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Proof(times, *columns)


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
