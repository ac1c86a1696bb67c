r"""Cuts a mechanism into the form that any multibody program takes: a tree of joints, closed by ball joints.

Every body is connected by one joint to its parent, another body or the chassis. Joints with few coordinates
are chosen first, and those at the chassis before others: hinges, sliding joints, then ball joints. A body
that only rods or lines hold is connected to the chassis by six coordinates. A point of no body becomes a
body, which slides along its line or moves freely.

Every other joint and every rod becomes a closure of the tree. Programs have few closures and drives in
common, so all closures and drives are built from joints and from ball joints that close loops:

    a point on a line      a body that slides along it, and a ball joint with the point
    a rod                  a body on a ball joint at one end, whose spin is fixed; a ball joint at the other
    a driven distance      a rod that is a driven slide
    a driven height,       a body on three perpendicular slides, the first of them driven, and a ball joint
    angle or travel        with the point; three more slides if it counts from a point that moves
    a driven hinge         the hinge
    perpendicular          two points along the first direction stay equally far along the second: bodies on
    directions             two slides each, which one slide carries
    the ground             a body on a driven joint, in the reverse sense, for each input that moves the
                           chassis
    a wheel's contact      a body on a hinge about the wheel's axis; its point one radius below is driven, and
    point                  a line across it stays level, by closures as above

An angle is driven by the corresponding height, size x cos(angle).

In the reference pose all joint coordinates are zero; every body is at its drawn place, with the axes of the
car's frame. Exception: a point of no body that is drawn off its line starts on the line. Lengths are measured
from `origin` in `unit`, in which the car's size is between one and two.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, count, repeat
from typing import Any, Literal, TypeVar

import numpy as np

from validate.arrays import Array
from validate.errors import NoAnswer
from validate.spanning_tree.tree import (
    CHASSIS,
    Driven,
    Joint,
    Kind,
    Loop,
    Place,
    SpanningTree,
    across,
    car_directions,
)

NO_AXIS = np.zeros(3)
TINIEST = 1e-250  # mm: the square of a smaller car is not a normal floating-point number
# Share of the car's size: points that are nearer to a line count as drawn on it.
ON_LINE = 16.0 * float(np.finfo(float).eps)
COORDINATES: Mapping[Kind, int] = {"hinge": 1, "slide": 1, "ball": 3}
Member = TypeVar("Member")


@dataclass(frozen=True)
class _Edge:
    """A possible joint of the tree, or two in a row.

    Attributes:
        slide: name of its slide, or "" if it is not a sliding joint.
    """

    bodies: tuple[str, str]
    kinds: tuple[Kind, ...]
    points: tuple[str, ...]
    axis: Array
    slide: str = ""

    @property
    def coordinates(self) -> int:
        return sum(COORDINATES[kind] for kind in self.kinds)


def _merge(groups: dict[Member, Member], one: Member, other: Member) -> bool:
    """Merge the groups of two members; `groups` maps each member to its group. Whether they were apart."""
    old, new = groups.setdefault(one, one), groups.setdefault(other, other)
    groups.update({member: new for member, group in groups.items() if group == old})
    return old != new


def unit_vector(vector: Array, start: str, end: str) -> Array:
    """Unit vector from one point to another.

    Raises:
        NoAnswer: they coincide.
    """
    size = float(np.linalg.norm(vector))
    if size == 0.0:
        raise NoAnswer(start, f"is where {end} is, so that their line has no direction", "points apart")
    return np.asarray(vector / size)


def turned_least(vector: Array, line: Array, other: Array) -> Array:
    """A vector after the smallest rotation that brings the unit vector `line` onto plus or minus `other`."""
    cosine, axis = float(line @ other), np.cross(line, other)
    if cosine < 0.0:
        cosine, axis = -cosine, -axis
    turn = np.cross(axis, vector)
    return np.asarray(vector + turn + np.cross(axis, turn) / (1.0 + cosine))


def cut(plain: Mapping[str, Any]) -> SpanningTree:
    """The tree of a flat mechanism.

    Raises:
        NoAnswer: points that must differ coincide or lie on one line, or the car has no size.
    """
    return _Cutter(plain).tree()


class _Cutter:
    """A flat mechanism while it is cut into a tree."""

    def __init__(self, plain: Mapping[str, Any]) -> None:
        self.plain = plain
        located = {name: np.array(place, dtype=float) for name, place in plain["points"].items()}
        self.origin, self.unit = _measure(located)
        self.drawn = {name: (place - self.origin) / self.unit for name, place in located.items()}
        self.radius = (plain["wheel_radius"] or 0.0) / self.unit
        self.directions = {n: axis / np.linalg.norm(axis) for n, axis in car_directions(plain).items()}
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
        self.rods_made: dict[str, Array] = {}
        self.loops: list[Loop] = []
        self.driven: list[Driven] = []

    def _sliding_rods(self) -> dict[str, tuple[str, str, str, Array]]:
        """Rods along a slide's line with one end at a point of a body: the rod slides with its other end.

        Returns:
            For each rod its slide, the end at the body, the other end, and the first end's foot on the line.
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
                    reach, axis = self.drawn[q] - self.drawn[p], self._line(slide)
                    foot, length = self._foot(slide, p), float(np.linalg.norm(reach))
                    found[rod] = on[0], p, q, foot
                    self.at[q] = foot + math.copysign(length, float(reach @ axis)) * axis
        return found

    def tree(self) -> SpanningTree:
        edges = self._edges()
        self.taken = self._taken(edges)
        self.made: dict[tuple[str, frozenset[str]], list[Joint]] = {}
        self.joints = self._joints()
        depth = {CHASSIS: 0}
        for joint in self.joints:
            depth[joint.body] = depth[joint.parent] + COORDINATES[joint.kind]
        self.points = {
            name: Place(min(self.holders[name], key=lambda body: depth[body]), self.at[name])
            for name in self.drawn
            if name in self.holders
        }
        self._close(edges)
        for name, given in self.inputs.items():
            self._drive(f"drive {name}", name, given)
        return SpanningTree(
            plain=self.plain,
            joints=tuple(self.joints),
            rods=self.rods_made,
            loops=tuple(self.loops),
            driven=tuple(self.driven),
            points=self.points,
            drawn={name: self.drawn[name] for name in self.points},
            origin=self.origin,
            unit=self.unit,
        )

    def _line(self, slide: Mapping[str, Any]) -> Array:
        """Unit vector along a slide's line."""
        through, along = slide["through"], slide["along"]
        if along in self.directions:
            return self.directions[along]
        return unit_vector(self.drawn[along] - self.drawn[through], through, along)

    def _foot(self, slide: Mapping[str, Any], point: str) -> Array:
        """The place of a slide's line nearest to a point as drawn; the point itself if it is there."""
        place, through, axis = self.drawn[point], self.drawn[slide["through"]], self._line(slide)
        foot = np.asarray(through + float((place - through) @ axis) * axis)
        return place if float(np.linalg.norm(place - foot)) <= ON_LINE else foot

    def _sliding(self, slide: Mapping[str, Any]) -> dict[str, list[str]]:
        """Points of a slide by their body; of a point's bodies, the one with the most points of the slide."""
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
                raise NoAnswer(f"{one} and {other}", f"share {len(shared)} points", "one or two")
            if len(shared) == 2:
                p, q = shared
                axis = unit_vector(self.drawn[q] - self.drawn[p], p, q)
                for body in (one, other):
                    self._require_width(body, p, axis)
                found.append(_Edge((one, other), ("hinge",), shared, axis))
            elif shared:
                found.append(_Edge((one, other), ("ball",), shared, NO_AXIS))
        for name, slide in self.slides.items():
            axis = self._line(slide)
            for body, points in self._sliding(slide).items():
                is_point = body in self.free.values()
                kinds: tuple[Kind, ...] = ("slide", "hinge")
                if is_point or not slide["turns"]:
                    kinds = ("slide",)
                on_line = (self._foot(slide, p) is self.drawn[p] for p in points)
                if is_point or (len(points) > 1 and all(on_line)):
                    found.append(_Edge((slide["body"], body), kinds, tuple(points), axis, name))
        return found

    def _require_width(self, body: str, start: str, axis: Array) -> None:
        """Raise `NoAnswer` if a moving body on a hinge has no point off the hinge's line."""
        if body == CHASSIS:
            return
        for p in self.bodies[body]:
            if np.any(np.cross(axis, self.drawn[p] - self.drawn[start])):
                return
        p = self.bodies[body][-1]
        raise NoAnswer(p, f"lies on the hinge of {body}, as all of its points do", "a place beside that line")

    def _taken(self, edges: list[_Edge]) -> list[_Edge]:
        """The joints of the tree (Kruskal): driven ones first, then by the number of their coordinates."""
        turning = [
            {drive["angle"], drive.get("on", CHASSIS)}
            for drive in self.inputs.values()
            if drive.get("from") == "drawing"
        ]
        ways = sorted(
            edges, key=lambda e: (set(e.bodies) not in turning, e.coordinates, CHASSIS not in e.bodies)
        )
        groups: dict[str, str] = {}
        return [edge for edge in ways if _merge(groups, *edge.bodies)]

    def _joints(self) -> list[Joint]:
        """Joints from the chassis outwards; `made` has those of each edge, by its slide and its bodies."""
        joints: list[Joint] = []
        reached = [CHASSIS]
        while True:
            for parent in reached:
                for edge in self.taken:
                    child = {edge.bodies[0]: edge.bodies[1], edge.bodies[1]: edge.bodies[0]}.get(parent)
                    if child is not None and child not in reached:
                        names = [*(f"{child} slide" for _ in edge.kinds[1:]), child]
                        links = zip(names, edge.kinds, repeat(edge.axis))  # as many as names
                        made = _in_a_row(parent, self.at[edge.points[0]], links)
                        self.made[edge.slide, frozenset(edge.bodies)] = made
                        joints += made
                        reached.append(child)
            left = [body for body in self.bodies if body not in reached]
            if not left:
                return joints
            # The body with the most points: the remaining bodies are then connected to it.
            root = max(left, key=lambda body: len(self.bodies[body]))
            joints += self._floating(root)
            reached.append(root)

    def _floating(self, body: str) -> list[Joint]:
        names = [f"{body} {axis}" for axis in "xyz"]
        names[2:] = [body] if body in self.free.values() else [names[2], body]
        axes = [*np.eye(3), NO_AXIS][: len(names)]
        kinds: list[Kind] = ["slide", "slide", "slide", "ball"]
        return _in_a_row(CHASSIS, self.at[self.bodies[body][0]], zip(names, kinds, axes, strict=False))

    def _close(self, edges: list[_Edge]) -> None:
        """Add the closures for the joints, slides and rods that are not in the tree."""
        met: dict[tuple[str, str], tuple[str, str]] = {}
        numbers = count()
        for edge in self.taken:
            if not edge.slide:
                for p in edge.points:
                    _merge(met, (p, edge.bodies[0]), (p, edge.bodies[1]))
        for edge in edges:
            if edge.slide:
                continue
            one, other = edge.bodies
            apart = [p for p in edge.points if _merge(met, (p, one), (p, other))]
            for p in apart:
                number, first, second = next(numbers), Place(other, self.at[p]), Place(one, self.at[p])
                # Once the first point meets, the second one need only stay on the hinge's line.
                if p != apart[0] or len(apart) < len(edge.points):
                    self._on_line(f"closure {number} {p}", p, first, second, edge.axis)
                else:
                    self.loops.append(Loop(p, first, second))
        on_rods = {(slide, p) for slide, p, _, _ in self.sliding_rods.values()}
        for name, slide in self.slides.items():
            axis = self._line(slide)
            through = Place(slide["body"], self.at[slide["through"]])
            for body, points in self._sliding(slide).items():
                if (name, frozenset((slide["body"], body))) in self.made:
                    continue
                for p in points[:2]:
                    if (name, p) not in on_rods:
                        self._on_line(
                            f"closure {next(numbers)} {p}", p, Place(body, self.at[p]), through, axis
                        )
                if len(points) > 1 and not slide["turns"]:
                    # Two places of the body stay level: its frame's origin, and one along u, rotated by the
                    # smallest rotation of the slide's line onto the body's line.
                    u, v = across(axis)
                    own = unit_vector(self.drawn[points[1]] - self.drawn[points[0]], *points[:2])
                    start = next(joint.at for joint in self.joints if joint.body == body)
                    ends = Place(body, start), Place(body, start + turned_least(u, axis, own))
                    self._level(f"closure {next(numbers)} {name}", name, slide["body"], v, *ends)
        for name, (one, other) in self.rods.items():
            length, number = self._distance(one, other, f"{name} has no length"), next(numbers)
            if name in self.sliding_rods:
                _, p, q, foot = self.sliding_rods[name]
                self.loops.append(Loop(p, self.points[p], Place(self.free[q], foot)))
            else:
                self._rod(f"closure {number} {name}", name, self.points[one], self.points[other], length)

    def _distance(self, one: str, other: str, without: str) -> float:
        length = float(np.linalg.norm(self.drawn[one] - self.drawn[other]))
        if length == 0.0:
            raise NoAnswer(other, f"is where {one} is, so that {without}", "points apart")
        return length

    def _slide(self, name: str, place: Place, axis: Array) -> Place:
        self.joints.append(Joint(name, place.body, "slide", place.at, axis))
        return Place(name, place.at)

    def _slides(self, name: str, place: Place, axes: tuple[Array, ...]) -> Place:
        for number, axis in enumerate(axes):
            place = self._slide(f"{name} {number}", place, axis)
        return place

    def _on_line(self, name: str, of: str, point: Place, line: Place, axis: Array) -> None:
        """A point that stays on a line of a body."""
        foot = line.at + float((point.at - line.at) @ axis) * axis
        self.loops.append(Loop(of, self._slide(name, Place(line.body, foot), axis), point))

    def _level(self, name: str, of: str, body: str, axis: Array, first: Place, second: Place) -> None:
        """Two places that stay equally far along an axis of a body."""
        start = self._slide(name, Place(body, first.at), axis)
        for label, place in (("first", first), ("second", second)):
            level = place.at - float((place.at - first.at) @ axis) * axis
            end = self._slides(f"{name} {label}", Place(start.body, level), across(axis))
            self.loops.append(Loop(of, end, place))

    def _rod(
        self, name: str, of: str, first: Place, second: Place, length: float, is_driven: bool = False
    ) -> None:
        axis = second.at - first.at
        axis = axis / float(np.linalg.norm(axis))
        self.joints.append(Joint(name, first.body, "ball", first.at))
        self.rods_made[name] = axis
        end = Place(name, first.at + length * axis)
        if is_driven:
            end = self._slide(f"{name} length", end, axis)
            self.driven.append(Driven(of, "distance", length, end.body, 1.0, -length))
        self.loops.append(Loop(of, end, second))

    def _drive(self, label: str, name: str, given: Mapping[str, Any]) -> None:
        """Drive the mechanism by an input; those that move the chassis do not."""
        if given.get("from") == "drawing":
            self._turn(name, given)
        elif "angle" in given:
            self._angle(label, name, given)
        elif slides := given.get("travel", given.get("steers")):
            per_input = float(self.plain["rack_per_turn"]) / math.tau if "steers" in given else 1.0
            for slide in slides:
                self._travel(f"{label} {slide}", name, slide, per_input)
        elif "height" in given:
            p, axis = given["height"], self.directions[given.get("along", "up")]
            still = Place(CHASSIS, self.drawn[p])
            self._height(label, name, "length", (self.points[p], still), axis, CHASSIS, 1.0, 0.0)
        elif "contact" in given:
            base = self._ground if given.get("over") == "ground" else CHASSIS
            rim, up = self._contact(label, name, base, *given["contact"]), self.directions["up"]
            self._height(label, name, "length", (rim, Place(base, rim.at)), up, base, 1.0, 0.0)
        elif "distance" in given:
            p, q = given["distance"]
            length = self._distance(q, p, f"{name} has no direction")
            self._rod(label, name, self.points[p], self.points[q], length, True)

    def _turn(self, name: str, given: Mapping[str, Any]) -> None:
        body, on = given["angle"], given.get("on", CHASSIS)
        (joint,) = self.made.get(("", frozenset((body, on))), [None])
        if joint is None or joint.kind != "hinge":
            words = f"turns {body} on {on}, which is not a hinge of the tree"
            raise NoAnswer(name, words, "a hinge in no closed loop")
        p, q = (p for p in self.bodies[body] if p in self.bodies[on])
        along = float(np.sign(joint.axis @ (self.drawn[q] - self.drawn[p])))
        sign = along if joint.body == body else -along
        self.driven.append(Driven(name, "turn", 0.0, joint.body, sign, 0.0))

    def _angle(self, label: str, name: str, given: Mapping[str, Any]) -> None:
        of, about, axis = given["of"], given["about"], self.directions[given["from"]]
        size = self._distance(about, of, f"{name} is no angle")
        drawn = math.acos(min(1.0, max(-1.0, float((self.drawn[of] - self.drawn[about]) @ axis) / size)))
        ends = self.points[of], self.points[about]
        self._height(label, name, "angle", ends, axis, CHASSIS, size, drawn)

    def _travel(self, label: str, name: str, slide_name: str, per_input: float) -> None:
        slide = self.slides[slide_name]
        body, p, axis = slide["body"], slide["points"][0], self._line(slide)
        through, holder = self.drawn[slide["through"]], next(iter(self._sliding(slide)))
        drawn = float((self.drawn[p] - through) @ axis)
        made = self.made.get((slide_name, frozenset((holder, body))))
        if made is None:
            ends = Place(holder, self.at[p]), Place(body, through)
            self._height(label, name, "length", ends, axis, body, 1.0, drawn, per_input)
            return
        joint = made[0]  # the slide, before a hinge
        # Its coordinate is measured from the reference pose.
        sign, start = 1.0 if joint.parent == body else -1.0, float((self.at[p] - through) @ axis)
        self.driven.append(Driven(name, "length", drawn, joint.body, sign, -sign * start, per_input))

    def _height(
        self,
        label: str,
        name: str,
        kind: Literal["angle", "length"],
        ends: tuple[Place, Place],
        axis: Array,
        of: str,
        size: float,
        drawn: float,
        per_input: float = 1.0,
    ) -> None:
        """Drive axis . (first - second) = size x f(input), the axis a direction of the body `of`."""
        first, second = ends
        start, base = float((first.at - second.at) @ axis), Place(of, first.at)
        if second.body != of:
            # This body moves with the second point and turns with the body `of`.
            carried = self._slides(f"{label} from", Place(of, second.at), (axis, *across(axis)))
            self.loops.append(Loop(name, carried, second))
            base = Place(carried.body, first.at)
        end = self._slide(label, base, axis)
        self.driven.append(Driven(name, kind, drawn, end.body, size, -start, per_input))
        self.loops.append(Loop(name, self._slides(f"{label} beside", end, across(axis)), first))

    @cached_property
    def _ground(self) -> str:
        """The body that represents the ground.

        The inputs move the chassis relative to the ground one after the other, turns before displacements,
        each in the ground's axes. Here the chassis is the base, so the joints have the reverse sense, and the
        joint of the first input comes first.
        """
        moves = [(name, given) for name, given in self.inputs.items() if "moves" in given]
        turns = [(name, given) for name, given in self.inputs.items() if "turns" in given]
        body = CHASSIS
        for name, given in [*turns, *moves]:
            turned, axis = "turns" in given, self.directions[given["along"]]
            at = self.drawn[given["about"]] if turned else np.zeros(3)
            joint = Joint(f"ground by {name}", body, "hinge" if turned else "slide", at, axis)
            self.joints.append(joint)
            kind: Literal["turn", "length"] = "turn" if turned else "length"
            self.driven.append(Driven(name, kind, 0.0, joint.body, -1.0, 0.0))
            body = joint.body
        return body

    def _contact(self, label: str, name: str, base: str, inner: str, centre: str) -> Place:
        """A wheel's lowest point above a body, as a place of a body that turns about the wheel's axis."""
        up = self.directions["up"]
        holder = next((b for b in self.holders[inner] if b in self.holders[centre]), None)
        if holder is None or not self.radius > 0.0:
            raise NoAnswer(
                name, f"needs a wheel with {inner} and {centre}", "points of one body, and a wheel_radius"
            )
        axle = unit_vector(self.drawn[centre] - self.drawn[inner], inner, centre)
        if not abs(float(up @ axle)) < 1.0:
            raise NoAnswer(name, "has a wheel that lies flat, with no lowest point", "an upright wheel")
        hub = self.at[centre]
        down = float(up @ axle) * axle - up
        down = down / float(np.linalg.norm(down))
        rim = f"{label} rim"
        self.joints.append(Joint(rim, holder, "hinge", hub, axle))
        tip = Place(rim, hub + np.cross(axle, down))
        self._level(f"{label} level", name, base, up, Place(rim, hub), tip)
        return Place(rim, hub + self.radius * down)


