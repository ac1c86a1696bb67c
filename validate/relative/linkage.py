r"""A suspension as a tree of joints with loop closures, as data.

Every joint carries one body and is placed where it is in the reference pose, in which all bodies have the
axes of the car's frame and all joint coordinates are zero. Loops are cut at ball joints and at links with a
ball joint at either end; what is cut must meet again:

    coincide:   a - b - g = 0                            three rows
    distance:   (|a - b - g|^2 - L^2) / (2 L) = 0        one row
    drive:      d . (a - f) = value(input)               one row

with a and b points of bodies, f a fixed place and d a direction. The gap g is what the drawing leaves open:
with it the reference pose closes, and it is taken back to zero when the drawing is closed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Points = Mapping[str, Array]

CHASSIS = "chassis"
NO_GAP = np.zeros(3)


@dataclass(frozen=True)
class Joint:
    """A joint and the body that it carries, which has its name.

    Attributes:
        body: its name. parent: name of the body before it.
        kind: what it allows. A spherical one turns by a quaternion.
        at: where it is in the reference pose, (3,).
        axis: unit vector in the reference pose, (3,); zero for a spherical joint.
    """

    body: str
    parent: str
    kind: Literal["revolute", "prismatic", "spherical"]
    at: Array
    axis: Array


@dataclass(frozen=True)
class Place:
    """A point of a body.

    Attributes:
        body: its name. at: where the point is in the reference pose, (3,).
    """

    body: str
    at: Array


@dataclass(frozen=True)
class Coincide:
    """Two points that are one ball joint."""

    first: Place
    second: Place
    gap: Array


@dataclass(frozen=True)
class Distance:
    """Two points that a link holds at a distance."""

    first: Place
    second: Place
    length: float
    gap: Array


@dataclass(frozen=True)
class Drive:
    """A component of a point's place that an input gives.

    Attributes:
        place: the point. foot: from where it is measured, (3,). direction: along what, (3,).
        size: of the value; for an angle it is size cos(angle), for a travel size times the travel.
        drawn: value of the input as drawn, rad or in the unit of lengths.
    """

    input: str
    kind: Literal["angle", "travel"]
    place: Place
    foot: Array
    direction: Array
    size: float
    drawn: float


@dataclass(frozen=True)
class Side:
    """A sign that tells assemblies apart; as the drawing has it, and so it stays.

    It is ((b - a) x (c - a)) . (d - a), or (b - a) . (c - a) where d is None.

    Attributes:
        lock: what locks where it is zero, in words.
        points: a, b, c and d.
        drawn: in the drawing.
        size: of the vectors in the drawing, multiplied.
    """

    lock: str
    points: tuple[Place, Place, Place, Place | None]
    drawn: float
    size: float


@dataclass(frozen=True)
class Line:
    """A line through two points, of which angles are made.

    Attributes:
        start, end: its points.
        drawn: from one to the other, (3,), as drawn: exact where they lie near to each other.
    """

    start: Place
    end: Place
    drawn: Array

    @property
    def fixed(self) -> bool:
        """Whether one body carries both points, so that only its turn moves the direction."""
        return self.start.body == self.end.body


@dataclass(frozen=True)
class Linkage:
    """A suspension; lengths in a unit in which the car has the size one.

    Attributes:
        joints: parents before children.
        points: every point of the suspension that is reported.
        closures: coincidences and distances.
        drives: one for each input of the suspension.
        sides: that tell its assemblies apart.
        steering_axis, spin_axis: lines of the angles.
        bodies: names of the joints' bodies by the names of the bodies that are reported.
    """

    joints: tuple[Joint, ...]
    points: Mapping[str, Place]
    closures: tuple[Coincide | Distance, ...]
    drives: tuple[Drive, ...]
    sides: tuple[Side, ...]
    steering_axis: Line
    spin_axis: Line
    bodies: Mapping[str, str]


def triple(a: Array, b: Array, c: Array, d: Array) -> float:
    """((b - a) x (c - a)) . (d - a)."""
    return float(np.cross(b - a, c - a) @ (d - a))


def length(vector: Array) -> float:
    """Of a vector."""
    return float(np.linalg.norm(vector))
