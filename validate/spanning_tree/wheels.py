"""Angles of wheels and steering axes: each that of a line projected on two directions of the car.

    angle = atan2(line . sine, line . cosine)

With n from the inner point of the wheel's axis to the wheel centre, k from the lower to the upper point of
the steering axis, u up, o outboard, f forward and r = -f: camber (n . -u, n . o), kingpin (k . -o, k . u),
toe (n . f, n . o), caster (k . r, k . u).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.spanning_tree.cut import car_directions

Array = NDArray[np.float64]

ANGLES = {
    "camber": ("wheel_axis", "down", "outboard"),
    "kingpin": ("steering_axis", "inboard", "up"),
    "toe": ("wheel_axis", "forward", "outboard"),
    "caster": ("steering_axis", "rearward", "up"),
}


@dataclass(frozen=True)
class Angle:
    """One angle of a wheel.

    Attributes:
        start, end: points of its line. sine, cosine: directions, (3,).
    """

    start: str
    end: str
    sine: Array
    cosine: Array

    def of(self, line: Array) -> Array:
        """The angle of the line, (N,), rad, from its vector, (N, 3)."""
        return np.arctan2(line @ self.sine, line @ self.cosine)


def wheel_angles(plain: Mapping[str, Any]) -> dict[str, Angle]:
    """The angles that a flat mechanism's roles give, by name; of a part with its prefix."""
    directions, found = car_directions(plain), {}
    for role, points in plain["roles"].items():
        prefix, dot, last = role.rpartition(".")
        for name, (axis, sine, cosine) in ANGLES.items():
            if last == axis:
                outboard = _outboard(plain, prefix + dot, directions)
                named = {**directions, "outboard": outboard, "inboard": -outboard}
                start, end = points
                found[prefix + dot + name] = Angle(start, end, named[sine], named[cosine])
    return found


def knuckles(plain: Mapping[str, Any]) -> dict[str, str]:
    """Bodies that carry a wheel, each by its own name."""
    return {body: body for role, body in plain["roles"].items() if role.rpartition(".")[2] == "knuckle"}


def _outboard(plain: Mapping[str, Any], prefix: str, directions: Mapping[str, Array]) -> Array:
    """Outboard of a part: from its inboard point to the wheel centre; without such points the car's side."""
    right, roles = directions["right"], plain["roles"]
    inboard, wheel = roles.get(f"{prefix}inboard"), roles.get(f"{prefix}wheel_axis", ("", ""))[1]
    if inboard and wheel:
        points = plain["points"]
        on_the_right = (np.array(points[wheel]) - np.array(points[inboard])) @ right > 0.0
    else:
        on_the_right = plain["side"] == "right"
    return right if on_the_right else -right
