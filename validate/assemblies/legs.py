"""What holds the knuckle of a mechanism at a pose: six conditions, as quadratic forms of its Study numbers.

A rod keeps its end at a distance from a fixed point. An arm on a hinge that turns freely keeps its ball joint
at two distances, and one whose angle is driven keeps it where it is. A slide that the knuckle carries keeps a
fixed point on a line of the knuckle. A driven height keeps a point on a plane. What hangs on these bodies,
such as a rocker, holds nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.assemblies.study import STUDY, at_distance, on_plane, on_plane_of_body
from validate.cars.car import direction

Array = NDArray[np.float64]

CHASSIS = "chassis"
CONDITIONS = 6


class NotOnLegsError(ValueError):
    """A mechanism whose knuckle is not held by six conditions that are known here."""


def forms(mechanism: Mapping[str, Any], places: Mapping[str, Array]) -> Array:
    """The quadratic forms that vanish at every assembly, (7, 8, 8), the largest entry of each 1.

    Args:
        mechanism: as plain data. places: of every point at one pose, mm; where the inputs are held.
    Raises:
        NotOnLegsError: the knuckle is held by something else.
    """
    knuckle = mechanism["roles"].get("knuckle")
    if knuckle is None:
        raise NotOnLegsError("the mechanism names no knuckle, whose role is not given")
    body = mechanism["bodies"][knuckle]
    # About the middle of the knuckle, in its size, numbers are of order one.
    middle = np.mean([places[name] for name in body], axis=0)
    size = max(float(np.abs(places[name] - middle).max()) for name in places)
    local = {name: (place - middle) / size for name, place in places.items()}
    found = [STUDY, *_conditions(mechanism, knuckle, local)]
    if len(found) != CONDITIONS + 1:
        raise NotOnLegsError(
            f"{len(found) - 1} conditions hold {knuckle}, and assemblies are counted of {CONDITIONS}: rods, "
            "arms on hinges, a slide and the inputs"
        )
    stacked = np.array(found)
    return np.asarray(stacked / np.abs(stacked).max(axis=(1, 2), keepdims=True))


def _conditions(mechanism: Mapping[str, Any], knuckle: str, at: Mapping[str, Array]) -> Iterator[Array]:
    bodies, slides, inputs = mechanism["bodies"], mechanism["slides"], mechanism["inputs"].values()
    body = set(bodies[knuckle])
    driven = {slide for one in inputs for slide in _listed(one.get("travel", ()))}
    still = {*bodies[CHASSIS]}
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
    for one, other in (*mechanism["rods"].values(), *(i["distance"] for i in inputs if "distance" in i)):
        for end, far in ((one, other), (other, one)):
            if end in body and far in still:
                yield at_distance(at[end], at[far])
    for slide in slides.values():
        if slide["body"] == knuckle:
            # The line goes through the fixed point as it stands at the pose.
            (fixed,) = still.intersection(slide["points"])
            along = at[fixed] - at[slide["through"]]
            for normal in np.linalg.svd(along[None])[2][1:]:
                yield on_plane_of_body(at[fixed], normal)
    for one in inputs:
        if one.get("height") in body:
            normal = direction(mechanism["up"], mechanism["right"], one["along"])
            yield on_plane(at[one["height"]], normal)


def _listed(names: Any) -> tuple[str, ...]:
    return (names,) if isinstance(names, str) else tuple(names)
