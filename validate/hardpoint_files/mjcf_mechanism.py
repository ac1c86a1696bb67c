"""The mechanism that a MuJoCo model is: its points, and the tables of a mechanism file.

    hinge            two points of both bodies on its axis
    ball, connect    a point of both bodies
    slide            two points of the body on a line of its parent, which do not turn
    no joint, weld   one body
    free joint, or   nothing
    three slides and a ball joint

A body of one point is that point, and one that two ball joints hold is a rod. A body that holds nothing but
one other body hands its joints on to it; between two joints of one body there is a body more. Points are the
sites; where a joint has none, one is made.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import PAIR_ROLES, ROLES
from validate.hardpoint_files.axes import DIRECTIONS, vector_along
from validate.hardpoint_files.mjcf import WORLD, Connect, Mjcf, MjcfJoint
from validate.spanning_tree.cut import across
from validate.tables.errors import FileError

Array = NDArray[np.float64]

# Of the model's size: places that are one but for the six digits that MuJoCo saves a model with.
NEAR = 1e-5
# Of the model's size: how far from a joint's first point its second one is made.
ARM = 0.125
TRAVEL = "wheel_travel"


@dataclass
class _Point:
    """A point: where it is, (3,), m, the bodies that have it, and what it comes from."""

    at: Array
    bodies: set[str]
    source: str


@dataclass(frozen=True)
class MjcfMechanism:
    """A mechanism of a model.

    Attributes:
        points: by name, where each is, (3,), m, and what it comes from.
        tables: of a mechanism file. side: of the wheel. facts: what is not as in the model.
    """

    points: Mapping[str, tuple[Array, str]]
    tables: Mapping[str, Mapping[str, Any]]
    side: str
    facts: tuple[str, ...]


def mechanism_of(model: Mjcf, source: str) -> MjcfMechanism:
    """The mechanism of a model.

    Raises:
        FileError: two sites that must meet are apart in the home pose.
    """
    return _Builder(model, source).mechanism()


class _Builder:
    """A mechanism while it is made."""

    def __init__(self, model: Mjcf, source: str) -> None:
        self.model, self.source = model, source
        places = [at for _, at in model.sites.values()]
        places += [joint.at for body in model.bodies.values() for joint in body.joints]
        places += [at for connect in model.connects for at in connect.places]
        self.size = float(np.ptp(places, axis=0).max()) or 1.0 if places else 1.0
        self.facts = list(model.ignored)
        self.names: set[str] = {CHASSIS}
        self.points: dict[str, _Point] = {}
        self.slides: dict[str, dict[str, Any]] = {}
        self.inputs: dict[str, dict[str, Any]] = {}
        self.first: dict[str, list[str]] = {}
        self.on_axes: set[str] = set()
        self.bodies = self._merged()

    def _merged(self) -> dict[str, str]:
        """By name of a body in the model, that of ours: without a joint, or welded, several are one."""
        found: dict[str, str] = {WORLD: CHASSIS}
        for body in self.model.bodies.values():
            found[body.name] = self._named(body.name) if body.joints else found[body.parent]
        for one, other in self.model.welds:
            kept, gone = sorted((found[one], found[other]), key=lambda name: name != CHASSIS)
            found = {name: kept if own == gone else own for name, own in found.items()}
        return found

    def _named(self, wish: str) -> str:
        """A name that no body, point or slide has, made of letters, digits and underscores."""
        name, base, number = _word(wish), _word(wish), 2
        while name in self.names:
            name, number = f"{base}_{number}", number + 1
        self.names.add(name)
        return name

    def mechanism(self) -> MjcfMechanism:
        model = self.model
        closing = {end for connect in model.connects for end in connect.sites}
        for name, (body, at) in model.sites.items():
            if name not in closing:
                self._made(name, at, {self.bodies[body]}, f"site {name}")
        chains = [one for one in self._chains() if one[0] != one[1]]
        for body, parent, joint in chains:
            if joint.kind == "hinge":
                self._hinge(joint, body, parent)
            elif joint.kind == "ball":
                self._shared(joint.name, joint.at, {body, parent}, f"joint {joint.name}")
        for connect in model.connects:
            self._connect(connect)
        # Last what slides: whether a body is more than a point shows by then.
        for body, parent, joint in chains:
            if joint.kind == "slide":
                self._slide(joint, body, parent)
        return self._tables()

    def _chains(self) -> list[tuple[str, str, MjcfJoint]]:
        """Every joint with the body that it carries and the one that it is on."""
        model, found, handed = self.model, [], dict[str, tuple[str, tuple[tuple[str, MjcfJoint], ...]]]()
        children = Counter(body.parent for body in model.bodies.values())
        used = {body for body, _ in model.sites.values()}
        used |= {body for connect in model.connects for body in connect.bodies}
        used |= {body for pair in model.welds for body in pair}
        for body in model.bodies.values():
            parent, before = handed.get(body.parent, (body.parent, ()))
            between = [self._named(f"{body.name} {joint.name}") for joint in body.joints[:-1]]
            chain = (*before, *zip((*between, self.bodies[body.name]), body.joints, strict=False))
            if body.name not in used and children[body.name] == 1:
                handed[body.name] = parent, chain
            elif body.name not in used and body.name not in children:
                # Such as a wheel that spins.
                self.facts.append(f"body {body.name} holds no site, body or loop, and is left out")
            elif not _is_free([joint for _, joint in chain]):
                base = self.bodies[parent]
                for own, joint in chain:
                    found.append((own, base, joint))
                    base = own
        return found

    # Points.

    def _made(self, wish: str, at: Array, bodies: set[str], source: str) -> str:
        name = self._named(wish)
        self.points[name] = _Point(at, bodies, source)
        return name

    def _shared(self, wish: str, at: Array, bodies: set[str], source: str) -> str:
        """A point of bodies at a place: one that any of them has there, or a new one."""
        for name, point in self.points.items():
            theirs = not point.bodies.isdisjoint(bodies)
            if theirs and np.linalg.norm(point.at - at) <= NEAR * self.size:
                point.bodies |= bodies
                return name
        return self._made(wish, at, bodies, source)

    def _on(self, joint: MjcfJoint, names: Iterable[str]) -> list[str]:
        """The first and the last point of these on the axis of a joint; one if there are no two."""
        along = {name: float((self.points[name].at - joint.at) @ joint.axis) for name in names}
        lines = {name: joint.at + size * joint.axis for name, size in along.items()}
        near = [n for n, at in lines.items() if np.linalg.norm(self.points[n].at - at) <= NEAR * self.size]
        ends = sorted(near, key=lambda name: along[name])
        far = len(ends) > 1 and along[ends[-1]] - along[ends[0]] > NEAR * self.size
        return [ends[0], ends[-1]] if far else ends[:1]

    def _of(self, body: str) -> list[str]:
        """A body's points, those of the hinge that carries it in the hinge's order."""
        first = self.first.get(body, [])
        return [*first, *(n for n, p in self.points.items() if body in p.bodies and n not in first)]

    # Joints.

    def _hinge(self, joint: MjcfJoint, body: str, parent: str) -> None:
        source = f"joint {joint.name}"
        theirs = [n for n, p in self.points.items() if len(p.bodies & {body, parent}) == 1]
        pair = self._on(joint, theirs)
        for name in pair:
            self.points[name].bodies |= {body, parent}
        if not pair:
            pair = [self._made(f"{joint.name}_axis", joint.at, {body, parent}, source)]
        if len(pair) < 2:
            end = self.points[pair[0]].at + ARM * self.size * joint.axis
            pair.append(self._made(f"{joint.name}_axis_end", end, {body, parent}, source))
        self.first[body] = pair
        self.on_axes |= {body, parent}
        on = {} if parent == CHASSIS else {"on": parent}
        if body != CHASSIS:
            self.inputs[joint.name] = {"angle": body, **on, "from": "drawing"}

    def _connect(self, connect: Connect) -> None:
        one, other = (self.bodies[body] for body in connect.bodies)
        first, second = connect.places
        apart = float(np.linalg.norm(second - first))
        if apart > NEAR * self.size:
            told = f"joins places that are {1e3 * apart:.4g} mm apart in the home pose"
            raise FileError(self.source, f"connect {connect.name}", told, "places that meet as drawn")
        if one != other:
            self._shared(connect.name, first, {one, other}, f"connect {connect.name}")

    def _slide(self, joint: MjcfJoint, body: str, parent: str) -> None:
        source, own = f"joint {joint.name}", self._of(body)
        is_point = len(own) == 1 and body not in self.on_axes
        on = own if is_point else self._on(joint, [n for n in own if parent not in self.points[n].bodies])
        ends = on or [self._made(joint.name, joint.at, {body}, source)]
        start, step = self.points[ends[0]].at, ARM * self.size * joint.axis
        if len(ends) > 1 and self.points[ends[0]].bodies & self.points[ends[1]].bodies - {body}:
            # Of a hinge about the line: its two points do not say which of its bodies is kept from turning.
            # A step either way there may be a point that was made already.
            ends[1] = self._made(f"{joint.name}_end", start - 2.0 * step, {body}, source)
        if not is_point and len(ends) < 2:
            ends.append(self._made(f"{joint.name}_end", start + step, {body}, source))
        words = [word for word in DIRECTIONS if np.array_equal(vector_along(word), joint.axis)]
        # Along a direction the travel is 0 as drawn. A line through two points needs these apart.
        through = self._shared(f"{joint.name}_zero", start if words else start - step, {parent}, source)
        line = {"body": parent, "through": through, "along": words[0] if words else ends[-1]}
        name = self._named(f"{joint.name}_slide")
        self.on_axes |= {body, parent}
        if is_point:
            self.points[ends[0]].bodies -= {body}
            self.slides[name] = {"point": ends[0], **line}
        else:
            self.slides[name] = {"points": ends, **line, "turns": False}
        self.inputs[joint.name] = {"travel": name}

    # Tables.

    def _tables(self) -> MjcfMechanism:
        bodies: dict[str, list[str]] = {CHASSIS: self._of(CHASSIS)}
        rods: dict[str, list[str]] = {}
        for body in dict.fromkeys(body for point in self.points.values() for body in sorted(point.bodies)):
            own = self._of(body)
            if body == CHASSIS:
                continue
            if len(own) == 2 and body not in self.on_axes:
                rods[body] = own
            elif len(own) > 1:
                bodies[body] = [*own, *self._beside(body, own)]
        roles = self._roles(bodies)
        wheel = {TRAVEL: {"height": roles["wheel_axis"][1]}} if "wheel_axis" in roles else {}
        named = {joint: self.model.actuated.get(joint, joint) for joint in self.inputs}
        driven = {named[joint]: self.inputs[joint] for joint in self.model.actuated if joint in self.inputs}
        others = {named[joint]: one for joint, one in self.inputs.items() if named[joint] not in driven}
        inputs = {_word(name): one for name, one in {**driven, **wheel, **others}.items()}
        tables: dict[str, Mapping[str, Any]] = {"bodies": bodies, "rods": rods, "slides": self.slides}
        tables |= {"inputs": inputs, "roles": roles}
        points = {name: (point.at, point.source) for name, point in self.points.items()}
        side = "right" if self.model.texts.get("side") == "right" else "left"
        return MjcfMechanism(points, tables, side, tuple(self.facts))

    def _beside(self, body: str, own: list[str]) -> list[str]:
        """A point more, of a body whose points lie in one line."""
        start = self.points[own[0]].at
        arms = np.array([self.points[name].at - start for name in own[1:]])
        axis = arms[np.argmax(np.linalg.norm(arms, axis=1))]
        axis = axis / np.linalg.norm(axis)
        if np.linalg.norm(np.cross(arms, axis), axis=1).max() > NEAR * self.size:
            return []
        at = start + ARM * self.size * across(axis)[0]
        return [self._made(f"{body}_beside", at, {body}, f"body {body}, whose points lie in one line")]

    def _roles(self, bodies: Mapping[str, Any]) -> dict[str, Any]:
        """Roles that texts of the model name, of bodies and points that are there."""
        found: dict[str, Any] = {}
        for role in ROLES:
            words = [_word(word) for word in self.model.texts.get(role, "").split()]
            known = bodies if role == "knuckle" else self.points
            if words and all(word in known for word in words):
                found[role] = words if role in PAIR_ROLES else words[0]
        return found


def _word(name: str) -> str:
    """A name of letters, digits and underscores."""
    return re.sub(r"\W+", "_", name).strip("_") or "unnamed"


def _is_free(joints: Sequence[MjcfJoint]) -> bool:
    """Whether joints leave a body all of its six freedoms."""
    kinds = sorted(joint.kind for joint in joints)
    if kinds != ["ball", "slide", "slide", "slide"]:
        return kinds == ["free"]
    axes = np.array([joint.axis for joint in joints if joint.kind == "slide"])
    return bool(abs(np.linalg.det(axes)) > NEAR)
