r"""Where every point of a pose and its rates exactly are: a correction, and two radii about it.

The certificate of a pose gives y* = y - e to within its spread and tail. Its rates solve

    2 B(y*, v*) = 0,        2 B(y*, a*) + 2 B(v*, v*) = 0,

with known rates w', w'', and so on: of the derivative d, 2 B(y*, z_d) + sum_{0<i<d} C(d, i) B(z_i, z_{d-i}).
For a computed v with the exact w' in it, r = 2 B(y*, v), and X close to C_u^-1,

    C_u(y*) (v* - v) = -r,        v* - v = -X r + E (v* - v),        E = I - X C_u(y*).

With q >= |X r|, rounding and doubt of r included, and z' = z + omega r_pose >= |E| of the certificate,

    |v* - v| <= max q / (1 - z') = d,    |v* - v| <= q + F d,    |v* - v| <= q + F (q + F d),

element by element, F = |I - X C_u(y)| + |X| |C_u(y*) - C_u(y)| >= |E|; so a coordinate that does not depend
on another does not share its error. The same for a with r = 2 B(y*, a) + 2 B(v*, v*). r is taken in twice the
working precision of numbers that are known to twice the working precision, so nothing is left of rounding but
what the data have; and it sees whatever a series left out.

What looking at an equation rounds, the expected radius, is |X| times what a plain evaluation of r rounds,
with the pose (and the velocity) off by as much as rounding makes them and as the solver left on purpose; and
of a series what it leaves out on purpose, of each derivative apart, because the series of a rate is cut where
the pose's is.

All this is of groups of neighbours that share X, F and their radii; e, r and v are each pose's own.

A carried point is p = p_0 + a e1 + b e2 + c e1 x e2 with weights that are known to twice the working
precision, and its derivatives follow by Leibniz' rule.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import comb

import numpy as np
from numpy.typing import NDArray

from pointcoord.bounds.certified_poses import CertifiedPoses
from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.constraints.in_body import carrier_weights
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.slopes import Way
from pointcoord.numerics.double_double import PAIRS, two_sum
from pointcoord.numerics.enclosed_rows import differences, twice_polar
from pointcoord.numerics.enclosure import Enclosed, anchored, cross
from pointcoord.numerics.kantorovich import applied
from pointcoord.numerics.quadratic import QuadraticMap
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]
Points = Mapping[str, Enclosed]
Edges = tuple[Enclosed, Enclosed]
Numbers = Mapping[str, Mapping[str, Array]]
"""Arrays by quantity and by name: of a point or a body (N, 3), of a car (N,)."""


@dataclass(frozen=True)
class EnclosedPoses:
    """Where the points of solved poses exactly are: what the error of every reported number is told from.

    Numbers are of N poses, (N, ...), or of G groups of m that share their radii, (G, m, ...). Time is in a
    unit of its own for each, so that no rate overflows.

    Attributes:
        points: by time derivative, every point after the turns of the chassis, (N, 3), in the mechanism's
            units.
        in_chassis: the same before these turns.
        added: by time derivative, what reporting a point adds to it, (N, 3), mm and s.
        powers: of the unit of time, s^d for d = 0, 1, and so on, each (N,).
        slopes: by way, the derivatives of places along it, after the turns of the chassis and before, in
            units per rad, mm or unit; of the ways that effects take.
    """

    mechanism: Mechanism
    axes: CarAxes
    points: Sequence[Points]
    in_chassis: Sequence[Points]
    added: Sequence[Enclosed]
    powers: Sequence[Array]
    slopes: Mapping[Way, tuple[Points, Points]] = field(default_factory=dict)

    def reported(self, name: str, derivative: int) -> Enclosed:
        """What is reported of a point, or of its time derivative, (N, 3), mm per s^d."""
        unit = float(self.mechanism.unit) / self.powers[derivative]
        return self.points[derivative][name].scaled(unit[..., None]) + self.added[derivative]


def enclosed_coordinates(
    mechanism: Mechanism,
    poses: CertifiedPoses,
    rates: Sequence[Enclosed],
    unsolved: Array,
    cut: Sequence[Array],
    opened: tuple[Array, Array] | None = None,
) -> list[Enclosed]:
    """The exact coordinates y* and as many of their derivatives as were solved for, each (G, m, size).

    Args:
        rates: computed time derivatives of y, the known ones where they exactly are, (G, m, size), units per
            unit of time^d.
        unsolved: how far from its assembly a pose of each group was left on purpose, (G,).
        cut: by derivative, what its series leaves out on purpose, (G, size); empty if there is none.
        opened: rates at which some rows read coordinates to move beside, (size,), and 1 for these rows.
    """
    system, n = mechanism.map, mechanism.map.unknowns
    certificate, magnitude, pose = poses.certificate, np.abs(poses.factors.preconditioner), poses.pose
    largest = np.abs(certificate.step).max(axis=1)
    spread = certificate.spread[:, 0] + 32.0 * UNIT_ROUNDOFF * largest
    proven = spread + _tail(system, poses, magnitude, spread + largest)
    uncertain = system.uncertainty(pose.high[:, 0], pose.radius[1, :, 0])
    looking = np.matvec(magnitude, uncertain) + unsolved[:, None]
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
            # Twice B of two different ones is both of them, and of one with itself two of them.
            count = comb(order, i) // (2 if 2 * i == order else 1)
            rest = rest + twice_polar(system, edges[i], edges[order - i]).times(count)
        result.append(_corrected(computed, rest, poses, spoilt))
    for state, left in zip(result, cut, strict=False):
        state.radius[1, :, 0, :n] += left[:, :n]
    return result


def _tail(system: QuadraticMap, poses: CertifiedPoses, magnitude: Array, known: Array) -> Array:
    """What is left of the error of each coordinate beside e and its spread, (G, unknowns).

    By the mean value form of `kantorovich`, with r the error of each coordinate instead of the largest:
    |I - X C_u| r + |X| |C_u(y + r) - C_u(y)| r / 2, first for the largest and then for what that gives.

    Args:
        known: largest |e| and its spread, (G, unknowns).
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
    """The rates that leave no rest, from computed ones that leave `rest` = 2 B(y*, .) + ...

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
    # A rate that does not depend on the others is solved for with them, and has a rounding of theirs left
    # after one refinement.
    shared = gamma * poses.factors.condition * rounded.max(axis=-1)
    return _moved(computed, step, proven + tail, rounded + shared[:, None])


def _moved(computed: Enclosed, by: Array, proven: Array, expected: Array) -> Enclosed:
    """Computed coordinates with the unknown ones moved, (G, m, unknowns), which has radii, (G, unknowns)."""
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
    """Every point and as many of its derivatives as there are, each (N, 3), in units per s^d."""
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
    """From the first of a body's points to its second and to its third."""
    base, first, second = (points[name] for name in names[:3])
    return first - base, second - base


