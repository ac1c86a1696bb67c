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

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import Pair
from pointcoord.numerics.kantorovich import INFLATION, Certificate
from pointcoord.numerics.rounding import UNIT_ROUNDOFF

Array = NDArray[np.float64]
Carriers = tuple[Array, Array, Array]


ROUNDINGS = 10.0 * UNIT_ROUNDOFF  # the nine of p and one for the distance from what is reported


def carried_errors(
    mechanism: Mechanism, y: Array, local: Mapping[str, Pair], certificate: Certificate, shifted: Array
) -> tuple[Array, Array]:
    """Bound of the reported carried points, in units, and their gain over their carriers, shape (...,).

    Args:
        local: positions of the points that are reported without what was added to report them, as high and
            low, in units, each of shape (..., 3).
        shifted: rounding of what was added, in units, shape (..., 3).
    """
    bound, gain = np.zeros(y.shape[:-1]), np.ones(y.shape[:-1])
    for name, carriers in mechanism.topology.carried.items():
        if name not in local:
            continue
        weights = mechanism.carrier_weights[name]
        places = [list(mechanism.layout.vector(point)) for point in carriers]
        base, first, second = (y[..., place] for place in places)
        blocks = _derivatives(weights, base, first, second)
        steps, spreads = ([v[..., place] for place in places] for v in (certificate.step, certificate.spread))
        magnitude = np.stack([np.abs(block) for block in blocks])
        moved = np.abs(sum(_applied(block, step) for block, step in zip(blocks, steps, strict=True)))
        doubt = sum(
            _applied(np.abs(block), spread + certificate.tail[..., None] + 32 * UNIT_ROUNDOFF * np.abs(step))
            for block, spread, step in zip(blocks, spreads, steps, strict=True)
        )
        curved = 8.0 * np.abs(weights[..., 2]) * certificate.radius**2
        found, size = _carried(weights, (base, first, second))
        each = moved + doubt + apart(local[name], found) + ROUNDINGS * size + shifted
        total = INFLATION * (each.max(axis=-1) + curved + _unsolved(mechanism, name, carriers))
        bound = np.maximum(bound, np.where(np.isfinite(certificate.radius), total, np.inf))
        gain = np.maximum(gain, INFLATION * magnitude.sum(axis=(0, -1)).max(axis=-1))
    return bound, gain


def apart(pair: Pair, place: Array) -> Array:
    """Distance of a sum of two numbers from a third that is close to it, to a rounding of itself."""
    high, low = pair
    return np.abs((high - place) + low)


def _derivatives(weights: Array, base: Array, first: Array, second: Array) -> list[Array]:
    """K0, K1, K2, each of shape (..., 3, 3)."""
    a, b, c = (weights[..., i, None, None] for i in range(3))
    by_first = a * np.eye(3) - c * _cross_matrix(second - base)
    by_second = b * np.eye(3) + c * _cross_matrix(first - base)
    return [np.eye(3) - by_first - by_second, by_first, by_second]


def _applied(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


def _carried(weights: Array, carriers: Carriers) -> tuple[Array, Array]:
    """The carried point and M, both of shape (..., 3)."""
    base, first, second = carriers
    e1, e2 = first - base, second - base
    a, b, c = (weights[..., i, None] for i in range(3))
    point = base + a * e1 + b * e2 + c * np.cross(e1, e2)
    crossed = _applied(np.abs(_cross_matrix(e1)), np.abs(e2))
    size = np.abs(base) + np.abs(a * e1) + np.abs(b * e2) + np.abs(c) * crossed
    return point, size


def _unsolved(mechanism: Mechanism, name: str, carriers: tuple[str, str, str]) -> Array:
    """Length of what the weights leave of the drawn point, shape (...,)."""
    vectors = mechanism.drawing.vectors
    base, first, second = (vectors[point] for point in carriers)
    found, size = _carried(mechanism.carrier_weights[name], (base, first, second))
    rest = np.abs(vectors[name] - found) + ROUNDINGS * size
    return np.asarray(np.linalg.norm(rest, axis=-1))


def _cross_matrix(v: Array) -> Array:
    """[v]x with [v]x w = v x w, shape (..., 3, 3)."""
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    rows = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
