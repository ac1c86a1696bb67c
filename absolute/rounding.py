"""What the rows of a solved pose are rounded from, and how far their equations may be off for it.

Independent roundings of eps / 2, n of them, have a standard deviation of sqrt(n / 3) eps / 2. Taken three
times, n roundings of terms whose magnitudes add up to M leave `spread(n)` M. They are not added up like
this from row to row: there, the worst signs are assumed.
"""

import math
from typing import NamedTuple

import numpy as np

from absolute.assembly import Mechanism
from absolute.newton import EPS
from absolute.sensitivity import RowMotion
from absolute.solution import Array
from absolute.stack import Placed


def spread(roundings: int) -> float:
    """Three standard deviations of so many independent roundings."""
    return 3.0 * math.sqrt(roundings / 3.0) * EPS / 2.0


# A length from the drawing: a difference and a quotient. A rotation from a quaternion: four from the
# quaternion, four from its products. A turned vector: three products. Together, for an arm:
ARM = spread(2 + 8 + 3)
# A direction takes eleven where an arm takes two.
DIRECTION = spread(11 + 8 + 3)
# The product with it takes three more, the difference one.
REACH = spread(11 + 8 + 3 + 3 + 1)
# A point is rounded where it is.
PLACE = EPS / 2.0
# A direction or an arm, the vector product of both that is an entry of the Jacobian, and the sum of
# twelve products that is a row's rate.
RATE = spread(22 + 13 + 3 + 12)
# Two products with an angular velocity more, and the sum of three kinds of terms.
DRIFT = spread(22 + 13 + 2 * 3 + 12 + 3)
# An input's law, its factor, the size, their products.
TARGET = spread(6)


class Doubt(NamedTuple):
    """How far the equations of N poses may be off, each (N, rows), in units of size and s.

    Attributes:
        pose: of  rows = target. rate: of  J v = rate. second: of  J a = second - drift.
    """

    pose: Array
    rate: Array
    second: Array


def pose_doubt(mechanism: Mechanism, placed: Placed, target: Array) -> Array:
    """(N, rows): what is left of each row, and what the row is rounded from."""
    stack = mechanism.stack
    offsets = stack.offset_rows
    doubt: Array = np.abs(target - placed.values) + REACH * length(placed.reach) + TARGET * np.abs(target)
    # The partner of a right angle is another direction; points have arms, and are somewhere.
    doubt[:, : offsets.start] += DIRECTION
    second, first = placed.parts[:, 1, offsets], placed.parts[:, 2, offsets]
    doubt[:, offsets] += PLACE * (length(first) + length(second))
    r1 = placed.parts[:, 3, offsets] - placed.reach[:, offsets]
    doubt[:, offsets] += ARM * (length(r1) + length(placed.parts[:, 4, offsets]))
    return doubt


def rate_doubt(motion: RowMotion, jacobian: Array, rates: Array, target: Array) -> Array:
    """(N, rows): what is left of  J v = target,  and what its terms are rounded from."""
    left = target - np.einsum("nij,nj->ni", jacobian, rates)
    doubt: Array = np.abs(left) + RATE * pushes(motion) + TARGET * np.abs(target)
    return doubt


def second_doubt(
    motion: RowMotion, bending: RowMotion, jacobian: Array, seconds: Array, drift: Array, target: Array
) -> Array:
    """(N, rows): what is left of  J a = target - drift,  and what its terms are rounded from.

    Args:
        motion, bending: rows at the velocities and at the accelerations of the bodies.
    """
    left = target - drift - np.einsum("nij,nj->ni", jacobian, seconds)
    w1, w2 = length(motion.w1), length(motion.w2)
    e, r1, r2 = length(motion.e), length(motion.r1), length(motion.r2)
    speeds = length(motion.s1) + length(motion.s2) + w1 * r1 + w2 * r2
    terms = w1 * w1 * (e + r1) + w2 * w2 * r2 + 2.0 * w1 * speeds
    doubt: Array = np.abs(left) + RATE * pushes(bending) + DRIFT * terms + TARGET * np.abs(target)
    return doubt


def pushes(motion: RowMotion) -> Array:
    """(N, rows) sum of the magnitudes of the terms of a row's rate."""
    turning = length(motion.w1) * (length(motion.e) + length(motion.r1))
    pushed: Array = turning + length(motion.w2) * length(motion.r2) + length(motion.s1) + length(motion.s2)
    return pushed


def length(vectors: Array) -> Array:
    """Lengths over the last axis."""
    lengths: Array = np.sqrt(np.vecdot(vectors, vectors))
    return lengths
