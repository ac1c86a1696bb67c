"""Reads a MuJoCo model (MJCF) in its home pose with MuJoCo, and converts it to points and a mechanism.

    hinge            two common points of both bodies on its axis
    ball, connect    a common point of both bodies
    slide            two points of the body on a line of its parent, without rotation
    no joint, weld   the two bodies are one
    free joint, or   no constraint
    three slides and a ball joint

A body with one point becomes this point, and a body between two ball joints becomes a rod. A body that
carries only one other body, and a body between two joints of the same body, are intermediate bodies. Points
are the sites; a joint without a site gets a new point.

Elements that do not change the kinematics (geoms, masses, forces, contacts, sensors, pictures, ranges of
joints) are ignored, and soft equalities are taken as rigid. Equalities other than connect and weld, and mocap
bodies, are refused.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np

from pointcoord.mechanism.inputs import CHASSIS
from pointcoord.mechanism.structure import PAIR_ROLES, ROLES
from validate.arrays import Array
from validate.extras import needed
from validate.hardpoint_files.contents import DIRECTIONS, FARTHEST, Axes, Place, short
from validate.hardpoint_files.written_scene import Drawing, ScenePoint
from validate.plain_text import counted_as
from validate.spanning_tree.tree import across
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

# A car has some thirty bodies, and the time grows with the third power of their number.
MOST_BODIES = 100
# Largest distance, m, and angle, rad, of a weld in the home pose; MuJoCo saves models with six digits.
APART = 1e-5
SOLREF = (0.02, 1.0)  # the default of an equality
KINDS = ("free", "ball", "slide", "hinge")  # in the order of mjtJoint
# Positions closer than this share of the model's size are equal: MuJoCo saves models with six digits.
NEAR = 1e-5
# Distance between the two points that are made for a joint, as a share of the model's size.
ARM = 0.125
# Decimals of a metre to which coordinates are rounded, a tenth of their rounding error: 0.57 m is 570 mm.
DIGITS = 15
TRAVEL = "wheel_travel"


@dataclass(frozen=True)
class _Equality:
    """A connect or a weld between two bodies, which are given by number.

    Attributes:
        places: the position of the joint on each body, (2, 3), m.
        sites: numbers of the sites that define it, if any.
    """

    name: str
    bodies: tuple[int, int]
    places: Array
    sites: tuple[int, ...] = ()


class _HomePose:
    """A model in its home pose. Bodies, joints and sites have MuJoCo's numbers; body 0 is the world.

    Attributes:
        to_scene: matrix that multiplies rows of the file's coordinates, (3, 3).
        sites, anchors: positions of the sites and of the joints, (n, 3), m.
        axes: unit vectors of the axes of the joints, (n, 3).
        connects, welds: connects, which close loops; welds, which fix two bodies to each other.
        texts: texts of `custom`, by name.
    """

    def __init__(self, path: str, axes: Axes) -> None:
        """Read a model, with the files that it includes."""
        self.path, self.to_scene, self.mujoco = path, axes.matrix.T, needed("import", "mujoco")
        try:
            spec = self.mujoco.MjSpec.from_file(path)
            self.model = model = spec.compile()
            self.texts: dict[str, str] = {one.name: one.data for one in spec.texts}
        except ValueError as error:
            problem = f"is refused by MuJoCo ({' '.join(str(error).split())})"
            raise FileError(path, "", problem, "an MJCF model that MuJoCo can read") from None
        if model.nbody > MOST_BODIES:
            raise FileError(path, "", f"has {model.nbody - 1} bodies", f"fewer than {MOST_BODIES}")
        self.data = data = self.mujoco.MjData(model)
        self.mujoco.mj_kinematics(model, data)
        self.mujoco.mj_comPos(model, data)
        self.mujoco.mj_makeConstraint(model, data)
        if not (np.abs([*data.site_xpos.flat, *data.xanchor.flat]) <= float(FARTHEST)).all():
            problem = "has positions too far from the origin"
            raise FileError(path, "", problem, f"at most {FARTHEST:g} m")
        for body in np.flatnonzero(model.body_mocapid >= 0).tolist():
            raise self._refuse("body", body, "is a mocap body", "bodies on joints")
        self.sites, self.anchors, self.axes = (
            places @ self.to_scene for places in (data.site_xpos, data.xanchor, data.xaxis)
        )
        self.connects: list[_Equality] = []
        self.welds: list[_Equality] = []
        for one in np.flatnonzero(model.eq_active0).tolist():
            if model.eq_type[one] == self.mujoco.mjtEq.mjEQ_CONNECT:
                self.connects.append(self._equality(one))
            elif model.eq_type[one] == self.mujoco.mjtEq.mjEQ_WELD:
                self._require_as_drawn(one)
                self.welds.append(self._equality(one))
            else:
                raise self._refuse("equality", one, "is of a kind that is not supported", "connect or weld")

    def name(self, kind: str, number: int) -> str:
        """The name of an element, or its kind and number if it has none."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}_{number}"

    def ignored(self) -> Iterator[str]:
        """Messages on ignored ranges and tendons, and on soft equalities, which are taken as rigid."""
        for one in np.flatnonzero(self.model.jnt_limited).tolist():
            yield f"range of joint {short(self.name('joint', one))} is ignored"
        for one in range(self.model.ntendon):
            yield f"tendon {short(self.name('tendon', one))} is ignored"
        soft = self.model.eq_active0 & (self.model.eq_solref != SOLREF).any(axis=1)
        for one in np.flatnonzero(soft).tolist():
            yield f"solref of {short(self.name('equality', one))} is ignored: it is taken as rigid"

    def joints(self, body: int) -> range:
        """The joints of a body to its parent, in order; without a joint the body is fixed to it."""
        first = int(self.model.body_jntadr[body])
        return range(first, first + int(self.model.body_jntnum[body]))

    def actuated(self) -> dict[str, str]:
        """Names of actuators by names of the joints that they drive."""
        model = self.model
        own = np.flatnonzero(model.actuator_trntype == self.mujoco.mjtTrn.mjTRN_JOINT).tolist()
        return {self.name("joint", model.actuator_trnid[i, 0]): self.name("actuator", i) for i in own}

    def _refuse(self, kind: str, number: int, problem: str, allowed: str) -> FileError:
        return FileError(self.path, f"{kind} {short(self.name(kind, number))}", problem, allowed)

    def _equality(self, one: int) -> _Equality:
        """The bodies that an equality joins, and its position on each."""
        model, data, name = self.model, self.data, self.name("equality", one)
        ends = int(model.eq_obj1id[one]), int(model.eq_obj2id[one])
        if model.eq_objtype[one] == self.mujoco.mjtObj.mjOBJ_SITE:
            first, second = (int(model.site_bodyid[end]) for end in ends)
            name = self.name("site", ends[0]) if name.startswith("equality_") else name
            return _Equality(name, (first, second), self.sites[[*ends]], ends)
        anchors = model.eq_data[one, :6].reshape(2, 3)
        places = [
            data.xpos[end] + data.xmat[end].reshape(3, 3) @ anchor
            for end, anchor in zip(ends, anchors, strict=True)
        ]
        return _Equality(name, ends, places @ self.to_scene)

    def _require_as_drawn(self, one: int) -> None:
        """Refuse a weld that would move its bodies from the home pose, or that leaves rotations free."""
        data, equality = self.data, self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        apart = data.efc_pos[(data.efc_type == equality) & (data.efc_id == one)]
        if np.abs(apart).max(initial=0.0) > APART or not self.model.eq_data[one, 10] > 0.0:
            name = self.name("equality", one)
            problem = "does not hold its bodies as drawn"
            raise FileError(self.path, f"weld {short(name)}", problem, "one without relpose")


