r"""A mechanism, cut into a tree of joints with loop closures.

Every body hangs on one joint, on another body or on the chassis. Joints with few coordinates are taken
first, those at the chassis before others: hinges, sliding joints, then ball joints. What is not taken is a
closure, and so is every rod. A body that only rods or lines hold hangs on the chassis by six coordinates,
and a point of no body is a body of its own, which slides along its line or moves freely.

In the reference pose all joint coordinates are zero, and every body is where it is drawn with the axes of
the car's frame. Only a point of no body that is drawn off its line starts on the line. Lengths are counted
from `origin` in `unit`, in which the car has a size between one and two.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CHASSIS = "chassis"
NO_AXIS = np.zeros(3)
TINIEST = 1e-250  # mm: the square of a smaller car is no normal number
# Of the car: points that miss a line by this many roundings are drawn on it.
ON_LINE = 16.0 * float(np.finfo(float).eps)
COORDINATES = {"hinge": 1, "slide": 1, "ball": 3}


class CutError(Exception):
    """A mechanism that cannot be cut into a tree.

    Attributes:
        name: of the point, rod or input at fault. problem, allowed: in words.
    """

    def __init__(self, name: str, problem: str, allowed: str) -> None:
        self.name, self.problem, self.allowed = name, problem, allowed
        super().__init__(f"{name} {problem}; allowed: {allowed}")


@dataclass(frozen=True)
class Place:
    """A point of a body, or a direction that is fixed in it.

    Attributes:
        body: its name. at: where it is in the reference pose, (3,).
    """

    body: str
    at: Array


@dataclass(frozen=True)
class Joint:
    """A joint and the body that it carries, which has its name.

    Attributes:
        at: where it is in the reference pose, (3,). axis: unit vector, (3,); zero for a ball joint.
    """

    body: str
    parent: str
    kind: Literal["hinge", "ball", "slide"]
    at: Array
    axis: Array = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True)
class Coincide:
    """Two points that are one ball joint: a - b = 0."""

    name: str
    first: Place
    second: Place


@dataclass(frozen=True)
class OnLine:
    """A point on a line of the second one's body: u . (a - b) = 0 for both u across the line.

    Attributes:
        axis: unit vector along the line, (3,).
    """

    name: str
    first: Place
    second: Place
    axis: Array


@dataclass(frozen=True)
class Square:
    """Directions of two bodies that stay at right angles: u . v = 0."""

    name: str
    first: Place
    second: Place


@dataclass(frozen=True)
class Rod:
    """Two points at a distance: |a - b| = length."""

    name: str
    first: Place
    second: Place
    length: float


Closure = Coincide | OnLine | Square | Rod


@dataclass(frozen=True)
class Drive:
    """What an input gives; lengths in the tree's unit.

        turn      size x the coordinate of `joint`                       = value
        angle     axis . (first - second)                                = size x cos(value)
        travel    axis . (first - second)                                = size x value
        height    likewise, of size 1
        contact   axis . (first - second) + size - size x sqrt(1 - s^2)  = value, and s = axis . axle
        distance  |first - second|                                       = value

    Attributes:
        axis: (3,), fixed in the body `of`. axle: unit vector along a wheel's axis, (3,), fixed in the first
            one's body.
        size: see above; of a contact the wheel's radius.
        drawn: value of the input in the drawing, rad or in the unit.
        joint: name of the body whose one coordinate is driven; empty if it is none. Of a travel the
            coordinate counts from the reference pose, along `along` (1 or -1) times the line.
    """

    input: str
    kind: Literal["turn", "angle", "travel", "height", "contact", "distance"]
    first: Place
    second: Place
    axis: Array
    of: str
    size: float
    drawn: float
    joint: str = ""
    along: float = 1.0
    axle: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def is_angle(self) -> bool:
        """Whether its value is in rad."""
        return self.kind in ("turn", "angle")


@dataclass(frozen=True)
class SpanningTree:
    """A mechanism as a tree with closures.

    Attributes:
        joints: parents before children; also of bodies between two joints, which no point is of.
        points: every point, as a place of the body that is nearest to the chassis.
        drawn: every point as drawn, (3,).
        origin, unit: mm.
    """

    joints: tuple[Joint, ...]
    points: Mapping[str, Place]
    closures: tuple[Closure, ...]
    drives: tuple[Drive, ...]
    drawn: Mapping[str, Array]
    origin: Array
    unit: float

    def told(self, values: Array) -> dict[str, float]:
        """Inputs in rad and mm by name, from one value for each drive."""
        return {
            drive.input: float(value) * (1.0 if drive.is_angle else self.unit)
            for drive, value in zip(self.drives, values, strict=True)
        }


@dataclass(frozen=True)
class _Edge:
    """A possible joint of the tree."""

    bodies: tuple[str, str]
    joint: Literal["hinge", "ball", "sliding", "sliding and turning"]
    points: tuple[str, ...]
    axis: Array
    slide: str = ""

    @property
    def coordinates(self) -> int:
        return {"hinge": 1, "sliding": 1, "sliding and turning": 2, "ball": 3}[self.joint]


class _Groups:
    """Sets that grow together (union-find)."""

    def __init__(self) -> None:
        self._above: dict[Any, Any] = {}

    def of(self, member: Any) -> Any:
        while member in self._above:
            member = self._above[member]
        return member

    def join(self, one: Any, other: Any) -> bool:
        """Whether they were apart."""
        one, other = self.of(one), self.of(other)
        if one != other:
            self._above[one] = other
        return bool(one != other)


def unit_vector(vector: Array, start: str, end: str) -> Array:
    """Unit vector from one point to another.

    Raises:
        CutError: they are at one place.
    """
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        raise CutError(start, f"is where {end} is, so that their line has no direction", "points apart")
    return np.asarray(vector / size)


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to a unit vector and to each other."""
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, other)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def cut(plain: Mapping[str, Any]) -> SpanningTree:
    """The tree of a flat mechanism.

    Raises:
        CutError: points that must be apart are at one place or on one line, or the car has no size.
    """
    return _Cutter(plain).tree()


