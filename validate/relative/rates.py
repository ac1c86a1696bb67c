r"""Velocities and accelerations of a mechanism at solved poses, from the joints' screws.

The screw S_k of a joint coordinate moves with the body that it belongs to. With q' and q'' the rates of the
joint coordinates (of a ball joint the components of its angular velocity and their rates), a body b has

    V_b = sum_k S_k q'_k,    A_b = sum_k (S_k q''_k + V_k x S_k q'_k)

over its chain of joints, V_k being that of the coordinate's own body and x the product of screws. Its matrix
M_b has the rates [V] M and [A] M + [V] [V] M, where [V] M = (w x columns, and v added to the last). The rows'
rates are linear in q' and q'':

    J q' = f',    J q'' = f'' - (J' q').

Arrays of all poses at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.follow import Poses, row_targets
from validate.relative.tree import Tree

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rates:
    """How the mechanism moves, at each pose.

    Attributes:
        first, second: rates of the joint coordinates, (N, size).
        twists, accelerations: of the bodies, (N, B, 6); linear, of the point at the origin, and angular.
        matrices: of the bodies, with two rates, (N, 12 B) each.
    """

    first: Array
    second: Array
    twists: Array
    accelerations: Array
    matrices: tuple[Array, Array, Array]


def cross(a: Array, b: Array) -> Array:
    """The vector product, (..., 3); quicker than numpy's own."""
    a0, a1, a2, b0, b1, b2 = a[..., 0], a[..., 1], a[..., 2], b[..., 0], b[..., 1], b[..., 2]
    first = a1 * b2 - a2 * b1
    found = np.empty((*first.shape, 3))
    found[..., 0] = first
    found[..., 1] = a2 * b0 - a0 * b2
    found[..., 2] = a0 * b1 - a1 * b0
    return found


def screw_product(a: Array, b: Array) -> Array:
    """Rate of a screw b that moves with a twist a, (..., 6)."""
    turn = a[..., 3:]
    turned = cross(turn, b[..., 3:])
    found = np.empty((*turned.shape[:-1], 6))
    found[..., :3] = cross(turn, b[..., :3]) + cross(a[..., :3], b[..., 3:])
    found[..., 3:] = turned
    return found


def chain_sum(tree: Tree, terms: Array) -> Array:
    """Sums over each body's chain of joints, (..., size, 6) to (..., B, 6); the chassis rests."""
    return np.asarray(tree.chains @ terms)


def turned(twists: Array, matrices: Array) -> Array:
    """Rates of what turns with bodies and does not shift: w x columns, (..., 12 B).

    Args:
        twists: of the bodies, (..., B, 6). matrices: or rates of them, (..., 12 B).
    """
    w0, w1, w2 = (np.repeat(twists[..., k], 4, axis=-1) for k in (3, 4, 5))
    m0, m1, m2 = (_row(matrices, i) for i in range(3))
    found = np.empty(np.broadcast_shapes(w0.shape, m0.shape)[:-1] + matrices.shape[-1:])
    for i, (a, b, c, d) in enumerate(((w1, m2, w2, m1), (w2, m0, w0, m2), (w0, m1, w1, m0))):
        row = _row(found, i)
        np.multiply(a, b, out=row)
        row -= c * d
    return found


def carried(twists: Array, matrices: Array) -> Array:
    """Rates of the bodies' matrices by their twists, (..., B, 6) and (..., 12 B) to (..., 12 B)."""
    found = turned(twists, matrices)
    for i in range(3):
        shift = _row(found, i)[..., 3::4]
        shift += twists[..., i]
    return found


def _row(matrices: Array, i: int) -> Array:
    """Row i of all bodies' matrices, a view, (..., 4 B)."""
    count = matrices.shape[-1] // 3
    return matrices[..., i * count : (i + 1) * count]


def matrices_of(matrices: Array, twists: Array, accelerations: Array) -> tuple[Array, Array, Array]:
    """The bodies' matrices with two rates, (N, 12 B) each."""
    first = carried(twists, matrices)
    return matrices, first, carried(accelerations, matrices) + turned(twists, first)


def rates_of(tree: Tree, poses: Poses, inputs: Array) -> Rates:
    """Rates at solved poses.

    Args:
        inputs: value, rate and acceleration, (N, drives, 3), rad and sizes of the car.
    Raises:
        LinAlgError: a Jacobian is singular to rounding.
    """
    screws = poses.screws
    wanted = row_targets(tree, inputs)
    first = solved(tree, poses.jacobian, wanted[..., 1])
    moved = screws * first[..., None]
    twists = chain_sum(tree, moved)
    turning = screw_product(twists[:, tree.body_of], moved)
    open_ = matrices_of(poses.matrices, twists, chain_sum(tree, turning))
    second = solved(tree, poses.jacobian, wanted[..., 2] - tree.rows.second_rates(open_))
    accelerations = chain_sum(tree, turning + screws * second[..., None])
    return Rates(first, second, twists, accelerations, matrices_of(poses.matrices, twists, accelerations))


def solved(tree: Tree, jacobian: Array, right_hand_side: Array) -> Array:
    """Rates of the joint coordinates from those of the rows, (N, size).

    By the Jacobian's blocks, so that what rests does so exactly.
    """
    found = np.zeros_like(right_hand_side)
    for rows, columns in tree.blocks:
        some = jacobian[:, rows]
        rest = right_hand_side[:, rows] - np.einsum("nij,nj->ni", some, found)
        found[:, columns] = np.linalg.solve(some[:, :, columns], rest[..., None])[..., 0]
    return found