@dataclass
class _Point:
    """A point: its position, (3,), m, its bodies, and its source in words."""

    at: Array
    bodies: set[str]
    source: str


@dataclass(frozen=True)
class _Joint:
    """A joint: the body that it carries, its parent body, its position, (3,), m, and unit axis, (3,)."""

    name: str
    kind: str
    body: str
    parent: str
    at: Array
    axis: Array

    @property
    def source(self) -> str:
        return f"joint {self.name}"


def drawing_of(path: str, axes: Axes) -> Drawing:
    """The drawing of a model: its points and its mechanism.

    Args:
        axes: directions of its x, y and z.
    Raises:
        FileError: MuJoCo refuses the model, the model has an element that is not supported, or the two
            positions of a connect are apart in the home pose.
        MissingLibrary: MuJoCo is not installed.
    """
    return _Builder(_HomePose(path, axes)).drawing()


class _Builder:
    """Builds the points and tables of a mechanism from a model."""

    def __init__(self, pose: _HomePose) -> None:
        self.pose = pose
        places = [*pose.sites, *pose.anchors, *(at for one in pose.connects for at in one.places)]
        self.size = float(np.ptp(places, axis=0).max()) or 1.0 if places else 1.0
        self.facts = [*pose.ignored()]
        self.names: set[str] = {CHASSIS}
        self.points: dict[str, _Point] = {}
        self.slides: dict[str, dict[str, Any]] = {}
        self.inputs: dict[str, dict[str, Any]] = {}
        self.first: dict[str, list[str]] = {}
        self.on_axes: set[str] = set()
        # Our name of each body in the model; bodies fixed to each other or welded share a name.
        self.bodies = list[str]([CHASSIS])
        for body, parent in enumerate(pose.model.body_parentid.tolist()[1:], 1):
            is_free = len(pose.joints(body)) > 0
            self.bodies.append(self._named(pose.name("body", body)) if is_free else self.bodies[parent])
        for weld in pose.welds:
            ends = (self.bodies[body] for body in weld.bodies)
            kept, gone = sorted(ends, key=lambda name: name != CHASSIS)
            self.bodies = [kept if own == gone else own for own in self.bodies]

    def drawing(self) -> Drawing:
        pose = self.pose
        closing = {site for connect in pose.connects for site in connect.sites}
        for site, (body, at) in enumerate(zip(pose.model.site_bodyid, pose.sites, strict=True)):
            if site not in closing:
                name = pose.name("site", site)
                self._made(name, at, {self.bodies[body]}, f"site {name}")
        joints = [joint for joint in self._joints() if joint.body != joint.parent]
        for joint in joints:
            if joint.kind == "hinge":
                self._hinge(joint)
            elif joint.kind == "ball":
                self._shared(joint.name, joint.at, {joint.body, joint.parent}, joint.source)
        for connect in pose.connects:
            self._connect(connect)
        # Slides are last: by then it is known whether a body has more than one point.
        for joint in joints:
            if joint.kind == "slide":
                self._slide(joint)
        return self._tables()

    def _joints(self) -> Iterator[_Joint]:
        """The joints of bodies that are not free.

        Two joints of one body have a new body between them. A body without sites or loops that carries only
        one body is between joints too; one that carries none, such as a spinning wheel, is left out.
        """
        pose, model = self.pose, self.pose.model
        parents: list[int] = model.body_parentid.tolist()
        equalities = (*pose.connects, *pose.welds)
        ends = {0, *model.site_bodyid.tolist(), *(body for one in equalities for body in one.bodies)}
        needed = set(ends)
        for body in range(len(parents) - 1, 0, -1):
            needed |= {parents[body]} if body in needed else set()
        carried_by = Counter(parents[body] for body in needed - {0})
        ends |= {body for body, count in carried_by.items() if count > 1}
        for body, parent in enumerate(parents):
            if body not in needed:
                self.facts.append(f"body {pose.name('body', body)} has no site or loop, and is left out")
            if body not in ends:
                continue
            chain = [*pose.joints(body)]
            while parent not in ends:
                chain, parent = [*pose.joints(parent), *chain], parents[parent]
            kinds = [KINDS[model.jnt_type[joint]] for joint in chain]
            slides = [joint for joint, kind in zip(chain, kinds, strict=True) if kind == "slide"]
            three = sorted(kinds) == ["ball", "slide", "slide", "slide"]
            if kinds == ["free"] or (three and abs(np.linalg.det(pose.axes[slides])) > NEAR):
                continue
            base = self.bodies[parent]
            for joint, kind in zip(chain, kinds, strict=True):
                own, name = int(model.jnt_bodyid[joint]), pose.name("joint", joint)
                is_last = joint == pose.joints(own)[-1]
                carried = self.bodies[own] if is_last else self._named(f"{pose.name('body', own)} {name}")
                yield _Joint(name, kind, carried, base, pose.anchors[joint], pose.axes[joint])
                base = carried

    # Points.

    def _named(self, wish: str) -> str:
        """A new unique name of letters, digits and underscores."""
        name, number = _word(wish), 2
        while name in self.names:
            name, number = f"{_word(wish)}_{number}", number + 1
        self.names.add(name)
        return name

    def _made(self, wish: str, at: Array, bodies: set[str], source: str) -> str:
        name = self._named(wish)
        self.points[name] = _Point(at, {*bodies}, source)
        return name

    def _shared(self, wish: str, at: Array, bodies: set[str], source: str) -> str:
        """A common point of bodies at a position: an existing point of any of them, or a new one."""
        for name, point in self.points.items():
            theirs = not point.bodies.isdisjoint(bodies)
            if theirs and np.linalg.norm(point.at - at) <= NEAR * self.size:
                point.bodies |= bodies
                return name
        return self._made(wish, at, bodies, source)

    def _pair(self, wish: str, joint: _Joint, names: Iterable[str], bodies: set[str]) -> list[str]:
        """Two common points of bodies on the axis of a joint: the outermost of `names`, or else new ones."""
        along = {name: float((self.points[name].at - joint.at) @ joint.axis) for name in names}
        lines = {name: joint.at + size * joint.axis for name, size in along.items()}
        near = [n for n, at in lines.items() if np.linalg.norm(self.points[n].at - at) <= NEAR * self.size]
        ends = sorted(near, key=lambda name: along[name])
        far = len(ends) > 1 and along[ends[-1]] - along[ends[0]] > NEAR * self.size
        pair = [ends[0], ends[-1]] if far else ends[:1]
        for name in pair:
            self.points[name].bodies |= bodies
        if not pair:
            pair = [self._made(wish, joint.at, bodies, joint.source)]
        if len(pair) < 2:
            end = self.points[pair[0]].at + ARM * self.size * joint.axis
            pair.append(self._made(f"{wish}_end", end, bodies, joint.source))
        return pair

    def _of(self, body: str) -> list[str]:
        """The points of a body, first those of the hinge that carries it."""
        first = self.first.get(body, [])
        return [*first, *(n for n, p in self.points.items() if body in p.bodies and n not in first)]

    # Joints.

    def _hinge(self, joint: _Joint) -> None:
        ours = {joint.body, joint.parent}
        theirs = [name for name, point in self.points.items() if len(point.bodies & ours) == 1]
        self.first[joint.body] = self._pair(f"{joint.name}_axis", joint, theirs, ours)
        self.on_axes |= ours
        on = {} if joint.parent == CHASSIS else {"on": joint.parent}
        if joint.body != CHASSIS:
            self.inputs[joint.name] = {"angle": joint.body, **on, "from": "drawing"}

    def _connect(self, connect: _Equality) -> None:
        one, other = (self.bodies[body] for body in connect.bodies)
        first, second = connect.places
        apart = float(np.linalg.norm(second - first))
        if apart > NEAR * self.size:
            problem = f"joins positions that are {1e3 * apart:.4g} mm apart in the home pose"
            raise FileError(self.pose.path, f"connect {connect.name}", problem, "positions that coincide")
        if one != other:
            self._shared(connect.name, first, {one, other}, f"connect {connect.name}")

    def _slide(self, joint: _Joint) -> None:
        body, parent, own = joint.body, joint.parent, self._of(joint.body)
        is_point = len(own) == 1 and body not in self.on_axes
        only = [name for name in own if parent not in self.points[name].bodies]
        ends = own if is_point else self._pair(joint.name, joint, only, {body})
        start, step = self.points[ends[0]].at, ARM * self.size * joint.axis
        if not is_point and self.points[ends[0]].bodies & self.points[ends[1]].bodies - {body}:
            # These are points of a hinge on this line. They belong to both its bodies, so they do not show
            # which body may not rotate. A new point is made, two steps away, where no other has been made.
            ends[1] = self._made(f"{joint.name}_end", start - 2.0 * step, {body}, joint.source)
        words = [word for word, way in DIRECTIONS.items() if np.array_equal(way, joint.axis)]
        # Along a direction the drawn travel is 0. A line through two points needs them at a distance.
        through = self._shared(f"{joint.name}_zero", start if words else start - step, {parent}, joint.source)
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

    def _tables(self) -> Drawing:
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
        # Of several wheels no roles are read, but each wheel can be driven: a live axle is on no joint.
        for name, text in self.pose.texts.items():
            part, _, role = name.rpartition(".")
            centre = _word((text.split() or [""])[-1])
            if part and role == "wheel_axis" and centre in self.points:
                wheel[f"{part}.{TRAVEL}"] = {"height": centre}
        actuated = {joint: name for joint, name in self.pose.actuated().items() if joint in self.inputs}
        driven = {name: self.inputs[joint] for joint, name in actuated.items()}
        others = {joint: one for joint, one in self.inputs.items() if joint not in {**actuated, **driven}}
        inputs = {_word(name): one for name, one in {**driven, **wheel, **others}.items()}
        tables = {"bodies": bodies, "rods": rods, "slides": self.slides, "inputs": inputs, "roles": roles}
        side = "right" if self.pose.texts.get("side") == "right" else "left"
        points = [ScenePoint(name, _in_mm(one.at), one.source) for name, one in self.points.items()]
        return Drawing(self.pose.path, "mechanism", side, tuple(points), tuple(self.facts), tables=tables)

    def _beside(self, body: str, own: list[str]) -> list[str]:
        """A further point of a body whose points are collinear; empty for other bodies."""
        start = self.points[own[0]].at
        arms = np.array([self.points[name].at - start for name in own[1:]])
        axis = arms[np.argmax(np.linalg.norm(arms, axis=1))]
        axis = axis / np.linalg.norm(axis)
        if np.linalg.norm(np.cross(arms, axis), axis=1).max() > NEAR * self.size:
            return []
        at = start + ARM * self.size * across(axis)[0]
        return [self._made(f"{body}_beside", at, {body}, f"body {body}, whose points are collinear")]

    def _roles(self, bodies: Mapping[str, Any]) -> dict[str, Any]:
        """Roles from the texts of the model; a message for each text that gives none."""
        found: dict[str, Any] = {}
        if several := [
            name for name in self.pose.texts if name.partition(".")[2].rpartition(".")[2] in ROLES
        ]:
            self.facts.append(
                f"of several wheels only the travel is read, not the roles {', '.join(several)}"
            )
        for role in ROLES:
            if not (words := [_word(word) for word in self.pose.texts.get(role, "").split()]):
                continue
            kind, known = ("body", bodies) if role == "knuckle" else ("site", self.points)
            count = 2 if role in PAIR_ROLES else 1
            if unknown := [word for word in words if word not in known]:
                self.facts.append(f"text {role} is ignored: no {kind} is called {short(unknown[0])}")
            elif len(words) != count:
                self.facts.append(
                    f"text {role} is ignored: it has {counted_as(len(words), 'name')}; allowed: {count}"
                )
            else:
                found[role] = words if count == 2 else words[0]
        return found


def _in_mm(at: Array) -> Place:
    """A position in m as decimal numbers in mm."""
    x, y, z = (Decimal(repr(round(number, DIGITS))) * LENGTHS["m"] for number in at.tolist())
    return x, y, z


def _word(name: str) -> str:
    """A name of letters, digits and underscores."""
    return re.sub(r"\W+", "_", name).strip("_") or "unnamed"
