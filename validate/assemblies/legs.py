r"""The six conditions that hold the knuckle of a mechanism at a pose, as forms of its Study parameters.

A rod keeps its end at a distance from a fixed point. An arm on a free hinge keeps its ball joint at two
distances; if its angle is driven, the ball joint is fixed. A slide carried by the knuckle keeps a fixed point
on a line of the knuckle. A driven height keeps a point on a plane. Parts that hang on these bodies, such as a
rocker, add no condition.

A pose is a dual quaternion (e, g) with <e, g> = 0, up to a factor (Study 1891; M. Husty, *An algorithm for
solving the direct kinematics of general Stewart-Gough platforms*, Mechanism and Machine Theory 31, 1996).
With vectors as quaternions without a real part it turns x into e x e* / |e|^2 and then moves it by
2 g e* / |e|^2, so e = 1, g = 0 is the drawn pose. Each condition on a point of the body, times |e|^2, is a
quadratic form:

    x at the distance d of y
        (|x|^2 + |y|^2 - d^2) |e|^2 - 2 <y e, e x> + 4 <g, e x> - 4 <y e, g> + 4 |g|^2
    x on a plane, n . place = c
        <n e, e x> + 2 <n e, g> - c |e|^2
    y on a plane of the body, b . (y seen from it) = k
        <e b, y e> - 2 <e b, g> - k |e|^2

and <e, g> = 0 is one more. Solutions with <e, e> = 0 are not poses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.errors import NoAnswer
from validate.plain_text import counted_as
from validate.spanning_tree.tree import car_directions

CHASSIS = "chassis"
CONDITIONS = 6
UNIT, NONE = np.eye(4), np.zeros((4, 4))


def _product(vector: Array, order: int) -> Array:
    """The matrix of q -> v q for order 1, of q -> q v for order -1."""
    x, y, z = vector
    turn = order * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.block([[np.zeros(1), -vector], [vector[:, None], turn]])


def _form(turns: Array, both: Array, moves: Array = NONE) -> Array:
    """The symmetric matrix of e^T turns e + e^T both g + g^T moves g, (8, 8)."""
    return np.block([[(turns + turns.T) / 2, both / 2], [both.T / 2, moves]])


STUDY = _form(NONE, UNIT)
"""<e, g>."""


def forms(mechanism: Mapping[str, Any], places: Mapping[str, Array]) -> Array:
    """The quadratic forms that vanish at every assembly, (7, 8, 8), the largest entry of each 1.

    Args:
        mechanism: as plain data.
        places: position of every point at one pose, mm; the inputs are held there.
    Raises:
        NoAnswer: the knuckle is held by other conditions.
    """
    knuckle = mechanism["roles"].get("knuckle")
    if knuckle is None:
        raise NoAnswer("the mechanism", "names no knuckle, whose role is not given", "a knuckle in [roles]")
    # Relative to the middle of the knuckle and divided by the size, coordinates are of order one.
    middle = np.mean([places[name] for name in mechanism["bodies"][knuckle]], axis=0)
    size = max(float(np.abs(place - middle).max()) for place in places.values())
    local = {name: (place - middle) / size for name, place in places.items()}
    found = np.array([STUDY, *_conditions(mechanism, knuckle, local)])
    if len(found) != CONDITIONS + 1:
        raise NoAnswer(
            knuckle,
            f"is held by {counted_as(len(found) - 1, 'condition')}",
            f"a knuckle held by {CONDITIONS}: rods, arms on hinges, a slide and the inputs",
        )
    return np.asarray(found / np.abs(found).max(axis=(1, 2), keepdims=True))


def _conditions(mechanism: Mapping[str, Any], knuckle: str, at: Mapping[str, Array]) -> Iterator[Array]:
    bodies, slides, inputs = mechanism["bodies"], mechanism["slides"], mechanism["inputs"].values()
    body, still = set(bodies[knuckle]), set(bodies[CHASSIS])
    travels = [one["travel"] for one in inputs if "travel" in one]
    driven = {slide for one in travels for slide in ((one,) if isinstance(one, str) else one)}
    for name, slide in slides.items():
        if slide["body"] == CHASSIS and name in driven:
            still.update(slide["points"])
    for name, points in bodies.items():
        hinge = still.intersection(points)
        if name in (CHASSIS, knuckle) or len(hinge) != 2:
            continue
        held = any(one.get("angle") == name for one in inputs)
        for point in body.intersection(points):
            if held:
                yield from (on_plane(at[point], axis) for axis in np.eye(3))
            else:
                yield from (at_distance(at[point], at[end]) for end in sorted(hinge))
    for ends in (*mechanism["rods"].values(), *(one["distance"] for one in inputs if "distance" in one)):
        for end, far in (ends, ends[::-1]):
            if end in body and far in still:
                yield at_distance(at[end], at[far])
    for slide in slides.values():
        if slide["body"] == knuckle:
            # At the pose the line passes through the fixed point.
            (fixed,) = still.intersection(slide["points"])
            along = at[fixed] - at[slide["through"]]
            for normal in np.linalg.svd(along[None])[2][1:]:
                yield on_plane_of_body(at[fixed], normal)
    for one in inputs:
        if one.get("height") in body:
            yield on_plane(at[one["height"]], car_directions(mechanism)[one["along"]])


def at_distance(point: Array, fixed: Array) -> Array:
    """A point of the body keeps its distance from a fixed one."""
    x, y = _product(point, -1), _product(fixed, 1)
    away = point - fixed
    return _form((point @ point + fixed @ fixed - away @ away) * UNIT - 2 * y.T @ x, 4 * (x - y).T, 4 * UNIT)


def on_plane(point: Array, normal: Array) -> Array:
    """A point of the body stays on the plane through it with a fixed normal."""
    n = _product(normal, 1)
    return _form(n.T @ _product(point, -1) - (normal @ point) * UNIT, 2 * n.T)


def on_plane_of_body(fixed: Array, normal: Array) -> Array:
    """A fixed point stays on a plane that moves with the body, through the point at the pose."""
    b = _product(normal, -1)
    return _form(b.T @ _product(fixed, 1) - (normal @ fixed) * UNIT, -2 * b.T)
