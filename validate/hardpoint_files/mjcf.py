"""A MuJoCo model (MJCF): what of it makes a mechanism, its bodies, joints, sites, connects and welds.

Everything is placed in the scene's axes as it is in the home pose. What changes no motion (geoms, masses,
forces, contacts, sensors, pictures, ranges of joints) is passed over; what may change it and is not known
here is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from validate.hardpoint_files.contents import FARTHEST, short
from validate.tables.errors import FileError

Array = NDArray[np.float64]
Element = ElementTree.Element
Attributes = Mapping[str, str]

WORLD = "world"
# A car has some thirty, and time grows with the third power.
MOST_BODIES = 100
# Elements without a say in where bodies can go, of the model and of a body.
SECTIONS = {
    *("compiler", "option", "size", "statistic", "visual", "default", "asset", "worldbody", "contact"),
    *("equality", "tendon", "actuator", "sensor", "keyframe", "custom"),
}
IN_BODY = {"body", "joint", "freejoint", "site", "geom", "inertial", "camera", "light"}
KINDS = ("hinge", "slide", "ball", "free")
TURNS, OTHER_TURNS = ("quat", "axisangle", "euler"), ("xyaxes", "zaxis")


@dataclass(frozen=True)
class MjcfJoint:
    """A joint: of what kind, where, (3,), m, and along or about which unit vector, (3,)."""

    name: str
    kind: str
    at: Array
    axis: Array


@dataclass(frozen=True)
class MjcfBody:
    """A body in the home pose.

    Attributes:
        joints: to its parent, in their order; without one it is a piece of it.
    """

    name: str
    parent: str
    joints: tuple[MjcfJoint, ...]


@dataclass(frozen=True)
class Connect:
    """Two bodies that meet at one place: where it is of each, (3,), m, and the sites that say so, if any."""

    name: str
    line: int
    bodies: tuple[str, str]
    places: tuple[Array, Array]
    sites: tuple[str, ...] = ()


@dataclass(frozen=True)
class Mjcf:
    """A model, read.

    Attributes:
        bodies: by name, parents first, without the world.
        sites: by name, the body of each and where it is, (3,), m.
        connects, welds: what closes loops; pairs of bodies that are one.
        actuated: names of actuators by the joints that they drive. texts: of `custom`, by name.
        facts: what is not as MuJoCo has it, in words.
    """

    bodies: Mapping[str, MjcfBody]
    sites: Mapping[str, tuple[str, Array]]
    connects: tuple[Connect, ...]
    welds: tuple[tuple[str, str], ...]
    actuated: Mapping[str, str]
    texts: Mapping[str, str]
    facts: tuple[str, ...]


def read_mjcf(text: str, source: str, axes: Array) -> Mjcf:
    """Read a model.

    Args:
        axes: the scene's coordinates from the file's, (3, 3).
    Raises:
        FileError: it is no MJCF, or has what changes its motion and is not known.
    """
    return _Reader(source, *_parsed(text, source)).model(axes)


def _parsed(text: str, source: str) -> tuple[Element, dict[Element, int]]:
    """The root of a file, and the line of each element."""
    parser, builder, lines = expat.ParserCreate(), ElementTree.TreeBuilder(), dict[Element, int]()

    def start(tag: str, attributes: dict[str, str]) -> None:
        lines[builder.start(tag, attributes)] = parser.CurrentLineNumber

    def doctype(*_: object) -> None:
        # Its entities could be longer than any memory.
        raise FileError(source, parser.CurrentLineNumber, "has a DOCTYPE", "MJCF without one")

    parser.StartElementHandler, parser.EndElementHandler = start, builder.end
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        raise FileError(source, error.lineno, f"is no XML: {expat.ErrorString(error.code)}", "MJCF") from None
    return builder.close(), lines


@dataclass(frozen=True)
class _Frame:
    """Where a body's frame is, (3,), and its axes as columns, (3, 3)."""

    at: Array
    axes: Array

    def place(self, local: Array) -> Array:
        return np.asarray(self.at + self.axes @ local)


