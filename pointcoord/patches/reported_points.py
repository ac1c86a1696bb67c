r"""Series of every reported point in mm, and error bounds of their sums.

A solved point is three of the coordinates. A carried point is p_0 + a e1 + b e2 + c e1 x e2 (see
`linkage.carried_points`), a product of series that is truncated at their order. Its error bound includes the
truncation error, the errors of its carriers and the errors of the weights.

The error bound of every point includes the rounding of the sum at any inputs. With M powers of degree up to N
in p inputs, each product of powers is rounded about 4 N times, each variable 3 times for each of its powers,
and the sum M times, relative to the sum of magnitudes. The constant term, the largest, is added last and
rounded once.
"""

from __future__ import annotations

import numpy as np

from pointcoord.bounds.enclosed_points import exact_weights
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.kantorovich import INFLATION
from pointcoord.numerics.multi_index import powers
from pointcoord.numerics.power_series import cross_series
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.numerics.vectors import LAST, NEXT
from pointcoord.patches.jet import Jet


def moving_points(topology: Topology) -> tuple[str, ...]:
    """The points that a map reports: all except those of the chassis."""
    return (*topology.moving, *topology.carried)


def reported_points(mechanism: Mechanism, series: Array, error: Jet, order: int) -> tuple[Array, Jet]:
    """Series of the moving points, in the order of `moving_points`, three coordinates each.

    Args:
        series: series of all coordinates, shape (P, powers, size).
        error: error bounds of the unknown coordinates and of their derivatives, (P, unknowns), in the
            mechanism's units.
        order: total degree of the series.
    Returns:
        Coefficients, shape (P, powers, 3 points), mm from the mechanism's origin, and error bounds of their
        sums everywhere on the patch, (P, 3 points), mm.
    """
    topology, layout, inputs = mechanism.topology, mechanism.layout, error.first.shape[1]
    every = powers(inputs, order)
    found: dict[str, tuple[Array, Jet]] = {}
    for name in topology.moving:
        place = list(layout.vector(name))
        found[name] = series[..., place], error.taken(place)
    for name, (base, first, second) in topology.carried.items():
        found[name] = _carried(mechanism, name, (found[base], found[first], found[second]), order)
    parts = [found[name] for name in moving_points(topology)]
    coefficients = np.concatenate([part for part, _ in parts], axis=-1)
    off = Jet.joined([jet for _, jet in parts], -1)
    unit = float(mechanism.unit)
    coefficients = coefficients * unit
    later = Jet.of(coefficients[:, 1:], every.exponents[1:])
    count = every.count + 8 * order + 2 * inputs + 8
    summed = later.scaled(count * UNIT_ROUNDOFF)
    # One more rounding, by adding the constant term.
    last = Jet.constant(UNIT_ROUNDOFF * (np.abs(coefficients[:, 0]) + later.value), inputs)
    return coefficients, (off.scaled(unit) + summed + last).scaled(INFLATION)


Place = tuple[Array, Jet]


def _carried(
    mechanism: Mechanism, name: str, carriers: tuple[Place, Place, Place], order: int
) -> tuple[Array, Jet]:
    """Series of a carried point, in the mechanism's units, and its error bound."""
    (base, base_error), (first, first_error), (second, second_error) = carriers
    inputs = base_error.first.shape[1]
    weights, exact = mechanism.carrier_weights[name], exact_weights(mechanism, name)
    doubts = np.abs((exact.high - weights) + exact.low) + exact.radius[0]
    a, b, c = (float(weight) for weight in weights)
    e1, e2 = first - base, second - base
    off1, off2 = first_error + base_error, second_error + base_error
    normal = cross_series(e1, e2, inputs, doubled=True)
    own, doubled = powers(inputs, order), powers(inputs, 2 * order)
    beyond = Jet.of(normal[:, own.count :], doubled.exponents[own.count :])
    kept = normal[:, : own.count]
    size1, size2 = Jet.of(e1, own.exponents), Jet.of(e2, own.exponents)
    crossed = _cross_sizes(size1, size2)
    off3 = _cross_sizes(size1, off2) + _cross_sizes(off1, size2) + _cross_sizes(off1, off2)
    off3 = off3 + beyond + crossed.scaled((own.count + 6) * UNIT_ROUNDOFF)
    sizes = (size1, size2, crossed)
    error = base_error + off1.scaled(abs(a)) + off2.scaled(abs(b)) + off3.scaled(abs(c))
    for size, weight, doubt in zip(sizes, (a, b, c), doubts, strict=True):
        error = error + size.scaled(float(doubt) + 8.0 * UNIT_ROUNDOFF * abs(weight))
    error = error + Jet.of(base, own.exponents).scaled(4.0 * UNIT_ROUNDOFF)
    return base + a * e1 + b * e2 + c * kept, error


def _cross_sizes(a: Jet, b: Jet) -> Jet:
    """Bounds of the components of a x b from bounds of those of a and b."""
    return a.taken(NEXT) * b.taken(LAST) + a.taken(LAST) * b.taken(NEXT)
