r"""Where every point of a pose and its rates exactly are, from where the coordinates and their rates are.

A carried point is p = p_0 + a e1 + b e2 + c e1 x e2 with weights that are known to twice the working
precision.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.car_axes import CarAxes
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.enclosure import Enclosed, cross

Array = NDArray[np.float64]
Points = Mapping[str, Enclosed]
Edges = tuple[Enclosed, Enclosed]


@dataclass(frozen=True)
class EnclosedPoses:
    """Where the points of solved poses exactly are: what the error of every reported number is told from.

    Time is in a unit of its own for each pose, so that no rate overflows.

    Attributes:
        points: by time derivative, every point in the chassis' frame, (N, 3), in the mechanism's units.
        added: by time derivative, what reporting a point adds to it, (N, 3), mm and s.
        powers: of the unit of time, s^d for d = 0, 1, 2, each (N,).
    """

    mechanism: Mechanism
    axes: CarAxes
    points: Sequence[Points]
    added: Sequence[Enclosed]
    powers: Sequence[Array]


class Coordinates(Protocol):
    """Where the coordinates of poses exactly are, or a derivative of them."""

    def take(self, places: list[int], /) -> Enclosed:
        """Those at some places, as the last dimension."""
        ...


def enclosed_points(mechanism: Mechanism, coordinates: Sequence[Coordinates]) -> list[dict[str, Enclosed]]:
    """Every point and as many of its derivatives as there are, each (N, 3), in units per s^d."""
    topology, layout = mechanism.topology, mechanism.layout
    found: list[dict[str, Enclosed]] = []
    for state in coordinates:
        names = (*topology.chassis, *topology.moving)
        found.append({name: state.take(list(layout.vector(name))) for name in names})
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
    (e1, e2), *rates = edges
    result = [cross(e1, e2)]
    if rates:
        (v1, v2), *more = rates
        result.append(cross(v1, e2) + cross(e1, v2))
    if rates and more:
        a1, a2 = more[0]
        result.append(cross(a1, e2) + cross(e1, a2) + cross(v1, v2).scaled(2.0))
    return result


def exact_weights(mechanism: Mechanism, name: str) -> Enclosed:
    """The weights that give the drawn point exactly, (3,).

    What the computed ones leave of it is solved once more; |W| of what these then leave, W the inverse of
    the frame up to a defect below one half, is at most half of what they are off.
    """
    carriers = mechanism.topology.carried[name]
    vectors = {point: Enclosed.of(mechanism.drawing.vectors[point]) for point in (*carriers, name)}
    edges = edges_of(vectors, carriers)
    normals = [cross(*edges)]
    target = vectors[name] - vectors[carriers[0]]
    frame = np.stack([edges[0].middle, edges[1].middle, normals[0].middle], axis=-1)
    lengths = np.linalg.norm(frame, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = np.linalg.inv(frame / lengths) / lengths[:, None]
    sound = np.abs(np.eye(3) - (inverse * lengths[:, None]) @ (frame / lengths)).sum(axis=-1).max() < 0.5
    first = Enclosed.of(mechanism.carrier_weights[name])
    rest = target - _carried(first, [edges], normals)[0]
    better = Enclosed.of(first.high, inverse @ rest.middle)
    rest = target - _carried(better, [edges], normals)[0]
    left = np.abs(rest.middle) + rest.radius[0]
    scaled = np.abs(inverse * lengths[:, None]) @ left
    proven = 2.0 * scaled.max() / lengths if sound else np.full(3, np.inf)
    return Enclosed.of(better.high, better.low, proven, np.abs(inverse) @ rest.radius[1])