def _frame(found: Sequence[Points], carriers: Sequence[str]) -> tuple[list[Edges], list[Enclosed]]:
    """The edges of a body and e1 x e2, with their derivatives."""
    edges = [edges_of(points, carriers) for points in found]
    return edges, _normals(edges)


def _carried(weights: Enclosed, edges: Sequence[Edges], normals: Sequence[Enclosed]) -> list[Enclosed]:
    """p - p_0 and its derivatives."""
    a, b, c = (weights.take([i]) for i in range(3))
    return [a * e1 + b * e2 + c * crossed for (e1, e2), crossed in zip(edges, normals, strict=True)]


def _normals(edges: Sequence[Edges]) -> list[Enclosed]:
    """e1 x e2 and its derivatives by Leibniz' rule."""
    result = []
    for order in range(len(edges)):
        first, *others = (
            cross(edges[order - i][0], edges[i][1]).times(comb(order, i)) for i in range(order + 1)
        )
        result.append(sum(others, first))
    return result


def exact_weights(mechanism: Mechanism, name: str) -> Enclosed:
    """The weights that give the drawn point exactly, (3,)."""
    values, lacks, doubt = carrier_weights(mechanism.drawing, name, mechanism.topology.carried[name])
    # The doubt is PAIRS of magnitudes that plain doubles round some four times.
    return Enclosed.of(values, lacks, doubt, 4.0 * UNIT_ROUNDOFF / PAIRS * doubt)
