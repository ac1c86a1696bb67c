r"""A mechanism as any multibody program takes it: bodies on joints, a tree, and ball joints that close it.

The tree is that of `spanning_tree.cut`. Programs have few closures and drives in common, so that all are
made of joints and of ball joints that close loops:

    a point on a line      a body that slides along it, and a ball joint with the point
    a rod                  a body on a ball joint at one end, whose spin is held, and one at the other end
    a driven distance      likewise, and the rod is a driven slide
    a driven height,       a body on three slides at right angles, of which the first is driven, and a ball
    angle or travel        joint with the point; if it counts from a point that moves, on three slides more
    a driven hinge         itself
    directions at right    two points along the first one, as far along the second one: bodies on two slides
    angles                 each, which stand on one slide
    a wheel's contact      a body on a hinge about the wheel's axis, one radius down of which is driven; a
    point                  line across it stays level, likewise

An angle is driven by the height that it stands for, size x cos(angle).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.peers.errors import HardpointsError, InputError
from validate.spanning_tree.chassis import ChassisMotion
from validate.spanning_tree.cut import (
    CHASSIS,
    Coincide,
    CutError,
    Drive,
    Joint,
    OnLine,
    Place,
    Rod,
    SpanningTree,
    Square,
    across,
    cut,
)
from validate.spanning_tree.wheels import Wheels, knuckles

Array = NDArray[np.float64]

UNIT_ROUNDOFF = 0.5 * float(np.finfo(float).eps)
CHAIN = 6.0  # roundings on the way from the chassis to a point
# What an input may be: an angle is told by its cosine, and rods of no length have no direction.
BETWEEN = {
    "angle": (0.0, np.pi, "an angle from 0 to pi"),
    "distance": (np.nextafter(0.0, 1.0), np.inf, "a distance above 0"),
}


@dataclass(frozen=True)
class Loop:
    """A ball joint that closes the tree: a place of one body that a place of another one must meet.

    Attributes:
        name: of the point, rod, slide or input that it stands for.
    """

    name: str
    first: Place
    second: Place


@dataclass(frozen=True)
class Driven:
    """A joint that is driven: its coordinate is scale x f(input) + start.

    Attributes:
        body: that the joint carries. drive: which input, and f: see `cut.Drive`.
    """

    body: str
    drive: Drive
    scale: float
    start: float

    def coordinate(self, law: Array) -> Array:
        """The coordinate with two time derivatives, from the input's, (..., 3)."""
        value, rate, bend = np.moveaxis(law, -1, 0)
        if self.drive.kind == "angle":
            sine, cosine = np.sin(value), np.cos(value)
            value, rate, bend = cosine, -sine * rate, -cosine * rate * rate - sine * bend
        found = np.stack([value, rate, bend], axis=-1) * self.scale
        found[..., 0] += self.start
        return found


@dataclass(frozen=True)
class Inputs:
    """What is given to a program.

    Attributes:
        series: of each drive its input with two time derivatives, (N, drives, 3), rad and the linkage's unit.
        laws: of every input, (N, 3), rad or mm per s^d. plain: the flat mechanism.
    """

    series: Array
    laws: Mapping[str, Array]
    plain: Mapping[str, Any]

    @property
    def values(self) -> Array:
        """(N, drives)."""
        return self.series[..., 0]

    @property
    def chassis(self) -> ChassisMotion | None:
        """Motion of the chassis, None if it rests."""
        return ChassisMotion.of(self.plain, self.laws)

    def first(self, count: int) -> Inputs:
        """At the first instants."""
        laws = {name: law[:count] for name, law in self.laws.items()}
        return replace(self, series=self.series[:count], laws=laws)


