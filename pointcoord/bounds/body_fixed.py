r"""Error bounds of points that ride on a body, from the certificate of the points that carry them.

p = p_0 + a e1 + b e2 + c e1 x e2 with e_i = p_i - p_0 has the derivatives

    K1 = a I - c [e2]x,    K2 = b I + c [e1]x,    K0 = I - K1 - K2,

by the three carriers. With the step e, its uncertainty and the tail of the certificate (see `kantorovich`),
all in a pose where every edge is off by at most 2 r,

    |p* - p| <= |sum K_i e_i| + sum |K_i| (spread_i + tail) + 8 |c| r^2,

the last term being c times the product of two errors of edges. To this come three roundings. Taking p from
y rounds at most 9 times relative to M = |p_0| + |a e1| + |b e2| + |c| |e1| x |e2|, each product with its
own magnitudes. The weights solve the drawn triangle to a rest that is measured, with M of the drawing for
its own rounding, and the rest turns with the body, so that only its length counts. And what is reported
differs from p by an amount that is measured as well.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.certified_poses import CertifiedPoses
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import Pair
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT, axes_first_cross

Array = NDArray[np.float64]
Carriers = tuple[Array, Array, Array]

ROUNDINGS = 10.0 * UNIT_ROUNDOFF  # the nine of p and one for the distance from what is reported


def carried_errors(
    mechanism: Mechanism, y: Array, local: Mapping[str, Pair], certified: CertifiedPoses, shifted: Array
) -> tuple[Array, Array]:
    """Bound of the reported carried points, in units, and their gain over their carriers, shape (N,).

    Args:
        y: coordinates, shape (size, N).
        local: positions of the points that are reported without what was added to report them, as high and
            low, in units, each of shape (3, N).
        shifted: rounding of what was added, in units, shape (3, N).
    """
    bound, gain = np.zeros(y.shape[-1]), np.ones(y.shape[-1])
    largest = np.abs(certified.step).max(axis=0)
    for name, carriers in mechanism.topology.carried.items():
        if name not in local:
            continue
        weights = mechanism.carrier_weights[name]
        a, b, c = weights
        places = [list(mechanism.layout.vector(point)) for point in carriers]
        base, first, second = (y[place] for place in places)
        e1, e2 = first - base, second - base
        # K0 = (1 - a - b) I + c [e2 - e1]x, K1 = a I - c [e2]x and K2 = b I + c [e1]x: their diagonals, and
        # the vectors whose cross products they are.
        derivatives = ((abs(1.0 - a - b), np.abs(e2 - e1)), (abs(a), np.abs(e2)), (abs(b), np.abs(e1)))
        steps, spreads = ([v[place] for place in places] for v in (certified.step, certified.spread))
        first_step, second_step = steps[1] - steps[0], steps[2] - steps[0]
        turned = axes_first_cross(first_step, e2) + axes_first_cross(e1, second_step)
        moved = np.abs(steps[0] + a * first_step + b * second_step + c * turned)
        rows = sum(along + abs(c) * (edge[NEXT] + edge[LAST]) for along, edge in derivatives)
        doubt = rows * certified.tail
        for (along, edge), spread in zip(derivatives, spreads, strict=True):
            doubt += along * spread + abs(c) * (edge[NEXT] * spread[LAST] + edge[LAST] * spread[NEXT])
        # The step moves the point by as much as these products at most, and each is rounded a few times.
        reach = 1.0 + 2.0 * (abs(a) + abs(b) + 2.0 * abs(c) * (np.abs(e1) + np.abs(e2)).max(axis=0))
        doubt += 32 * UNIT_ROUNDOFF * reach * largest
        curved = 8.0 * abs(c) * certified.radius**2
        found, size = _carried(weights, (base, first, second))
        each = moved + doubt + apart(local[name], found) + ROUNDINGS * size + shifted
        total = INFLATION * (each.max(axis=0) + curved + _unsolved(mechanism, name, carriers))
        bound = np.maximum(bound, np.where(np.isfinite(certified.radius), total, np.inf))
        gain = np.maximum(gain, INFLATION * rows.max(axis=0))
    return bound, gain


def apart(pair: Pair, place: Array) -> Array:
    """Distance of a sum of two numbers from a third that is close to it, to a rounding of itself."""
    high, low = pair
    return np.abs((high - place) + low)


def _carried(weights: Array, carriers: Carriers) -> tuple[Array, Array]:
    """The carried point and M, from carriers of shape (3, N); both of that shape."""
    base, first, second = carriers
    e1, e2 = first - base, second - base
    a, b, c = weights
    point = base + a * e1 + b * e2 + c * axes_first_cross(e1, e2)
    long, wide = np.abs(e1), np.abs(e2)
    crossed = long[NEXT] * wide[LAST] + long[LAST] * wide[NEXT]
    return point, np.abs(base) + abs(a) * long + abs(b) * wide + abs(c) * crossed


def _unsolved(mechanism: Mechanism, name: str, carriers: tuple[str, str, str]) -> float:
    """Length of what the weights leave of the drawn point."""
    vectors = mechanism.drawing.vectors
    base, first, second = (vectors[point] for point in carriers)
    found, size = _carried(mechanism.carrier_weights[name], (base, first, second))
    rest = np.abs(vectors[name] - found) + ROUNDINGS * size
    return float(np.linalg.norm(rest))