def _in_a_row(parent: str, at: Array, links: Iterable[tuple[str, Kind, Array]]) -> list[Joint]:
    """Joints in series at one place, each on the body of the one before."""
    joints: list[Joint] = []
    for name, kind, axis in links:
        joints.append(Joint(name, parent, kind, at, axis))
        parent = name
    return joints


def _measure(points: Mapping[str, Array]) -> tuple[Array, float]:
    """An origin near the car, (3,), mm, from which differences are exact; the car's size, mm, a power of 2.

    Raises:
        NoAnswer: the car has no size, or the square of its size is not a normal number.
    """
    stack = np.array(list(points.values()))
    if not np.isfinite(stack).all():
        raise NoAnswer("hardpoints", "are not all numbers", "finite numbers")
    largest = float(np.abs(stack).max())
    if not largest < 2.0**1000:
        raise NoAnswer("hardpoints", f"lie {largest:.3g} mm away", "less than 1e300 mm")
    size = float(np.ptp(stack, axis=0).max())
    if not size > TINIEST:
        raise NoAnswer("hardpoints", f"lie within {size:.3g} mm", f"more than {TINIEST:g} mm")
    unit = float(np.ldexp(1.0, np.frexp(size)[1] - 1))
    grid = 8.0 * unit
    return np.asarray(np.trunc(stack.mean(axis=0) / grid) * grid + 0.0), unit