@dataclass(frozen=True)
class Linkage:
    """A mechanism for a program.

    Attributes:
        plain: the flat mechanism. tree: of it.
        joints: of the tree and of what closes and drives it, parents first.
        rods: bodies on a ball joint whose spin about the axis changes nothing.
        points: every moving point, as a place of a body.
        bodies: those whose turn is reported, by the name that it is reported by.
        wheels: what numbers of the wheels are made of.
    """

    plain: Mapping[str, Any]
    tree: SpanningTree
    joints: tuple[Joint, ...]
    rods: Mapping[str, Array]
    loops: tuple[Loop, ...]
    driven: tuple[Driven, ...]
    points: Mapping[str, Place]
    bodies: Mapping[str, str]
    wheels: Wheels

    @property
    def unit(self) -> float:
        """mm."""
        return self.tree.unit

    @cached_property
    def frames(self) -> Mapping[str, tuple[Array, Array]]:
        """Where each body's frame is drawn, and its axes as columns: those of a rod have it as the third."""
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
        """Inputs at the drawing, (drives,), rad and the unit."""
        return np.array([driven.drive.drawn for driven in self.driven])

    def coordinates(self, series: Array) -> Array:
        """Driven coordinates with two time derivatives, from the drives' inputs, (..., drives, 3) each."""
        found = [driven.coordinate(series[..., k, :]) for k, driven in enumerate(self.driven)]
        return np.stack(found, axis=-2)

    def moved(self, places: Mapping[str, Array]) -> dict[str, float]:
        """By how much each moving point lies off its place in the drawing, mm."""
        drawn = self.tree.drawn
        return {n: self.unit * float(np.linalg.norm(place - drawn[n])) for n, place in places.items()}

    def accuracy(self, last_step: Array) -> Array:
        """How exactly a program places points after such a last correction, mm.

        A place at the end of a chain of joints is rounded as its coordinates from the linkage's origin are,
        once for each joint; Newton's method leaves the square of its last correction.
        """
        far = max(1.0, *(float(np.abs(place).max()) for place in self.tree.drawn.values()))
        return np.asarray((CHAIN * UNIT_ROUNDOFF * far + last_step**2) * self.unit)

    def inputs(self, laws: Mapping[str, Array]) -> Inputs:
        """What is given to a program.

        Args:
            laws: every input's value and two time derivatives, (N, 3), rad or mm per s^d.
        Raises:
            InputError: an input is missing, is no number, or is outside of what it can be.
        """
        for name, law in laws.items():
            _require(name, law, np.asarray(np.isfinite(law).all(axis=1)), "finite numbers and rates")
        found = []
        for drive in (driven.drive for driven in self.driven):
            if drive.input not in laws:
                raise InputError(drive.input, "missing", "; ".join(d.drive.input for d in self.driven))
            law = laws[drive.input]
            if drive.kind in BETWEEN:
                least, most, words = BETWEEN[drive.kind]
                value = law[:, 0]
                _require(drive.input, law, np.asarray((value >= least) & (value <= most)), words)
            found.append(law if drive.is_angle else law / self.unit)
        return Inputs(np.stack(found, axis=1), laws, self.plain)


def _require(name: str, law: Array, right: NDArray[np.bool_], allowed: str) -> None:
    if not right.all():
        wrong = int(np.argmin(right))
        bad = law[wrong][~np.isfinite(law[wrong])]
        raise InputError(name, float(bad[0] if bad.size else law[wrong, 0]), allowed, wrong)


def linkage_of(plain: Mapping[str, Any]) -> Linkage:
    """The joints and loops of a flat mechanism.

    Raises:
        HardpointsError: it makes no mechanism.
    """
    try:
        tree = cut(plain)
    except CutError as error:
        raise HardpointsError(error.name, error.problem, error.allowed) from error
    made = _Made(tree)
    return Linkage(
        plain=plain,
        tree=tree,
        joints=tuple(made.joints),
        rods=made.rods,
        loops=tuple(made.loops),
        driven=tuple(made.driven),
        points={name: place for name, place in tree.points.items() if place.body != CHASSIS},
        bodies=knuckles(plain),
        wheels=Wheels.of(plain, tree),
    )


