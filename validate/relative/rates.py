r"""Velocities and accelerations of a linkage at solved poses, from the joints' screws.

The screw S_k of a joint coordinate moves with the body that it belongs to. With q' and q'' the rates of the
joint coordinates (of a spherical joint the components of its angular velocity and their rates), a body b has

    V_b = sum_k S_k q'_k,    A_b = sum_k (S_k q''_k + V_k x S_k q'_k)

over its chain of joints, V_k being that of the coordinate's own body and x the product of screws. A point p
of it has p' = v + w x p and p'' = v' + w' x p + w x p'. The rows' rates are linear in q' and q'':

    J q' = f',    J q'' = f'' - (J' q').

Arrays of all poses at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.relative.follow import Poses, at_places
from validate.relative.tree import Places, Tree

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rates:
    """How the linkage moves, at each pose.

    Attributes:
        jacobian: of the rows, (N, size, size).
        first, second: rates of the joint coordinates, (N, size).
        twists, accelerations: of the bodies and of the chassis, which rests, (N, bodies + 1, 6); linear, of
            the point at the origin, and angular.
    """

    jacobian: Array
    first: Array
    second: Array
    twists: Array
    accelerations: Array


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


def screws_by_joint(poses: Poses) -> Array:
    """Screws, (N, size, 6)."""
    return np.ascontiguousarray(np.swapaxes(poses.screws, 1, 2))


def chain_sum(tree: Tree, terms: Array) -> Array:
    """Sums over each body's chain of joints, (..., size, 6) to (..., bodies + 1, 6); the chassis rests."""
    return np.asarray(tree.chains @ terms)


def carried(twist: Array, at: Array) -> Array:
    """Velocity of points at places by the twists of their bodies, (..., 6) and (..., 3) to (..., 3)."""
    return np.asarray(twist[..., :3] + cross(twist[..., 3:], at))


def closure_gaps(tree: Tree, ends: Array) -> Array:
    """First points of the closures less their second ones, of numbers of all ends, (..., closures, 3)."""
    count = len(tree.linkage.closures)
    return np.asarray(ends[..., :count, :] - ends[..., count : 2 * count, :])


def as_rows(tree: Tree, apart: Array, along: Array, driven: Array) -> Array:
    """Rows, (..., size).

    Args:
        apart: of the closures, (..., closures, 3). along: of the rods, (..., rods).
        driven: of the drives, (..., drives, 3).
    """
    found = np.empty((*apart.shape[:-2], tree.size))
    found[..., tree.ball_rows] = apart[..., tree.balls, :]
    found[..., tree.rod_rows] = along
    found[..., tree.first_drive :] = (driven * tree.directions).sum(axis=-1)
    return found


def row_jacobian(tree: Tree, screws: Array, poses: Poses) -> Array:
    """Of the rows, (N, size, size)."""
    at = at_places(poses, tree.ends)
    chain = tree.chains[tree.ends.body].T[:, :, None]
    by_joint = carried(screws[:, :, None], at[:, None]) * chain
    apart, rods = closure_gaps(tree, by_joint), closure_gaps(tree, at)[:, tree.rods]
    along = (apart[:, :, tree.rods] * rods[:, None]).sum(axis=-1) / tree.lengths
    drives = by_joint[:, :, 2 * len(tree.linkage.closures) :]
    return np.swapaxes(as_rows(tree, apart, along, drives), 1, 2)


def point_velocities(poses: Poses, twists: Array, places: Places) -> Array:
    """Of points of bodies, (N, P, 3)."""
    return carried(twists[:, places.body], at_places(poses, places))


def point_accelerations(poses: Poses, twists: Array, accelerations: Array, places: Places) -> Array:
    """Of points of bodies, (N, P, 3)."""
    at, twist = at_places(poses, places), twists[:, places.body]
    return carried(accelerations[:, places.body], at) + cross(twist[..., 3:], carried(twist, at))


def row_accelerations(tree: Tree, poses: Poses, twists: Array, accelerations: Array) -> Array:
    """Second rates of the rows, without what the inputs give, (N, size)."""
    ends = point_accelerations(poses, twists, accelerations, tree.ends)
    apart, rods = closure_gaps(tree, ends), closure_gaps(tree, at_places(poses, tree.ends))[:, tree.rods]
    fast = closure_gaps(tree, point_velocities(poses, twists, tree.ends))[:, tree.rods]
    along = ((rods * apart[:, tree.rods]).sum(-1) + (fast * fast).sum(-1)) / tree.lengths
    return as_rows(tree, apart, along, ends[:, 2 * len(tree.linkage.closures) :])


def drive_rates(tree: Tree, inputs: Array) -> tuple[Array, Array]:
    """First and second rates of what the drives' rows are to be, (N, size) each, the other rows zero.

    Args:
        inputs: value, rate and acceleration, (N, drives, 3), rad and sizes of the car.
    """
    first, second = np.zeros((len(inputs), tree.size)), np.zeros((len(inputs), tree.size))
    for row, drive in enumerate(tree.linkage.drives, tree.first_drive):
        value, rate, acceleration = np.moveaxis(inputs[:, row - tree.first_drive], -1, 0)
        if drive.kind == "angle":
            sine, cosine = np.sin(value), np.cos(value)
            first[:, row] = -drive.size * sine * rate
            second[:, row] = -drive.size * (cosine * rate * rate + sine * acceleration)
        else:
            first[:, row], second[:, row] = drive.size * rate, drive.size * acceleration
    return first, second


def rates_of(tree: Tree, poses: Poses, inputs: Array) -> Rates:
    """Rates at solved poses.

    Args:
        inputs: value, rate and acceleration, (N, drives, 3), rad and sizes of the car.
    Raises:
        LinAlgError: a Jacobian is singular to rounding.
    """
    screws = screws_by_joint(poses)
    jacobian = row_jacobian(tree, screws, poses)
    wanted, wanted_second = drive_rates(tree, inputs)
    first = solved(tree, jacobian, wanted)
    moved = screws * first[..., None]
    twists = chain_sum(tree, moved)
    turning = screw_product(twists[:, tree.body_of], moved)
    bias = row_accelerations(tree, poses, twists, chain_sum(tree, turning))
    second = solved(tree, jacobian, wanted_second - bias)
    accelerations = chain_sum(tree, turning + screws * second[..., None])
    return Rates(jacobian, first, second, twists, accelerations)


def solved(tree: Tree, jacobian: Array, right_hand_side: Array) -> Array:
    """Rates of the joint coordinates from those of the rows, (N, size).

    A drive's row has the driven coordinate alone: it is solved first, so that what rests does so exactly.
    """
    driven, free, first = tree.driven, tree.free, tree.first_drive
    found = np.empty_like(right_hand_side)
    rows = np.arange(first, tree.size)
    found[:, driven] = right_hand_side[:, first:] / jacobian[:, rows, driven]
    closures = jacobian[:, :first]
    rest = right_hand_side[:, :first] - np.einsum("nij,nj->ni", closures[:, :, driven], found[:, driven])
    found[:, free] = np.linalg.solve(closures[:, :, free], rest[..., None])[..., 0]
    return found
