"""A mechanism as a tree of joints with loop closures, with its inputs, for any multibody program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np

from validate.arrays import Array, Flags
from validate.errors import NoAnswer

CHASSIS = "chassis"
Kind = Literal["hinge", "ball", "slide"]
UNIT_ROUNDOFF = 0.5 * float(np.finfo(float).eps)
CHAIN = 6.0  # roundings on the way from the chassis to a point
# Range of an input: an angle is found from its cosine, and a rod of zero length has no direction.
BETWEEN = {
    "angle": (0.0, np.pi, "an angle from 0 to pi"),
    "distance": (np.nextafter(0.0, 1.0), np.inf, "a distance above 0"),
}


@dataclass(frozen=True)
class Place:
    """A point of a body, at `at` in the reference pose, (3,)."""

    body: str
    at: Array


@dataclass(frozen=True)
class Joint:
    """A joint and the body that it carries, which has its name.

    Attributes:
        at: its place in the reference pose, (3,).
        axis: unit vector, (3,); zero for a ball joint.
    """

    body: str
    parent: str
    kind: Kind
    at: Array
    axis: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Loop:
    """A ball joint that closes the tree: places of two bodies that must coincide.

    Attributes:
        name: name of the point, rod, slide or input that it represents.
    """

    name: str
    first: Place
    second: Place


@dataclass(frozen=True)
class Driven:
    """A driven joint. Its coordinate is scale x f(input) + start; f is the cosine for an `angle`.

    Attributes:
        drawn: the input as drawn, rad or in the tree's unit.
        body: the body that the joint carries.
        per_input: for a length, mm per unit of the user's input; not 1 for the turn of a steering wheel.
    """

    input: str
    kind: Literal["turn", "angle", "distance", "length"]
    drawn: float
    body: str
    scale: float
    start: float
    per_input: float = 1.0

    @property
    def is_angle(self) -> bool:
        """Whether the input is in rad."""
        return self.kind in ("turn", "angle")

    def coordinate(self, law: Array) -> Array:
        """The coordinate with two time derivatives, from those of the input, (..., 3)."""
        value, rate, bend = np.moveaxis(law, -1, 0)
        if self.kind == "angle":
            sine, cosine = np.sin(value), np.cos(value)
            value, rate, bend = cosine, -sine * rate, -cosine * rate * rate - sine * bend
        found = np.stack([value, rate, bend], axis=-1) * self.scale
        found[..., 0] += self.start
        return found


@dataclass(frozen=True)
class SpanningTree:
    """A mechanism as a tree with closures.

    Attributes:
        plain: the flat mechanism.
        joints: joints of the tree, of its closures and of its drives, parents first; also those of auxiliary
            bodies without points, between two joints.
        rods: axis of each body on a ball joint whose spin about this axis has no effect.
        points: every point, as a place of that of its bodies that is nearest to the chassis.
        drawn: every point as drawn, (3,).
        origin, unit: mm.
    """

    plain: Mapping[str, Any]
    joints: tuple[Joint, ...]
    rods: Mapping[str, Array]
    loops: tuple[Loop, ...]
    driven: tuple[Driven, ...]
    points: Mapping[str, Place]
    drawn: Mapping[str, Array]
    origin: Array
    unit: float

    @cached_property
    def moving(self) -> dict[str, Place]:
        """The points that are not of the chassis."""
        return {name: place for name, place in self.points.items() if place.body != CHASSIS}

    @property
    def knuckles(self) -> tuple[str, ...]:
        """The bodies that carry a wheel, whose rotation is reported."""
        roles = self.plain["roles"]
        return tuple(dict.fromkeys(roles[role] for role in roles if role.rpartition(".")[2] == "knuckle"))

    @cached_property
    def sites(self) -> tuple[Place, ...]:
        """The moving points, the first and the second sides of all loops, and the origins of the knuckles."""
        first, second = ([getattr(loop, side) for loop in self.loops] for side in ("first", "second"))
        bodies = (Place(body, self.frames[body][0]) for body in self.knuckles)
        return (*self.moving.values(), *first, *second, *bodies)

    @cached_property
    def frames(self) -> Mapping[str, tuple[Array, Array]]:
        """Origin of each body's frame as drawn, and its axes as columns; a rod's third axis is the rod."""
        found = {CHASSIS: (np.zeros(3), np.eye(3))}
        for joint in self.joints:
            rod = self.rods.get(joint.body)
            found[joint.body] = joint.at, found[joint.parent][1] if rod is None else axes_along(rod)
        return found

    def local(self, place: Place) -> Array:
        """A place in its body's frame, (3,)."""
        start, axes = self.frames[place.body]
        return np.asarray(axes.T @ (place.at - start))

    @property
    def drawn_inputs(self) -> Array:
        """Inputs of the drives as drawn, (drives,), rad and the unit."""
        return np.array([driven.drawn for driven in self.driven])

    def named(self, values: Array) -> dict[str, float]:
        """Inputs in rad and mm by name, from the inputs of the drives, (drives,)."""
        return {
            driven.input: float(value) * (1.0 if driven.is_angle else self.unit / driven.per_input)
            for driven, value in zip(self.driven, values, strict=True)
        }

    def coordinates(self, series: Array) -> Array:
        """Driven coordinates with two time derivatives, from the drives' inputs, (..., drives, 3) each."""
        found = [driven.coordinate(series[..., k, :]) for k, driven in enumerate(self.driven)]
        return np.stack(found, axis=-2)

    def series(self, laws: Mapping[str, Array]) -> Array:
        """The input of each drive with two time derivatives, (N, drives, 3), rad and the unit.

        Args:
            laws: value and two time derivatives of every input, (N, 3), rad or mm per s^d.
        Raises:
            NoAnswer: an input is missing, is not a number, or is outside its range.
        """
        for name, law in laws.items():
            _require(name, law, np.asarray(np.isfinite(law).all(axis=1)), "finite numbers and rates")
        found = []
        for driven in self.driven:
            if driven.input not in laws:
                raise _refused(driven.input, "missing", "; ".join(one.input for one in self.driven))
            law = laws[driven.input]
            if driven.kind in BETWEEN:
                least, most, words = BETWEEN[driven.kind]
                value = law[:, 0]
                _require(driven.input, law, np.asarray((value >= least) & (value <= most)), words)
            found.append(law if driven.is_angle else law * (driven.per_input / self.unit))
        return np.stack(found, axis=1)

    def moved(self, places: Array) -> dict[str, float]:
        """Distance of the moving points, (points, 3), from their drawn places, mm, by name."""
        pairs = zip(self.moving, places, strict=True)
        return {name: self.unit * float(np.linalg.norm(at - self.drawn[name])) for name, at in pairs}

    def accuracy(self, last_step: Array) -> Array:
        """Accuracy of a program's points after such a last correction of Newton's method, mm.

        Each joint of the chain from the chassis to a point adds one rounding of the point's coordinates from
        the tree's origin; Newton's method leaves the square of its last correction.
        """
        far = max(1.0, *(float(np.abs(place).max()) for place in self.drawn.values()))
        return np.asarray((CHAIN * UNIT_ROUNDOFF * far + last_step**2) * self.unit)


def _require(name: str, law: Array, right: Flags, allowed: str) -> None:
    if not right.all():
        wrong = int(np.argmin(right))
        bad = law[wrong][~np.isfinite(law[wrong])]
        raise _refused(name, float(bad[0] if bad.size else law[wrong, 0]), allowed, wrong)


def _refused(name: str, value: float | str, allowed: str, instant: int | None = None) -> NoAnswer:
    where = "" if instant is None else f" at instant number {instant}"
    return NoAnswer(f"input {name!r}", f"is {value}{where}", allowed, name=name, value=value, instant=instant)


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors perpendicular to a unit vector and to each other."""
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, other)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def axes_along(axis: Array) -> Array:
    """Right-handed axes as columns; the third is the given unit vector."""
    return np.stack([*across(axis), axis], axis=-1)


def car_directions(plain: Mapping[str, Any]) -> dict[str, Array]:
    """Directions of the car by name, (3,)."""
    up, right = np.array(plain["up"], dtype=float), np.array(plain["right"], dtype=float)
    forward = np.cross(up, right)
    opposite = {"down": -up, "left": -right, "rearward": -forward}
    return {"up": up, "right": right, "forward": forward, **opposite}
