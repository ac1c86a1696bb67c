r"""Where the poses near a solved one are: a second-order expansion in the driven coordinates.

The configuration c (origins and unit quaternions, as Pinocchio keeps them) is a function of the targets u
of the inputs' rows. At a pose with Jacobian J, and with x_i the velocities at unit rate of the i-th target,
    J x_i = e_i,   J y = -drift(v)   for v = sum_i x_i u_i,
    o = o_a + v_o + y_o / 2,   quaternion  p = p_a + w p_a / 2 + (y_w p_a / 2 - |w|^2 p_a / 4) / 2,
products of quaternions, w the angular part of v. It is off by the third order.

Between two poses a and b, the targets lie at the share s on the line from one to the other, and d beside it.
With t = 1 - s, and with the derivatives along the line (') and beside it (_d) of second order at most, that
are known at both ends,
    c   = t^3 [c_a (1 + 3 s + 6 s^2) + s c_a' (1 + 3 s) + s^2 c_a'' / 2] + the same from b,
    c_d = t^2 [c_ad (1 + 2 s) + s c_ad'] + the same from b,     c_dd = t c_add + s c_bdd
are Hermite's interpolations on the line, and c + c_d d + c_dd d^2 / 2 is the configuration: off by the sixth
order of the way, the fourth times d, the second times d^2, and the third order of d.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.backend import eigenpy
from absolute.mechanism import Mechanism
from absolute.solution import Array
from absolute.stack import Placed
from absolute.vectors import cross


class Expansion(NamedTuple):
    """The configuration as a polynomial of the targets of the inputs' rows.

    Attributes:
        place: (inputs,) targets at the pose.
        terms: (1 + inputs + pairs, configuration) coefficients of 1, u_i and u_i u_j, i <= j in the order of
            `pairs_of`, u counted from `place`.
    """

    place: Array
    terms: Array


@cache
def pairs_of(inputs: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Numbers i <= j of all products of two inputs: the squares first."""
    squares = [(i, i) for i in range(inputs)]
    mixed = [(i, j) for i in range(inputs) for j in range(i + 1, inputs)]
    first, second = np.array(squares + mixed, dtype=np.intp).reshape(-1, 2).T
    return first, second


def expand(
    mechanism: Mechanism, q: Array, placed: Placed, factors: eigenpy.PartialPivLU, place: Array
) -> Expansion:
    """The expansion at a configuration, with its rows and the factors of its Jacobian."""
    count, rows = len(place), mechanism.stack.count
    driven = np.zeros((rows, count))
    driven[mechanism.joint_rows :] = np.eye(count)
    straight = factors.solve(driven).reshape(rows, count).T
    first, second = pairs_of(count)
    # A square, and the product of a sum: half the difference of squares is the product of two.
    ways = straight[first]
    ways[count:] += straight[second[count:]]
    twist = np.zeros((len(ways), len(placed.origin), 2, 3))
    twist[:, 1:] = ways.reshape(len(ways), -1, 2, 3)
    drift = mechanism.stack.drift(placed, twist)
    curve = factors.solve(-drift.T).reshape(rows, len(ways)).T.reshape(len(ways), -1, 2, 3)
    body = q.reshape(-1, 7)
    turn = body[:, 3:]
    terms = np.empty((1 + count + len(ways), *body.shape))
    terms[0] = body
    slopes = straight.reshape(count, -1, 2, 3)
    terms[1 : 1 + count, :, :3] = slopes[:, :, 0]
    terms[1 : 1 + count, :, 3:] = 0.5 * turned(slopes[:, :, 1], turn)
    spin = twist[:, 1:, 1]
    bends = terms[1 + count :]
    bends[:, :, :3] = 0.5 * curve[:, :, 0]
    bends[:, :, 3:] = 0.25 * turned(curve[:, :, 1], turn) - 0.125 * np.vecdot(spin, spin)[..., None] * turn
    bends[count:] -= bends[first[count:]] + bends[second[count:]]
    return Expansion(place, terms.reshape(len(terms), -1))


def turned(spin: Array, turn: Array) -> Array:
    """Product of the quaternions (spin, 0) and `turn`, each (..., 4) as x, y, z, w."""
    product = np.empty((*spin.shape[:-1], 4))
    product[..., :3] = turn[:, 3:] * spin + cross(spin, turn[:, :3])
    product[..., 3] = -np.vecdot(spin, turn[:, :3])
    return product


def products(change: Array) -> Array:
    """(N, pairs) products of two of the changes (N, inputs)."""
    first, second = pairs_of(change.shape[1])
    product: Array = change.take(first, 1)
    product *= change.take(second, 1)
    return product


class Line(NamedTuple):
    """Targets of N instants beside the line between two places.

    Attributes:
        way: (inputs,) from the first to the second place.
        share: (N, 1) of the way, at the foot. beside: (N, inputs) from the foot.
    """

    way: Array
    share: Array
    beside: Array

    def part(self, of: NDArray[np.intp]) -> "Line":
        """Some of the instants."""
        return Line(self.way, self.share[of], self.beside[of])


def line_between(start: Array, end: Array, places: Array) -> Line:
    """Where targets (N, inputs) are on the line between two; beside the first if those are the same."""
    way, off = end - start, places - start
    square = float(way @ way)
    share = (off @ (way / square if square > 0.0 else way))[:, None]
    return Line(way, share, off - share * way)


def between(start: Expansion, end: Expansion, line: Line) -> Array:
    """(N, configuration) by both expansions."""
    beside, weighted = line.beside, []
    across = products(beside)
    for way, s in ((line.way, line.share), (-line.way, 1.0 - line.share)):
        t = 1.0 - s
        along = s * way
        squares, both = products(along), products(along + beside)
        square, cube = t * t, t * t * t
        weighted += [
            cube * (1.0 + s * (3.0 + 6.0 * s)),
            cube * (1.0 + 3.0 * s) * along + square * (1.0 + 2.0 * s) * beside,
            cube * squares + square * (both - squares - across) + t * across,
        ]
    found: Array = np.concatenate(weighted, axis=1) @ np.concatenate((start.terms, end.terms))
    return found