class _Reader:
    """A file while it is read."""

    def __init__(self, source: str, root: Element, lines: Mapping[Element, int]) -> None:
        self.source, self.root, self.lines = source, root, lines
        if root.tag != "mujoco":
            raise self.refuse(root, f"is <{root.tag}>", "a whole model, <mujoco>")
        for section in root:
            if section.tag not in SECTIONS:
                raise self.refuse(section, "is not known here", f"none, or {', '.join(sorted(SECTIONS))}")
        self.compiler = {key: value for one in root.findall("compiler") for key, value in one.items()}
        for one in root.findall("compiler"):
            if one.get("coordinate", "local") != "local":
                raise self.refuse(one, "has global coordinates", "local ones; MuJoCo 2.3.3 converts")
        self.defaults = self._defaults()
        self.bodies: dict[str, MjcfBody] = {}
        self.frames: dict[str, _Frame] = {}
        self.sites: dict[str, tuple[str, Array]] = {}
        self.facts: list[str] = []

    def refuse(self, element: Element, problem: str, allowed: str) -> FileError:
        name = element.get("name")
        called = f"<{element.tag}>" + (f" {short(name)}" if name else "")
        return FileError(self.source, self.lines[element], f"{called} {problem}", allowed)

    def model(self, axes: Array) -> Mjcf:
        self.frames[WORLD] = _Frame(np.zeros(3), axes)
        waiting = [
            (world, WORLD, world.get("childclass", "main")) for world in self.root.findall("worldbody")
        ]
        # A list and no recursion: bodies may be nested deeper than calls may be.
        for element, body, of_class in waiting:
            for child in element:
                if child.tag not in IN_BODY:
                    raise self.refuse(child, "is not known in a body", ", ".join(sorted(IN_BODY)))
                if child.tag == "site":
                    given = self._given(child, of_class)
                    if "fromto" in given:
                        raise self.refuse(child, "has fromto", "pos")
                    at = self.frames[body].place(self._numbers(child, given, "pos", (0.0, 0.0, 0.0)))
                    self.sites[child.get("name", f"site_{len(self.sites)}")] = body, at
                if child.tag == "body":
                    inner = child.get("childclass", of_class)
                    waiting.append((child, self._body(child, body, inner), inner))
        connects, welds = self._equalities()
        actuated = {
            one.attrib["joint"]: one.get("name", one.attrib["joint"])
            for section in self.root.findall("actuator")
            for one in section
            if "joint" in one.attrib
        }
        texts = {one.get("name", ""): one.get("data", "") for one in self.root.findall("custom/text")}
        return Mjcf(self.bodies, self.sites, connects, welds, actuated, texts, tuple(self.facts))

    def _defaults(self) -> dict[str, dict[str, Attributes]]:
        """Attributes by class and element, each class with those of the classes around it."""
        found: dict[str, dict[str, Attributes]] = {"main": {}}
        waiting = [(one, "main", "main") for one in self.root.findall("default")]
        for element, name, around in waiting:
            own = {child.tag: child.attrib for child in element if child.tag != "default"}
            base = found[around]
            found[name] = base | {tag: {**base.get(tag, {}), **given} for tag, given in own.items()}
            for inner in element.findall("default"):
                waiting.append((inner, inner.get("class", ""), name))
        return found

    def _given(self, element: Element, of_class: str, tag: str = "") -> Attributes:
        """An element's attributes, with those of its class."""
        name = element.get("class", of_class)
        if name not in self.defaults:
            raise self.refuse(element, f"is of class {short(name)}", ", ".join(self.defaults))
        return {**self.defaults[name].get(tag or element.tag, {}), **element.attrib}

    def _numbers(self, element: Element, given: Attributes, key: str, default: Sequence[float]) -> Array:
        """As many numbers as the default has."""
        words = given[key].split() if key in given else default
        try:
            found = np.array([float(word) for word in words])
        except ValueError:
            found = np.array([np.nan])
        if len(found) != len(default) or not (np.abs(found) <= float(FARTHEST)).all():
            told = f"has {key} {short(given.get(key, ''))}"
            raise self.refuse(element, told, f"{len(default)} numbers up to {FARTHEST:g}")
        return found

    def _direction(self, element: Element, given: Attributes, key: str, default: Sequence[float]) -> Array:
        """A vector as a unit vector."""
        found = self._numbers(element, given, key, default)
        if not np.any(found):
            raise self.refuse(element, f"has {key} {short(given[key])}", "a direction")
        return _unit(found)

    def _turn(self, element: Element, given: Attributes) -> Array:
        """The axes of a frame as columns."""
        keys = [key for key in (*TURNS, *OTHER_TURNS) if key in given]
        if len(keys) > 1 or not {*keys} <= {*TURNS}:
            raise self.refuse(element, f"has {' and '.join(keys)}", f"one of {', '.join(TURNS)}")
        key = keys[0] if keys else "quat"
        unit = 1.0 if self.compiler.get("angle", "degree") == "radian" else np.pi / 180.0
        if key == "axisangle":
            x, y, z, angle = self._numbers(element, given, key, (0.0, 0.0, 1.0, 0.0))
            return np.asarray(Rotation.from_rotvec(angle * unit * _unit(np.array([x, y, z]))).as_matrix())
        if key == "euler":
            # Small letters are axes that turn along, for which scipy has capitals.
            order = self.compiler.get("eulerseq", "xyz").swapcase()
            if sorted(order.lower()) != ["x", "y", "z"] or not (order.isupper() or order.islower()):
                raise self.refuse(element, f"turns by eulerseq {order.swapcase()}", "such as xyz or XYZ")
            angles = self._numbers(element, given, key, (0.0, 0.0, 0.0)) * unit
            return np.asarray(Rotation.from_euler(order, angles).as_matrix())
        w, x, y, z = self._direction(element, given, key, (1.0, 0.0, 0.0, 0.0))
        return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())

    def _body(self, element: Element, parent: str, of_class: str) -> str:
        """A body with its joints; its name."""
        name = element.get("name") or f"body_{len(self.bodies)}"
        if element.get("mocap") == "true":
            raise self.refuse(element, "is moved from outside (mocap)", "bodies on joints")
        if len(self.bodies) == MOST_BODIES:
            raise self.refuse(element, f"is one body more than {MOST_BODIES}", "fewer")
        if name in self.frames:
            raise self.refuse(element, "has the name of another one", "a name of its own")
        base = self.frames[parent]
        at = base.place(self._numbers(element, element.attrib, "pos", (0.0, 0.0, 0.0)))
        self.frames[name] = frame = _Frame(at, base.axes @ self._turn(element, element.attrib))
        joints = [child for child in element if child.tag in ("joint", "freejoint")]
        found = tuple(self._joint(one, name, number, frame, of_class) for number, one in enumerate(joints))
        self.bodies[name] = MjcfBody(name, parent, found)
        return name

    def _joint(self, element: Element, body: str, number: int, frame: _Frame, of_class: str) -> MjcfJoint:
        free = element.tag == "freejoint"
        given = {**element.attrib, "type": "free"} if free else self._given(element, of_class)
        kind, name = given.get("type", "hinge"), given.get("name", f"{body}_joint_{number}")
        if kind not in KINDS:
            raise self.refuse(element, f"is of type {short(kind)}", ", ".join(KINDS))
        axis = self._direction(element, given, "axis", (0.0, 0.0, 1.0)) if kind in KINDS[:2] else np.zeros(3)
        if np.any(self._numbers(element, given, "ref", (0.0,))):
            self.facts.append(f"joint {name} is counted from the home pose, and not from its ref")
        at = frame.place(self._numbers(element, given, "pos", (0.0, 0.0, 0.0)))
        return MjcfJoint(name, kind, at, frame.axes @ axis)

    def _equalities(self) -> tuple[tuple[Connect, ...], tuple[tuple[str, str], ...]]:
        connects, welds = [], []
        for number, one in enumerate(one for section in self.root.findall("equality") for one in section):
            given = self._given(one, "main", "equality")
            if given.get("active", "true") == "false":
                self.facts.append(f"<{one.tag}> on line {self.lines[one]} is not active and left out")
            elif one.tag == "connect":
                connects.append(self._connect(one, given, number))
            elif one.tag == "weld":
                welds.append(self._weld(one, given))
            else:
                raise self.refuse(one, "is an equality that is not known here", "connect or weld")
        return tuple(connects), tuple(welds)

    def _connect(self, element: Element, given: Attributes, number: int) -> Connect:
        name, line = given.get("name", ""), self.lines[element]
        if "site1" in given:
            sites = given["site1"], given.get("site2", "")
            (one, first), (other, second) = (self._site(element, site) for site in sites)
            return Connect(name or sites[0], line, (one, other), (first, second), sites)
        one, other = self._pair(element, given)
        if "anchor" not in given:
            raise self.refuse(element, "has no anchor", "an anchor, or two sites")
        at = self.frames[one].place(self._numbers(element, given, "anchor", (0.0, 0.0, 0.0)))
        return Connect(name or f"connect_{number}", line, (one, other), (at, at))

    def _site(self, element: Element, name: str) -> tuple[str, Array]:
        if name not in self.sites:
            raise self.refuse(element, f"names no site {short(name)}", "site1 and site2 of the model")
        return self.sites[name]

    def _weld(self, element: Element, given: Attributes) -> tuple[str, str]:
        # Zeros for a quaternion stand for the home pose.
        if np.any(self._numbers(element, given, "relpose", (0.0,) * 7)[3:]):
            raise self.refuse(element, "has a relpose", "none: welded as in the home pose")
        for key in ("site1", "torquescale"):
            if key in given:
                raise self.refuse(element, f"has {key}", "body1 and body2")
        return self._pair(element, given)

    def _pair(self, element: Element, given: Attributes) -> tuple[str, str]:
        """The two bodies of an equality; the second may be left out."""
        one, other = given.get("body1", ""), given.get("body2", WORLD)
        for body in (one, other):
            if body != WORLD and body not in self.bodies:
                known = ", ".join((WORLD, *self.bodies))
                raise self.refuse(element, f"names no body {short(body)}", f"body1 and body2 of {known}")
        return one, other


def _unit(vector: Array) -> Array:
    """A vector of length 1; of one that is zero, zero. The largest component first: squares can vanish."""
    largest = float(np.abs(vector).max())
    scaled = vector / (largest or 1.0)
    return np.asarray(scaled / (np.linalg.norm(scaled) or 1.0))