class _Made:
    """Joints and loops of a tree while they are made."""

    def __init__(self, tree: SpanningTree) -> None:
        self.joints = list(tree.joints)
        self.rods: dict[str, Array] = {}
        self.loops: list[Loop] = []
        self.driven: list[Driven] = []
        for number, closure in enumerate(tree.closures):
            name = f"closure {number} {closure.name}"
            if isinstance(closure, Coincide):
                self._loop(closure.name, closure.first, closure.second)
            elif isinstance(closure, OnLine):
                foot, axis = closure.second.at, closure.axis
                foot = foot + float((closure.first.at - foot) @ axis) * axis
                end = self._slide(name, Place(closure.second.body, foot), axis)
                self._loop(closure.name, end, closure.first)
            elif isinstance(closure, Rod):
                self._rod(name, closure.name, closure.first, closure.second, closure.length)
            elif isinstance(closure, Square):
                # Of any two points of the body: its frame's origin, and one along the direction.
                body, along = closure.first.body, closure.first.at
                start = next(joint.at for joint in self.joints if joint.body == body)
                ends = Place(body, start), Place(body, start + along)
                self._level(name, closure.name, closure.second.body, closure.second.at, *ends)
        for number, drive in enumerate(tree.drives):
            self._drive(f"drive {number} {drive.input}", drive)

    def _loop(self, name: str, first: Place, second: Place) -> None:
        self.loops.append(Loop(name, first, second))

    def _slide(self, name: str, place: Place, axis: Array) -> Place:
        self.joints.append(Joint(name, place.body, "slide", place.at, axis))
        return Place(name, place.at)

    def _slides(self, name: str, place: Place, axes: tuple[Array, ...]) -> Place:
        for number, axis in enumerate(axes):
            place = self._slide(f"{name} {number}", place, axis)
        return place

    def _level(self, name: str, of: str, body: str, axis: Array, first: Place, second: Place) -> None:
        """Two places that stay equally far along an axis of a body."""
        start = self._slide(name, Place(body, first.at), axis)
        for label, place in (("first", first), ("second", second)):
            level = place.at - float((place.at - first.at) @ axis) * axis
            end = self._slides(f"{name} {label}", Place(start.body, level), across(axis))
            self._loop(of, end, place)

    def _rod(
        self, name: str, of: str, first: Place, second: Place, length: float, driven: Drive | None = None
    ) -> None:
        axis = second.at - first.at
        axis = axis / float(np.linalg.norm(axis))
        self.joints.append(Joint(name, first.body, "ball", first.at))
        self.rods[name] = axis
        end = Place(name, first.at + length * axis)
        if driven is not None:
            end = self._slide(f"{name} length", end, axis)
            self.driven.append(Driven(end.body, driven, 1.0, -length))
        self._loop(of, end, second)

    def _drive(self, name: str, drive: Drive) -> None:
        first, second = drive.first, drive.second
        if drive.kind == "distance":
            self._rod(name, drive.input, first, second, drive.drawn, drive)
            return
        if drive.kind == "turn":
            self.driven.append(Driven(drive.joint, drive, drive.size, 0.0))
            return
        if drive.kind == "contact":
            first = self._contact(name, drive)
            second = Place(drive.of, first.at)
        long = float(np.linalg.norm(drive.axis))
        axis, drawn = drive.axis / long, float((first.at - second.at) @ drive.axis)
        size = 1.0 if drive.kind == "contact" else drive.size
        if drive.joint:
            scale = drive.along / long
            self.driven.append(Driven(drive.joint, drive, scale * drive.size, -scale * drawn))
            return
        base = Place(drive.of, first.at)
        if second.body != drive.of:
            # A body that goes along with the second point, and turns as the body `of` does.
            carried = self._slides(f"{name} from", Place(drive.of, second.at), (axis, *across(axis)))
            self._loop(drive.input, carried, second)
            base = Place(carried.body, first.at)
        end = self._slide(name, base, axis)
        self.driven.append(Driven(end.body, drive, size / long, -drawn / long))
        self._loop(drive.input, self._slides(f"{name} beside", end, across(axis)), first)

    def _contact(self, name: str, drive: Drive) -> Place:
        """The lowest point of a wheel, as a place of a body that turns about the wheel's axis."""
        centre, up = drive.first, drive.axis
        down = float(up @ drive.axle) * drive.axle - up
        down = down / float(np.linalg.norm(down))
        rim = f"{name} rim"
        self.joints.append(Joint(rim, centre.body, "hinge", centre.at, drive.axle))
        tip = Place(rim, centre.at + np.cross(drive.axle, down))
        self._level(f"{name} level", drive.input, drive.of, up, Place(rim, centre.at), tip)
        return Place(rim, centre.at + drive.size * down)


def axes_along(axis: Array) -> Array:
    """Right-handed axes as columns, of which the third lies along a unit vector."""
    return np.stack([*across(axis), axis], axis=-1)