class _Cutter:
    """A flat mechanism while it is cut."""

    def __init__(self, plain: Mapping[str, Any]) -> None:
        located = {name: np.array(place, dtype=float) for name, place in plain["points"].items()}
        self.origin, self.unit = _measure(located)
        self.drawn = {name: (place - self.origin) / self.unit for name, place in located.items()}
        self.radius = (plain["wheel_radius"] or 0.0) / self.unit
        self.directions = car_directions(plain)
        self.slides: Mapping[str, Mapping[str, Any]] = plain["slides"]
        self.rods: Mapping[str, Sequence[str]] = plain["rods"]
        self.inputs: Mapping[str, Mapping[str, Any]] = plain["inputs"]
        bodies = {body: list(points) for body, points in plain["bodies"].items()}
        held = {point for points in bodies.values() for point in points}
        loose = [p for ends in self.rods.values() for p in ends]
        loose += [p for slide in self.slides.values() for p in slide["points"]]
        self.free = {p: f"point {p}" for p in dict.fromkeys(loose) if p not in held}
        self.bodies = bodies | {body: [point] for point, body in self.free.items()}
        self.holders: dict[str, list[str]] = {}
        for body, points in self.bodies.items():
            for point in points:
                self.holders.setdefault(point, []).append(body)
        self.at = dict(self.drawn)
        for slide in reversed(self.slides.values()):
            for p in slide["points"]:
                if p in self.free:
                    self.at[p] = self._foot(slide, p)
        self.sliding_rods = self._sliding_rods()

    def _sliding_rods(self) -> dict[str, tuple[str, str, str, Array]]:
        """Rods along a line with one end on a point of a body: the other end rides on the rod, which slides.

        Returns:
            By rod its slide, the held end, the other one, and the foot of the held end on the line.
        """
        found: dict[str, tuple[str, str, str, Array]] = {}
        for rod, ends in self.rods.items():
            for p, q in (ends, reversed(ends)):
                on = [name for name, slide in self.slides.items() if q in slide["points"]]
                taken = {(name, held) for name, held, _, _ in found.values()}
                if len(on) != 1 or q not in self.free or p in self.free or (on[0], p) in taken:
                    continue
                slide = self.slides[on[0]]
                if p in slide["points"]:
                    reach, axis = self.drawn[q] - self.drawn[p], self._line(slide)[1]
                    foot, length = self._foot(slide, p), float(np.linalg.norm(reach))
                    found[rod] = on[0], p, q, foot
                    self.at[q] = foot + math.copysign(length, float(reach @ axis)) * axis
        return found

    def tree(self) -> SpanningTree:
        edges = self._edges()
        taken = self._taken(edges)
        joints = self._joints(taken)
        depth = {CHASSIS: 0}
        for joint in joints:
            depth[joint.body] = depth[joint.parent] + COORDINATES[joint.kind]
        self.points = {
            name: Place(min(self.holders[name], key=lambda body: depth[body]), self.at[name])
            for name in self.drawn
            if name in self.holders
        }
        closures = tuple(self._closures(edges, taken))
        return SpanningTree(
            joints=tuple(joints),
            points=self.points,
            closures=closures,
            drives=tuple(self._drives(joints, taken)),
            drawn={name: self.drawn[name] for name in self.points},
            origin=self.origin,
            unit=self.unit,
        )

    def _line(self, slide: Mapping[str, Any]) -> tuple[Array, Array]:
        """Direction of a slide as given, and as a unit vector."""
        through, along = slide["through"], slide["along"]
        if along in self.directions:
            given = self.directions[along]
            return given, given / np.linalg.norm(given)
        axis = unit_vector(self.drawn[along] - self.drawn[through], through, along)
        return axis, axis

    def _off(self, slide: Mapping[str, Any], point: str) -> bool:
        """Whether a point is drawn off the line of a slide."""
        miss, axis = self.drawn[point] - self.drawn[slide["through"]], self._line(slide)[1]
        return float(np.linalg.norm(miss - float(miss @ axis) * axis)) > ON_LINE

    def _foot(self, slide: Mapping[str, Any], point: str) -> Array:
        """The place of a slide's line that is nearest to a point as drawn."""
        through, axis = self.drawn[slide["through"]], self._line(slide)[1]
        if not self._off(slide, point):
            return self.drawn[point]
        return np.asarray(through + float((self.drawn[point] - through) @ axis) * axis)

    def _sliding(self, slide: Mapping[str, Any]) -> dict[str, list[str]]:
        """Points of a slide by the body that they are of; of several bodies the one with the most of them."""
        found: dict[str, list[str]] = {}
        for point in slide["points"]:
            bodies = [b for b in self.holders[point] if b != slide["body"]]
            body = max(bodies, key=lambda b: sum(p in self.bodies[b] for p in slide["points"]))
            found.setdefault(body, []).append(point)
        return found

    def _edges(self) -> list[_Edge]:
        """All possible joints."""
        found = []
        for one, other in combinations(self.bodies, 2):
            shared = tuple(p for p in self.bodies[one] if p in self.bodies[other])
            if len(shared) > 2:
                raise CutError(f"{one} and {other}", f"share {len(shared)} points", "one or two")
            if len(shared) == 2:
                p, q = shared
                axis = unit_vector(self.drawn[q] - self.drawn[p], p, q)
                for body in (one, other):
                    self._require_width(body, p, axis)
                found.append(_Edge((one, other), "hinge", shared, axis))
            elif shared:
                found.append(_Edge((one, other), "ball", shared, NO_AXIS))
        for name, slide in self.slides.items():
            axis = self._line(slide)[1]
            for body, points in self._sliding(slide).items():
                if body in self.free.values():
                    found.append(_Edge((slide["body"], body), "sliding", tuple(points), axis, name))
                elif len(points) > 1 and not any(self._off(slide, p) for p in points):
                    kind: Any = "sliding and turning" if slide["turns"] else "sliding"
                    found.append(_Edge((slide["body"], body), kind, tuple(points), axis, name))
        return found

    def _require_width(self, body: str, start: str, axis: Array) -> None:
        """A moving body on a hinge has a point beside it."""
        if body == CHASSIS:
            return
        for p in self.bodies[body]:
            if np.any(np.cross(axis, self.drawn[p] - self.drawn[start])):
                return
        p = self.bodies[body][-1]
        raise CutError(p, f"lies on the hinge of {body}, as all of its points do", "a place beside that line")

    def _taken(self, edges: list[_Edge]) -> list[_Edge]:
        """The joints of the tree (Kruskal): driven ones first, then by the number of their coordinates."""
        turning = [
            {drive["angle"], drive.get("on", CHASSIS)}
            for drive in self.inputs.values()
            if drive.get("from") == "drawing"
        ]
        groups, taken = _Groups(), []
        for edge in sorted(
            edges, key=lambda e: (set(e.bodies) not in turning, e.coordinates, CHASSIS not in e.bodies)
        ):
            if groups.join(*edge.bodies):
                taken.append(edge)
        return taken

    def _joints(self, taken: list[_Edge]) -> list[Joint]:
        """Joints from the chassis outwards."""
        joints: list[Joint] = []
        reached = [CHASSIS]
        while True:
            for parent in reached:
                for edge in taken:
                    child = {edge.bodies[0]: edge.bodies[1], edge.bodies[1]: edge.bodies[0]}.get(parent)
                    if child is not None and child not in reached:
                        joints += self._hung(edge, parent, child)
                        reached.append(child)
            left = [body for body in self.bodies if body not in reached]
            if not left:
                return joints
            # The body with the most points: what else is there hangs on it.
            root = max(left, key=lambda body: len(self.bodies[body]))
            joints += self._floating(root)
            reached.append(root)

    def _hung(self, edge: _Edge, parent: str, child: str) -> list[Joint]:
        at = self.at[edge.points[0]]
        if edge.joint == "ball":
            return [Joint(child, parent, "ball", at)]
        if edge.joint == "hinge":
            return [Joint(child, parent, "hinge", at, edge.axis)]
        if edge.joint == "sliding":
            return [Joint(child, parent, "slide", at, edge.axis)]
        between = f"{child} slide"
        return [
            Joint(between, parent, "slide", at, edge.axis),
            Joint(child, between, "hinge", at, edge.axis),
        ]

    def _floating(self, body: str) -> list[Joint]:
        at, parent, joints = self.at[self.bodies[body][0]], CHASSIS, []
        names = [f"{body} {axis}" for axis in "xyz"]
        if body in self.free.values():
            names[-1] = body
        for name, axis in zip(names, np.eye(3), strict=True):
            joints.append(Joint(name, parent, "slide", at, axis))
            parent = name
        if parent != body:
            joints.append(Joint(body, parent, "ball", at))
        return joints

    def _place(self, body: str, point: str) -> Place:
        return Place(body, self.at[point])

    def _closures(self, edges: list[_Edge], taken: list[_Edge]) -> Iterator[Closure]:
        """What the tree's joints leave open."""
        met = _Groups()
        for edge in taken:
            if not edge.slide:
                for p in edge.points:
                    met.join((p, edge.bodies[0]), (p, edge.bodies[1]))
        for edge in edges:
            if edge.slide:
                continue
            one, other = edge.bodies
            apart = [p for p in edge.points if met.join((p, one), (p, other))]
            for p in apart:
                ends = (self._place(other, p), self._place(one, p))
                # The first point that meets leaves the second one only to stay on the hinge's line.
                if p != apart[0] or len(apart) < len(edge.points):
                    yield OnLine(p, *ends, edge.axis)
                else:
                    yield Coincide(p, *ends)
        on_rods = {(slide, p) for slide, p, _, _ in self.sliding_rods.values()}
        for name, slide in self.slides.items():
            axis = self._line(slide)[1]
            through = Place(slide["body"], self.at[slide["through"]])
            for body, points in self._sliding(slide).items():
                if any(edge.slide == name and body in edge.bodies for edge in taken):
                    continue
                for p in points[:2]:
                    if (name, p) not in on_rods:
                        yield OnLine(p, self._place(body, p), through, axis)
                if len(points) > 1 and not slide["turns"]:
                    u, v = across(axis)
                    yield Square(name, Place(body, u), Place(slide["body"], v))
        for name, (one, other) in self.rods.items():
            length = float(np.linalg.norm(self.drawn[one] - self.drawn[other]))
            if length == 0.0:
                raise CutError(other, f"is where {one} is, so that {name} has no length", "points apart")
            if name in self.sliding_rods:
                _, p, q, foot = self.sliding_rods[name]
                yield Coincide(p, self.points[p], Place(self.free[q], foot))
                continue
            yield Rod(name, self.points[one], self.points[other], length)

    def _drives(self, joints: list[Joint], taken: list[_Edge]) -> Iterator[Drive]:
        for name, given in self.inputs.items():
            if "angle" in given:
                yield (
                    self._turn(name, given, joints)
                    if given["from"] == "drawing"
                    else self._angle(name, given)
                )
            elif "travel" in given:
                slides = given["travel"] if isinstance(given["travel"], list | tuple) else [given["travel"]]
                for slide in slides:
                    yield self._travel(name, slide, joints, taken)
            elif "height" in given or "contact" in given:
                yield self._height(name, given)
            elif "distance" in given:
                p, q = given["distance"]
                drawn = float(np.linalg.norm(self.drawn[p] - self.drawn[q]))
                if drawn == 0.0:
                    raise CutError(p, f"is where {q} is, so that {name} has no direction", "points apart")
                yield Drive(name, "distance", self.points[p], self.points[q], NO_AXIS, CHASSIS, drawn, drawn)

    def _turn(self, name: str, given: Mapping[str, Any], joints: list[Joint]) -> Drive:
        body, on = given["angle"], given.get("on", CHASSIS)
        for joint in joints:
            if joint.kind == "hinge" and {joint.body, joint.parent} == {body, on}:
                p, q = (p for p in self.bodies[body] if p in self.bodies[on])
                along = float(np.sign(joint.axis @ (self.drawn[q] - self.drawn[p])))
                sign = along if joint.body == body else -along
                place = self._place(body, p)
                return Drive(name, "turn", place, place, joint.axis, on, sign, 0.0, joint.body)
        raise CutError(
            name, f"turns {body} on {on}, which is no hinge of the tree", "a hinge in no closed loop"
        )

    def _angle(self, name: str, given: Mapping[str, Any]) -> Drive:
        first, second = self.points[given["of"]], self.points[given["about"]]
        axis, reach = self.directions[given["from"]], self.drawn[given["of"]] - self.drawn[given["about"]]
        size = float(np.linalg.norm(reach))
        if size == 0.0:
            raise CutError(
                given["of"], f"is where {given['about']} is, so that {name} is no angle", "points apart"
            )
        drawn = math.acos(min(1.0, max(-1.0, float(reach @ axis) / size)))
        return Drive(name, "angle", first, second, axis, CHASSIS, size, drawn)

    def _travel(self, name: str, slide_name: str, joints: list[Joint], taken: list[_Edge]) -> Drive:
        slide = self.slides[slide_name]
        body, p = slide["body"], slide["points"][0]
        given = self._line(slide)[0]
        through = Place(body, self.drawn[slide["through"]])
        size = float(given @ given)
        drawn = float((self.drawn[p] - through.at) @ given) / size
        holder = next(iter(self._sliding(slide)))
        joint, along = "", 1.0
        if any(edge.slide == slide_name and holder in edge.bodies for edge in taken):
            for found in joints:
                ends = {found.body.removesuffix(" slide"), found.parent}
                if found.kind == "slide" and ends == {holder, body}:
                    joint, along = found.body, 1.0 if found.parent == body else -1.0
        return Drive(name, "travel", self._place(holder, p), through, given, body, size, drawn, joint, along)

    def _height(self, name: str, given: Mapping[str, Any]) -> Drive:
        if "height" in given:
            p = given["height"]
            axis = self.directions[given.get("along", "up")]
            second = Place(CHASSIS, self.drawn[p])
            return Drive(name, "height", self.points[p], second, axis, CHASSIS, 1.0, 0.0)
        inner, centre = given["contact"]
        first, axis = self.points[centre], self.directions["up"]
        holder = next((b for b in self.holders[inner] if b in self.holders[centre]), None)
        if holder is None or not self.radius > 0.0:
            raise CutError(
                name, f"needs a wheel with {inner} and {centre}", "points of one body, and a wheel_radius"
            )
        axle = unit_vector(self.drawn[centre] - self.drawn[inner], inner, centre)
        lean = float(axis @ axle)
        if not abs(lean) < 1.0:
            raise CutError(name, "has a wheel that lies flat, with no lowest point", "an upright wheel")
        # Counted from the drawn contact point, which is lower by radius x sqrt(1 - s^2).
        sunk = self.radius * (1.0 - math.sqrt((1.0 - lean) * (1.0 + lean)))
        second = Place(CHASSIS, self.drawn[centre] + sunk * axis)
        first = self._place(holder, centre)
        return Drive(name, "contact", first, second, axis, CHASSIS, self.radius, 0.0, axle=axle)


