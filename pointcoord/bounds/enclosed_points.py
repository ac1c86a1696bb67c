r"""Enclosures of the exact positions and rates of all points of a pose: a correction with two radii.

The certificate of a pose gives y* = y - e with the error bounds spread and tail. The exact rates solve

    2 B(y*, v*) = 0,        2 B(y*, a*) + 2 B(v*, v*) = 0,

with known rates w', w'', and so on; for derivative d, 2 B(y*, z_d) + sum_{0<i<d} C(d, i) B(z_i, z_{d-i}) = 0.
For a computed v with the exact w' inserted, r = 2 B(y*, v), and X close to C_u^-1,

    C_u(y*) (v* - v) = -r,        v* - v = -X r + E (v* - v),        E = I - X C_u(y*).

With q >= |X r|, rounding and data error of r included, and z' = z + omega r_pose >= |E| of the certificate,

    |v* - v| <= max q / (1 - z') = d,    |v* - v| <= q + F d,    |v* - v| <= q + F (q + F d),

element by element, with F = |I - X C_u(y)| + |X| |C_u(y*) - C_u(y)| >= |E|. So the error of a coordinate does
not spread to coordinates that do not depend on it. For a the same holds with r = 2 B(y*, a) + 2 B(v*, v*).
r is computed in twice the working precision from numbers in twice the working precision. So the only rounding
left in r is that of the data, and r contains the truncation error of a series.

The expected radius, `looking`, is |X| times the rounding of a plain evaluation of r, for a pose and velocity
with rounding errors and with the error at which the solver stopped. For a series the truncation error is
added, for each derivative separately, because the series of a rate is truncated where that of the pose is.

Groups of neighbouring poses share X, F and the radii; e, r and v are computed for each pose.

A carried point is p = p_0 + a e1 + b e2 + c e1 x e2 with weights in twice the working precision. Its
derivatives follow by the product rule of Leibniz.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import comb

import numpy as np

from pointcoord.bounds.certified_poses import CertifiedPoses
from pointcoord.linkage.constraints.in_body import carrier_weights
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import Way
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.double_double import PAIRS, two_sum
from pointcoord.numerics.enclosed_rows import differences, twice_polar
from pointcoord.numerics.enclosure import Enclosed, anchored, cross
from pointcoord.numerics.kantorovich import applied
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Points = Mapping[str, Enclosed]
Edges = tuple[Enclosed, Enclosed]
Numbers = Mapping[str, Mapping[str, Array]]
"""Arrays by quantity and name, (N, 3) of a point or a body and (N,) of the car."""


@dataclass(frozen=True)
class EnclosedPoses:
    """Enclosures of the exact points of solved poses, from which the errors of reported numbers are computed.

    Arrays are for N poses, (N, ...), or for G groups of m poses that share their radii, (G, m, ...). Every
    pose or group has a unit of time of its own, so that no rate overflows.

    Attributes:
        points: every point after the rotations of the chassis, by time derivative, (N, 3), in the
            mechanism's units.
        in_chassis: every point before the rotations of the chassis, likewise.
        added: origin plus displacement of the chassis, by time derivative, which is added to every reported
            point, (N, 3), mm and s.
        powers: powers of the unit of time, s^d for d = 0, 1, and so on, each (N,).
        slopes: derivatives of positions along each way that effects use, by way, after and before the
            rotations of the chassis, in units per rad, mm or unit.
    """

    mechanism: Mechanism
    axes: CarAxes
    points: Sequence[Points]
    in_chassis: Sequence[Points]
    added: Sequence[Enclosed]
    powers: Sequence[Array]
    slopes: Mapping[Way, tuple[Points, Points]] = field(default_factory=dict)

    @property
    def unit(self) -> float:
        """The unit of lengths, a power of two, mm."""
        return float(self.mechanism.unit)

    @cached_property
    def drawn(self) -> Points:
        """Drawn place of every point."""
        vectors = self.mechanism.drawing.vectors
        return {name: Enclosed.of(vectors[name]) for name in self.mechanism.topology.points}

    @property
    def origin(self) -> Enclosed:
        """From the user's origin to the mechanism's origin."""
        return Enclosed.of(self.mechanism.origin / self.unit)

    def constant(self, number: Array) -> Enclosed:
        """An exact number, equal for all poses."""
        return Enclosed.of(number)

    def in_mm(self, number: Enclosed, power: int, derivative: int) -> Enclosed:
        """A number of the unit of length^power and of time^-derivative, in mm and s; both are powers of 2."""
        return number.scaled(self.unit**power / self.powers[derivative])

    def reported(self, name: str, derivative: int) -> Enclosed:
        """A point, or its time derivative, as the user reads it, (N, 3), mm per s^d."""
        unit = self.unit / self.powers[derivative]
        return self.points[derivative][name].scaled(unit[..., None]) + self.added[derivative]


def enclosed_coordinates(
    mechanism: Mechanism,
    poses: CertifiedPoses,
    rates: Sequence[Enclosed],
    unsolved: Array,
    cut: Sequence[Array],
    opened: tuple[Array, Array] | None = None,
) -> list[Enclosed]:
    """The exact coordinates y* and the derivatives that were solved for, each (G, m, size).

    Args:
        rates: computed time derivatives of y, with exact values of the known ones, (G, m, size), units per
            unit of time^d.
        unsolved: expected distance of each coordinate from its assembly, largest in each group, (G, unknowns)
            or (G, 1): where the solver stopped, and where a series is cut for rates that are solved for at
            the pose (those with a series of their own have it in `cut`).
        cut: truncation error of the series, by derivative, (G, size); empty if there is no series.
        opened: rates of coordinates that only some rows read, in addition to `rates`, as a gap opens,
            (size,); and 1 for these rows.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    certificate, magnitude, pose = poses.certificate, np.abs(poses.factors.preconditioner), poses.pose
    largest = np.abs(certificate.step).max(axis=1)
    spread = certificate.spread[:, 0] + 32.0 * UNIT_ROUNDOFF * largest
    proven = spread + _tail(system, poses, magnitude, spread + largest)
    uncertain = system.uncertainty(pose.high[:, 0], pose.radius[1, :, 0])
    looking = np.matvec(magnitude, uncertain) + unsolved
    result = [_moved(pose, -certificate.step, proven, looking)]
    moved = np.zeros((len(proven), system.size))
    moved[:, :n] = largest + proven
    spoilt = certificate.defect + magnitude @ system.jacobian_uncertainty(moved)
    edges = []
    for order, computed in enumerate(rates, 1):
        edges.append(differences(system, result[-1]))
        rest = twice_polar(system, edges[0], differences(system, computed))
        if opened is not None:
            beside = twice_polar(system, edges[0], differences(system, Enclosed.of(opened[0])))
            rest = rest + beside.scaled(opened[1])
        for i in range(1, order // 2 + 1):
            # 2 B(z_i, z_j) is the sum of two terms for i != j, but twice the only term for i = j.
            count = comb(order, i) // (2 if 2 * i == order else 1)
            rest = rest + twice_polar(system, edges[i], edges[order - i]).times(count)
        result.append(_corrected(computed, rest, poses, spoilt))
    for state, left in zip(result, cut, strict=False):
        state.radius[1, :, 0, :n] += left[:, :n]
    return result


def _tail(system: QuadraticMap, poses: CertifiedPoses, magnitude: Array, known: Array) -> Array:
    """Error of each coordinate in addition to e and its spread, (G, unknowns).

    The mean value form of `kantorovich`, with the error r of each coordinate instead of the largest error:
    |I - X C_u| r + |X| |C_u(y + r) - C_u(y)| r / 2, first for the largest error, then for the result.

    Args:
        known: largest |e| plus its spread, (G, unknowns).
    """
    certificate = poses.certificate
    most = certificate.tail.max(axis=1)[:, None]
    tail = radius = np.broadcast_to(certificate.radius.max(axis=1)[:, None], known.shape)
    for _ in range(2):
        moved = np.concatenate([radius, np.zeros((len(radius), system.size - system.unknowns))], axis=-1)
        bent = 0.5 * magnitude @ system.jacobian_uncertainty(moved)
        tail = np.minimum(np.matvec(certificate.defect + bent, radius), most)
        radius = np.minimum(radius, known + tail)
    return tail


def _corrected(computed: Enclosed, rest: Enclosed, poses: CertifiedPoses, spoilt: Array) -> Enclosed:
    """The exact rates, from computed rates with the residual `rest` = 2 B(y*, .) + ...

    Args:
        spoilt: F, (G, unknowns, unknowns).
    """
    inverse = poses.factors.preconditioner
    n, magnitude = inverse.shape[-1], np.abs(inverse)
    gamma, middle = (n + 3) * EPS, rest.middle
    step = -applied(inverse, middle)
    proven = np.matvec(magnitude, rest.radius[0, :, 0] + gamma * np.abs(middle).max(axis=1))
    whole = np.abs(step).max(axis=1) + proven
    room = 1.0 - poses.certificate.contraction.max(axis=1)
    largest = np.where(room > 0.0, whole.max(axis=-1) / room, np.inf)[:, None]
    tail = np.matvec(spoilt, whole + np.matvec(spoilt, np.broadcast_to(largest, whole.shape)))
    rounded = np.matvec(magnitude, rest.radius[1, :, 0])
    # All rates are solved for together. So after one refinement a rate still has |I - X C_u| times a rounding
    # error of the others, also if it does not depend on them. The solver's X may be the inverse at a pose
    # near by, as far as |I - X C_u|^2 is below rounding (see `factors_at`).
    refined = np.maximum(gamma * poses.factors.condition, EPS**0.5)
    shared = refined * rounded.max(axis=-1)
    return _moved(computed, step, proven + tail, rounded + shared[:, None])


def _moved(computed: Enclosed, by: Array, proven: Array, expected: Array) -> Enclosed:
    """Computed coordinates with the unknown ones corrected by `by`, (G, m, unknowns), and with the radii
    `proven` and `expected`, (G, unknowns)."""
    n = by.shape[-1]
    step = anchored(by, (len(by), 1, n))
    high, low, radius, change, reach = (part.copy(order="K") for part in computed.parts)
    high[..., :n], low[..., :n] = two_sum(high[..., :n], step.high)  # an unknown one has no low part
    change[..., :n] += step.change
    reach[..., :n] += step.reach
    radius[0, ..., :n] += step.radius[0] + UNIT_ROUNDOFF * reach[..., :n] + proven[:, None]
    radius[1, ..., :n] = expected[:, None]
    radius[1] += UNIT_ROUNDOFF * computed.size
    return Enclosed(high, low, radius, change, reach)


def enclosed_points(mechanism: Mechanism, coordinates: Sequence[Enclosed]) -> list[dict[str, Enclosed]]:
    """Every point and its derivatives, one for each array of coordinates, each (N, 3), in units per s^d."""
    topology, layout = mechanism.topology, mechanism.layout
    found: list[dict[str, Enclosed]] = []
    for state in coordinates:
        names = (*topology.chassis, *topology.moving)
        found.append({name: state.take(layout.span(name)) for name in names})
    frames = {carriers: _frame(found, carriers) for carriers in set(topology.carried.values())}
    for name, carriers in topology.carried.items():
        weights = exact_weights(mechanism, name)
        for points, part in zip(found, _carried(weights, *frames[carriers]), strict=True):
            points[name] = points[carriers[0]] + part
    return found


def edges_of(points: Points, names: Sequence[str]) -> tuple[Enclosed, Enclosed]:
    """The vectors from the first point of a body to its second and its third."""
    base, first, second = (points[name] for name in names[:3])
    return first - base, second - base


def _frame(found: Sequence[Points], carriers: Sequence[str]) -> tuple[list[Edges], list[Enclosed]]:
    """The edges e1, e2 of a body and e1 x e2, with their derivatives."""
    edges = [edges_of(points, carriers) for points in found]
    return edges, _normals(edges)


def _carried(weights: Enclosed, edges: Sequence[Edges], normals: Sequence[Enclosed]) -> list[Enclosed]:
    """p - p_0 of a carried point, and its derivatives."""
    a, b, c = (weights.take([i]) for i in range(3))
    return [a * e1 + b * e2 + c * crossed for (e1, e2), crossed in zip(edges, normals, strict=True)]


def _normals(edges: Sequence[Edges]) -> list[Enclosed]:
    """e1 x e2 and its derivatives, by the product rule of Leibniz."""
    result = []
    for order in range(len(edges)):
        first, *others = (
            cross(edges[order - i][0], edges[i][1]).times(comb(order, i)) for i in range(order + 1)
        )
        result.append(sum(others, first))
    return result


def exact_weights(mechanism: Mechanism, name: str) -> Enclosed:
    """Enclosure of the weights that give the drawn position of a carried point, (3,)."""
    values, lacks, doubt = carrier_weights(mechanism.drawing, name, mechanism.topology.carried[name])
    # The doubt is PAIRS times magnitudes; in plain doubles these magnitudes are rounded about four times.
    return Enclosed.of(values, lacks, doubt, 4.0 * UNIT_ROUNDOFF / PAIRS * doubt)
