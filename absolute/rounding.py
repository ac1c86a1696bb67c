"""What the rows of a solved pose are rounded from, and how far their equations may be off for it.

A rounding is even between -eps / 2 and eps / 2 of the power of two below a number x, so its mean square is
eps^2 / 12 times the mean of (2^k / x)^2, which is 1 / 2 for even x: a standard deviation of eps / 2 / sqrt(6)
of x. It is made in one component of a vector, with a mean square of a third. Of n independent ones made
in vectors whose lengths add up to M, four standard deviations are  spread(n) M,  and from row to row they
add up in squares again.
"""

import math

import numpy as np

from absolute.mechanism import Mechanism
from absolute.precision import EPS
from absolute.solution import Array
from absolute.stack import Placed, RowMotion


def spread(roundings: int) -> float:
    """Four standard deviations of so many independent roundings in vectors."""
    return 4.0 * math.sqrt(roundings / 18.0) * EPS / 2.0


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
# An input's law, its factor (three), the size, their product: at worst.
TARGET = 6 * EPS / 2.0


def pose_doubt(mechanism: Mechanism, placed: Placed, target: Array) -> Array:
    """(N, rows) four standard deviations of what  rows = target  is off by rounding, in units of size."""
    stack = mechanism.stack
    offsets = stack.offset_rows
    rounded: Array = REACH * length(placed.reach) + TARGET * np.abs(target)
    # The partner of a right angle is another direction; points have arms, and are somewhere.
    rounded[:, : offsets.start] += DIRECTION
    rounded[:, stack.turn_rows] += DIRECTION
    second, first = placed.parts[:, 1, offsets], placed.parts[:, 2, offsets]
    rounded[:, offsets] += PLACE * (length(first) + length(second))
    r1 = placed.parts[:, 3, offsets] - placed.reach[:, offsets]
    rounded[:, offsets] += ARM * (length(r1) + length(placed.parts[:, 4, offsets]))
    return rounded


def rate_doubt(motion: RowMotion, target: Array) -> Array:
    """(N, rows) likewise of  J v = target."""
    return np.asarray(RATE * pushes(motion) + TARGET * np.abs(target))


def second_doubt(motion: RowMotion, bending: RowMotion, target: Array) -> Array:
    """(N, rows) likewise of  J a = target - drift.

    Args:
        motion, bending: rows at the velocities and at the accelerations of the bodies.
    """
    # The direction of a distance turns by itself.
    w1, w2 = np.maximum(length(motion.w1), length(motion.a1)), length(motion.w2)
    e, r1, r2 = length(motion.e), length(motion.r1), length(motion.r2)
    speeds = length(motion.s1) + length(motion.s2) + w1 * (r1 + e) + w2 * r2
    terms = w1 * w1 * (e + r1) + w2 * w2 * r2 + 2.0 * w1 * speeds
    return np.asarray(RATE * pushes(bending) + DRIFT * terms + TARGET * np.abs(target))


def pushes(motion: RowMotion) -> Array:
    """(N, rows) sum of the magnitudes of the terms of a row's rate."""
    turning = length(motion.w1) * (length(motion.e) + length(motion.r1))
    pushed: Array = turning + length(motion.w2) * length(motion.r2) + length(motion.s1) + length(motion.s2)
    return pushed


def length(vectors: Array) -> Array:
    """Lengths over the last axis."""
    lengths: Array = np.sqrt(np.vecdot(vectors, vectors))
    return lengths
