r"""Where everything that a scene asks for exactly is, from where the coordinates and their rates are.

A carried point is p = p_0 + a e1 + b e2 + c e1 x e2 with weights that are known to twice the working
precision. A body turns as two edges of it do: with n = e1 x e2 and what an approximate rate w leaves of the
edges' rates, s_i = e_i' - w x e_i,

    omega - w = [ (s_1 . e2) n - (s_1 . n) e2 + (s_2 . n) e1 ] / |n|^2,

since s_i = (omega - w) x e_i exactly; alpha likewise from s_i = e_i'' - omega x (omega x e_i) - w x e_i. The
points of a rigid body give the same rates whichever of them are taken. An angle atan2(p, q) that was found as
f is off by d with sin d = (p cos f - q sin f) / |(p, q)|.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed, cross, dot, quotient
from pointcoord.numerics.rounding import EPS, UNIT_ROUNDOFF

Array = NDArray[np.float64]
Points = Mapping[str, Enclosed]


def enclosed_points(mechanism: Mechanism, coordinates: Sequence[Enclosed]) -> list[dict[str, Enclosed]]:
    """Every point and as many of its derivatives as there are, each (N, 3), in units per s^d."""
    topology, layout = mechanism.topology, mechanism.layout
    found: list[dict[str, Enclosed]] = []
    for state in coordinates:
        names = (*topology.chassis, *topology.moving)
        found.append({name: state.take(list(layout.vector(name))) for name in names})
    for name, carriers in topology.carried.items():
        weights = _weights(mechanism, name, carriers)
        edges = [_edges(points, carriers) for points in found]
        for points, part in zip(found, _carried(weights, edges), strict=True):
            points[name] = points[carriers[0]] + part
    return found


def _edges(points: Points, names: Sequence[str]) -> tuple[Enclosed, Enclosed]:
    base, first, second = (points[name] for name in names[:3])
    return first - base, second - base


def _carried(weights: Enclosed, edges: Sequence[tuple[Enclosed, Enclosed]]) -> list[Enclosed]:
    """p - p_0 and its derivatives."""
    a, b, c = (weights.take([i]) for i in range(3))
    return [a * e1 + b * e2 + c * crossed for (e1, e2), crossed in zip(edges, _normals(edges), strict=True)]


def _normals(edges: Sequence[tuple[Enclosed, Enclosed]]) -> list[Enclosed]:
    """e1 x e2 and its derivatives by Leibniz' rule."""
    (e1, e2), *rates = edges
    result = [cross(e1, e2)]
    if rates:
        (v1, v2), *more = rates
        result.append(cross(v1, e2) + cross(e1, v2))
    if rates and more:
        a1, a2 = more[0]
        result.append(cross(a1, e2) + cross(e1, a2) + cross(v1, v2).scaled(2.0))
    return result


def _weights(mechanism: Mechanism, name: str, carriers: tuple[str, str, str]) -> Enclosed:
    """The weights that give the drawn point exactly, (3,).

    What the computed ones leave of it is solved once more; |W| of what these then leave, W the inverse of
    the frame up to a defect below one half, is at most half of what they are off.
    """
    vectors = {point: Enclosed.of(mechanism.drawing.vectors[point]) for point in (*carriers, name)}
    edges = _edges(vectors, carriers)
    target = vectors[name] - vectors[carriers[0]]
    frame = np.stack([edges[0].middle, edges[1].middle, cross(*edges).middle], axis=-1)
    lengths = np.linalg.norm(frame, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.linalg.inv(frame / lengths) / lengths[:, None]
    sound = np.abs(np.eye(3) - (inverse * lengths[:, None]) @ (frame / lengths)).sum(axis=-1).max() < 0.5
    first = Enclosed.of(mechanism.carrier_weights[name])
    rest = target - _carried(first, [edges])[0]
    better = Enclosed.of(first.high, inverse @ rest.middle)
    rest = target - _carried(better, [edges])[0]
    left = np.abs(rest.middle) + rest.radius[0]
    scaled = np.abs(inverse * lengths[:, None]) @ left
    proven = 2.0 * scaled.max() / lengths if sound else np.full(3, np.inf)
    return Enclosed.of(better.high, better.low, proven, np.abs(inverse) @ rest.radius[1])


def body_rate_error(
    points: Points, rates: Points, names: Sequence[str], found: Array, pull: Enclosed | None
) -> Enclosed:
    """Exact rate of a body less the one that was found, (N, 3).

    Args:
        points, rates: positions and velocities, or accelerations, of the body's points.
        names: of the body's points; the first three are taken.
        found: the computed rate, (N, 3).
        pull: the exact angular velocity where `rates` are accelerations.
    """
    e1, e2 = _edges(points, names)
    turning = Enclosed.of(found)
    s1, s2 = (rate - cross(turning, edge) for rate, edge in zip(_edges(rates, names), (e1, e2), strict=True))
    if pull is not None:
        s1, s2 = (s - cross(pull, cross(pull, edge)) for s, edge in ((s1, e1), (s2, e2)))
    normal = cross(e1, e2)
    along = dot(s1, e2).spread_out * normal
    across = dot(s2, normal).spread_out * e1 - dot(s1, normal).spread_out * e2
    return quotient(along + across, dot(normal, normal).spread_out)


def angle_error(sine: Enclosed, cosine: Enclosed, found: Array) -> Array:
    """Proven and expected error of an angle atan2(sine, cosine) that was found, (2, N), rad; at most pi."""
    c, s = (
        Enclosed.of(part, 0.0, 2.0 * UNIT_ROUNDOFF, 2.0 * UNIT_ROUNDOFF)
        for part in (np.cos(found), np.sin(found))
    )
    off = sine * c - cosine * s
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        long = np.hypot(sine.middle, cosine.middle)
        reach = long - 2.0 * np.maximum(sine.radius[0], cosine.radius[0])
        proven = (np.abs(off.middle) + off.radius[0]) / np.where(reach > 0.0, reach, 0.0)
        expected = off.radius[1] / long + 4.0 * EPS
        # The arc of a sine below 1/2 is at most 1 + x^2 times as long as the sine.
        turn = np.stack([proven, expected])
        ahead = sine.middle * np.sin(found) + cosine.middle * np.cos(found) > 0.0
        return np.where((turn < 0.5) & np.stack([ahead, ahead | True]), turn * (1.0 + turn**2), np.pi)