def car_directions(plain: Mapping[str, Any]) -> dict[str, Array]:
    """Directions of the car by name, (3,)."""
    up, right = np.array(plain["up"], dtype=float), np.array(plain["right"], dtype=float)
    forward = np.cross(up, right)
    return {
        "up": up,
        "down": -up,
        "right": right,
        "left": -right,
        "forward": forward,
        "rearward": -forward,
    }


def _measure(points: Mapping[str, Array]) -> tuple[Array, float]:
    """A place near the car from which differences are exact, (3,), mm, and a power of two, its size, mm.

    Raises:
        CutError: the car has no size, or one that no number has the square of.
    """
    stack = np.array(list(points.values()))
    if not np.isfinite(stack).all():
        raise CutError("hardpoints", "are not all numbers", "finite numbers")
    largest = float(np.abs(stack).max())
    if not largest < 2.0**1000:
        raise CutError("hardpoints", f"lie {largest:.3g} mm away", "less than 1e300 mm")
    size = float(np.ptp(stack, axis=0).max())
    if not size > TINIEST:
        raise CutError("hardpoints", f"lie within {size:.3g} mm", f"more than {TINIEST:g} mm")
    unit = float(np.ldexp(1.0, np.frexp(size)[1] - 1))
    grid = 8.0 * unit
    return np.asarray(np.trunc(stack.mean(axis=0) / grid) * grid + 0.0), unit
