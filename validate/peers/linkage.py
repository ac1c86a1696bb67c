r"""A mechanism as any multibody program takes it: bodies on joints, a tree, and ball joints that close it.

The tree is that of `spanning_tree.cut`. Programs have few closures and drives in common, so that all are
made of joints and of ball joints that close loops:

    a point on a line      a body that slides along it, and a ball joint with the point
    a rod                  a body on a ball joint at one end, whose spin is held, and one at the other end
    a driven distance      likewise, and the rod is a driven slide
    a driven height,       a body on three slides at right angles, of which the first is driven, and a ball
    angle or travel        joint with the point
    a driven hinge         itself

An angle is driven by the height that it stands for, size x cos(angle). A wheel's contact point is of no body,
and no program drives it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.peers.errors import PeerError
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


@dataclass(frozen=True)
class Loop:
    """A ball joint that closes the tree: a place of one body that a place of another one must meet."""

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
    """What is given to a program, in the linkage's unit.

    Attributes:
        driven: driven coordinates with two time derivatives, (N, 3, drives).
        chassis: motion of the chassis, None if it rests.
        laws: every input's value and two time derivatives, (N, 3), rad or mm per s^d.
    """

    driven: Array
    chassis: ChassisMotion | None
    laws: Mapping[str, Array]


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

    @property
    def drawn_inputs(self) -> Array:
        """Driven coordinates at the drawing, (drives,)."""
        drawn = [driven.coordinate(np.array([driven.drive.drawn, 0.0, 0.0]))[0] for driven in self.driven]
        return np.array(drawn)

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
            PeerError: an angle is outside 0 to pi.
        """
        found = []
        for driven in self.driven:
            drive, law = driven.drive, laws[driven.drive.input]
            near = law if drive.is_angle else law / self.unit
            outside = (law[:, 0] < 0.0) | (law[:, 0] > np.pi)
            if drive.kind == "angle" and outside.any():
                raise PeerError(f"{drive.input} is outside 0 to pi rad", int(np.argmax(outside)))
            found.append(driven.coordinate(near))
        return Inputs(np.stack(found, axis=-1), ChassisMotion.of(self.plain, laws), laws)


def linkage_of(plain: Mapping[str, Any]) -> Linkage:
    """The joints and loops of a flat mechanism.

    Raises:
        PeerError: it makes no mechanism, or no program can hold or drive it.
    """
    try:
        tree = cut(plain)
    except CutError as error:
        raise PeerError(str(error)) from error
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
                self.loops.append(Loop(closure.first, closure.second))
            elif isinstance(closure, OnLine):
                foot, axis = closure.second.at, closure.axis
                foot = foot + float((closure.first.at - foot) @ axis) * axis
                end = self._slide(name, Place(closure.second.body, foot), axis)
                self.loops.append(Loop(end, closure.first))
            elif isinstance(closure, Rod):
                self._rod(name, closure.first, closure.second, closure.length)
            elif isinstance(closure, Square):
                raise PeerError(
                    f"no program holds {closure.name}, a slide that may not turn and closes a loop"
                )
        for number, drive in enumerate(tree.drives):
            self._drive(f"drive {number} {drive.input}", drive)

    def _slide(self, name: str, place: Place, axis: Array) -> Place:
        self.joints.append(Joint(name, place.body, "slide", place.at, axis))
        return Place(name, place.at)

    def _rod(
        self, name: str, first: Place, second: Place, length: float, driven: Drive | None = None
    ) -> None:
        axis = second.at - first.at
        axis = axis / float(np.linalg.norm(axis))
        self.joints.append(Joint(name, first.body, "ball", first.at))
        self.rods[name] = axis
        end = Place(name, first.at + length * axis)
        if driven is not None:
            end = self._slide(f"{name} length", end, axis)
            self.driven.append(Driven(end.body, driven, 1.0, -length))
        self.loops.append(Loop(end, second))

    def _drive(self, name: str, drive: Drive) -> None:
        first, second = drive.first, drive.second
        if drive.kind == "contact":
            raise PeerError(f"no program drives {drive.input}, the height of a wheel's contact point")
        if drive.kind == "distance":
            self._rod(name, first, second, drive.drawn, drive)
            return
        if drive.kind == "turn":
            self.driven.append(Driven(drive.joint, drive, drive.size, 0.0))
            return
        if drive.kind == "angle" and second.body != drive.of:
            raise PeerError(f"no program drives {drive.input}, an angle about a point that moves")
        long = float(np.linalg.norm(drive.axis))
        axis, drawn = drive.axis / long, float((first.at - second.at) @ drive.axis)
        if drive.joint:
            self.driven.append(
                Driven(drive.joint, drive, drive.along * drive.size / long, -drive.along * drawn / long)
            )
            return
        end = Place(drive.of, first.at)
        for number, direction in enumerate((axis, *across(axis))):
            end = self._slide(f"{name} {number}", end, direction)
            if number == 0:
                self.driven.append(Driven(end.body, drive, drive.size / long, -drawn / long))
        self.loops.append(Loop(end, first))


def axes_along(axis: Array) -> Array:
    """Right-handed axes as columns, of which the third lies along a unit vector."""
    return np.stack([*across(axis), axis], axis=-1)
