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

from validate.relative.follow import Poses, at_place
from validate.relative.linkage import CHASSIS, Coincide, Distance, Place
from validate.relative.tree import Tree

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Rates:
    """How the linkage moves, at each pose.

    Attributes:
        jacobian: of the rows, (N, size, size).
        first, second: rates of the joint coordinates, (N, size).
        twists, accelerations: of the bodies, (N, bodies, 6); linear, of the point at the origin, and angular.
    """

    jacobian: Array
    first: Array
    second: Array
    twists: Array
    accelerations: Array


def cross(a: Array, b: Array) -> Array:
    """The vector product, (..., 3); quicker than numpy's own."""
    a0, a1, a2, b0, b1, b2 = a[..., 0], a[..., 1], a[..., 2], b[..., 0], b[..., 1], b[..., 2]
    return np.stack([a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0], axis=-1)


def screw_product(a: Array, b: Array) -> Array:
    """Rate of a screw b that moves with a twist a, (..., 6)."""
    turn = a[..., 3:]
    return np.concatenate(
        [cross(turn, b[..., :3]) + cross(a[..., :3], b[..., 3:]), cross(turn, b[..., 3:])], axis=-1
    )


def screws_by_joint(poses: Poses) -> Array:
    """Screws, (N, size, 6)."""
    return np.ascontiguousarray(np.swapaxes(poses.screws, 1, 2))


def chain_sum(tree: Tree, terms: Array) -> Array:
    """Sums over each body's chain of joints, (..., size, 6) to (..., bodies, 6)."""
    return np.asarray(tree.chains @ terms)


def point_jacobian(tree: Tree, screws: Array, poses: Poses, place: Place) -> Array:
    """Velocity of a point per rate of each joint coordinate, (N, size, 3)."""
    if place.body == CHASSIS:
        return np.zeros((*screws.shape[:2], 3))
    p = at_place(tree, poses, place)[:, None, :]
    chain = tree.chains[tree.bodies.index(place.body)][:, None]
    return np.asarray((screws[..., :3] + cross(screws[..., 3:], p)) * chain)


def row_jacobian(tree: Tree, screws: Array, poses: Poses) -> Array:
    """Of the rows, (N, size, size)."""
    found = np.empty((len(screws), tree.size, tree.size))
    row = 0
    for closure in tree.linkage.closures:
        apart = point_jacobian(tree, screws, poses, closure.first) - point_jacobian(
            tree, screws, poses, closure.second
        )
        if isinstance(closure, Coincide):
            found[:, row : row + 3] = np.swapaxes(apart, 1, 2)
            row += 3
        else:
            found[:, row] = np.einsum("nki,ni->nk", apart, link(tree, poses, closure)) / closure.length
            row += 1
    for drive in tree.linkage.drives:
        found[:, row] = point_jacobian(tree, screws, poses, drive.place) @ drive.direction
        row += 1
    return found


def link(tree: Tree, poses: Poses, closure: Distance) -> Array:
    """From the second to the first point of a link, (N, 3)."""
    return at_place(tree, poses, closure.first) - at_place(tree, poses, closure.second)


def point_velocity(tree: Tree, poses: Poses, twists: Array, place: Place) -> Array:
    """Of a point of a body, (N, 3)."""
    if place.body == CHASSIS:
        return np.zeros((len(twists), 3))
    twist = twists[:, tree.bodies.index(place.body)]
    return np.asarray(twist[:, :3] + cross(twist[:, 3:], at_place(tree, poses, place)))


def point_acceleration(tree: Tree, poses: Poses, twists: Array, accelerations: Array, place: Place) -> Array:
    """Of a point of a body, (N, 3)."""
    if place.body == CHASSIS:
        return np.zeros((len(twists), 3))
    body = tree.bodies.index(place.body)
    twist, acceleration = twists[:, body], accelerations[:, body]
    p = at_place(tree, poses, place)
    velocity = twist[:, :3] + cross(twist[:, 3:], p)
    return np.asarray(acceleration[:, :3] + cross(acceleration[:, 3:], p) + cross(twist[:, 3:], velocity))


def row_accelerations(tree: Tree, poses: Poses, twists: Array, accelerations: Array) -> Array:
    """Second rates of the rows, without what the inputs give, (N, size)."""
    found = np.empty((len(twists), tree.size))
    row = 0
    for closure in tree.linkage.closures:
        one, two = (
            point_acceleration(tree, poses, twists, accelerations, place)
            for place in (closure.first, closure.second)
        )
        if isinstance(closure, Coincide):
            found[:, row : row + 3] = one - two
            row += 3
        else:
            fast = point_velocity(tree, poses, twists, closure.first) - point_velocity(
                tree, poses, twists, closure.second
            )
            products = (link(tree, poses, closure) * (one - two)).sum(-1) + (fast * fast).sum(-1)
            found[:, row] = products / closure.length
            row += 1
    for drive in tree.linkage.drives:
        found[:, row] = point_acceleration(tree, poses, twists, accelerations, drive.place) @ drive.direction
        row += 1
    return found


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
