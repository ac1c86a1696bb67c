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
from validate.hardpoint_files.contents import DIRECTIONS, FARTHEST, Axes, Point, short
from validate.hardpoint_files.written_scene import Drawing
from validate.plain_text import counted_as
from validate.spanning_tree.tree import across
from validate.tables.errors import FileError
from validate.tables.units import LENGTHS

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


def mechanism_of(path: str, axes: Axes) -> Drawing:
    """The drawing of a model: its points and its mechanism.

    Args:
        axes: directions of its x, y and z.
    Raises:
        FileError: MuJoCo refuses the model, the model has an element that is not supported, or the two
            positions of a connect are apart in the home pose.
        MissingLibrary: MuJoCo is not installed.
    """
    return _Model(path, axes).drawing()


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


class _Model:
    """A model in its home pose, and the points and tables of a mechanism that are made of it.

    Numbers of bodies, joints, sites and equalities are MuJoCo's; body 0 is the world.

    Attributes:
        sites: positions of the sites, (n, 3), m, in the scene's axes.
        connects, welds: numbers of the equalities that close loops, and that fix two bodies to each other.
        texts: texts of `custom`, by name.
        bodies: our name of each body in the model; bodies fixed to each other or welded share a name.
        first: for a body that a hinge carries the two points of its axis, which show the sense of rotation.
        on_axes: bodies with a hinge or slide, which need more points than a rod.
    """

    def __init__(self, path: str, axes: Axes) -> None:
        self.path, self.mujoco, self.to_scene = path, needed("import", "mujoco"), axes.matrix.T
        try:
            spec = self.mujoco.MjSpec.from_file(path)
            self.model = model = spec.compile()
        except ValueError as error:
            problem = f"is refused by MuJoCo ({' '.join(str(error).split())})"
            raise FileError(path, "", problem, "an MJCF model that MuJoCo can read") from None
        self.texts: dict[str, str] = {one.name: one.data for one in spec.texts}
        self.data = self.mujoco.MjData(model)
        self.mujoco.mj_kinematics(model, self.data)
        self.mujoco.mj_comPos(model, self.data)
        self.mujoco.mj_makeConstraint(model, self.data)
        self.sites = self.data.site_xpos @ self.to_scene
        self.connects, self.welds = self._supported()
        places = [*self.sites, *(self.data.xanchor @ self.to_scene)]
        if not (np.abs(places) <= float(FARTHEST)).all():
            raise FileError(path, "", "has positions too far from the origin", f"at most {FARTHEST:g} m")
        self.size = float(np.ptp(places, axis=0).max()) or 1.0 if places else 1.0
        self.facts = [*self._ignored()]
        self.names: set[str] = {CHASSIS}
        self.points: dict[str, _Point] = {}
        self.slides: dict[str, dict[str, Any]] = {}
        self.inputs: dict[str, dict[str, Any]] = {}
        self.first: dict[str, list[str]] = {}
        self.on_axes: set[str] = set()
        self.bodies = list[str]([CHASSIS])
        for body, parent in enumerate(model.body_parentid.tolist()[1:], 1):
            moves = model.body_jntnum[body] > 0
            self.bodies.append(self._named(self._name("body", body)) if moves else self.bodies[parent])
        for weld in self.welds:
            ends = (self.bodies[body] for body in self._joined(weld)[0])
            kept, gone = sorted(ends, key=lambda name: name != CHASSIS)
            self.bodies = [kept if own == gone else own for own in self.bodies]

    def drawing(self) -> Drawing:
        """The points and the tables of the mechanism."""
        model = self.model
        by_sites = [one for one in self.connects if self._is_by_sites(one)]
        closing = {*model.eq_obj1id[by_sites].tolist(), *model.eq_obj2id[by_sites].tolist()}
        for site, (body, at) in enumerate(zip(model.site_bodyid, self.sites, strict=True)):
            if site not in closing:
                name = self._name("site", site)
                self._made(name, at, {self.bodies[body]}, f"site {name}")
        joints = [joint for joint in self._joints() if joint.body != joint.parent]
        for joint in joints:
            if joint.kind == "hinge":
                self._hinge(joint)
            elif joint.kind == "ball":
                self._shared(joint.name, joint.at, {joint.body, joint.parent}, f"joint {joint.name}")
        for connect in self.connects:
            self._connect(connect)
        # Slides are last: by then it is known whether a body has more than one point.
        for joint in joints:
            if joint.kind == "slide":
                self._slide(joint)
        tables = self._tables()
        side = "right" if self.texts.get("side") == "right" else "left"
        points: list[Point] = []
        for name, point in self.points.items():
            x, y, z = (Decimal(repr(round(at, DIGITS))) * LENGTHS["m"] for at in point.at.tolist())
            points.append(Point(name, (x, y, z), point.source))
        return Drawing(self.path, "mechanism", side, tuple(points), tuple(self.facts), tables=tables)

    # The elements of the model.

    def _name(self, kind: str, number: int) -> str:
        """The name of an element, or its kind and number if it has none."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}_{number}"

    def _supported(self) -> tuple[list[int], list[int]]:
        """The connects and the welds; other elements that change the motion are refused."""
        model, data = self.model, self.data
        equalities = self.mujoco.mjtEq, self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        connects, welds = list[int](), list[int]()
        for body in np.flatnonzero(model.body_mocapid >= 0).tolist():
            place = f"body {short(self._name('body', body))}"
            raise FileError(self.path, place, "is a mocap body", "bodies on joints")
        for one in np.flatnonzero(model.eq_active0).tolist():
            name = short(self._name("equality", one))
            if model.eq_type[one] == int(equalities[0].mjEQ_CONNECT):
                connects.append(one)
            elif model.eq_type[one] != int(equalities[0].mjEQ_WELD):
                problem = "is of a kind that is not supported"
                raise FileError(self.path, f"equality {name}", problem, "connect or weld")
            else:
                welds.append(one)
                apart = data.efc_pos[(data.efc_type == equalities[1]) & (data.efc_id == one)]
                # Its torquescale is 0 if it leaves rotations free.
                if np.abs(apart).max(initial=0.0) > APART or not model.eq_data[one, 10] > 0.0:
                    problem = "does not hold its bodies as drawn"
                    raise FileError(self.path, f"weld {name}", problem, "one without relpose")
        return connects, welds

    def _ignored(self) -> Iterator[str]:
        """Messages on ignored ranges and tendons, and on soft equalities, which are taken as rigid."""
        for one in np.flatnonzero(self.model.jnt_limited).tolist():
            yield f"range of joint {short(self._name('joint', one))} is ignored"
        for one in range(self.model.ntendon):
            yield f"tendon {short(self._name('tendon', one))} is ignored"
        soft = self.model.eq_active0 & (self.model.eq_solref != SOLREF).any(axis=1)
        for one in np.flatnonzero(soft).tolist():
            yield f"solref of {short(self._name('equality', one))} is ignored: it is taken as rigid"

    def _is_by_sites(self, equality: int) -> bool:
        return bool(self.model.eq_objtype[equality] == self.mujoco.mjtObj.mjOBJ_SITE)

    def _joined(self, equality: int) -> tuple[list[int], Array]:
        """The two bodies that an equality joins, and its position on each, (2, 3), m, in the scene's axes."""
        model, data = self.model, self.data
        ends = [int(model.eq_obj1id[equality]), int(model.eq_obj2id[equality])]
        if self._is_by_sites(equality):
            return model.site_bodyid[ends].tolist(), self.sites[ends]
        anchors = model.eq_data[equality, :6].reshape(2, 3)
        turned = np.einsum("nij,nj->ni", data.xmat[ends].reshape(2, 3, 3), anchors)
        return ends, (data.xpos[ends] + turned) @ self.to_scene

    def _joints(self) -> Iterator[_Joint]:
        """The joints of bodies that are not free.

        Two joints of one body have a new body between them. A body without sites or loops that carries only
        one body is between joints too; one that carries none, such as a spinning wheel, is left out.
        """
        model = self.model
        at, axis = self.data.xanchor @ self.to_scene, self.data.xaxis @ self.to_scene
        own = [
            [*range(at, at + count)] for at, count in zip(model.body_jntadr, model.body_jntnum, strict=True)
        ]
        parents: list[int] = model.body_parentid.tolist()
        equalities = (*self.connects, *self.welds)
        ends = {
            0,
            *model.site_bodyid.tolist(),
            *(body for one in equalities for body in self._joined(one)[0]),
        }
        needed = set(ends)
        for body in range(len(parents) - 1, 0, -1):
            needed |= {parents[body]} if body in needed else set()
        carried_by = Counter(parents[body] for body in needed - {0})
        ends |= {body for body, count in carried_by.items() if count > 1}
        for body, parent in enumerate(parents):
            if body not in needed:
                self.facts.append(f"body {self._name('body', body)} has no site or loop, and is left out")
            if body not in ends:
                continue
            chain = own[body]
            while parent not in ends:
                chain, parent = [*own[parent], *chain], parents[parent]
            kinds = [KINDS[model.jnt_type[joint]] for joint in chain]
            if sorted(kinds) in (["free"], ["ball", "slide", "slide", "slide"]):
                continue
            base = self.bodies[parent]
            for joint, kind in zip(chain, kinds, strict=True):
                on, name = int(model.jnt_bodyid[joint]), self._name("joint", joint)
                between = f"{self._name('body', on)} {name}"
                carried = self.bodies[on] if joint == own[on][-1] else self._named(between)
                yield _Joint(name, kind, carried, base, at[joint], axis[joint])
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
            if point.bodies & bodies and np.linalg.norm(point.at - at) <= NEAR * self.size:
                point.bodies |= bodies
                return name
        return self._made(wish, at, bodies, source)

    def _pair(self, wish: str, joint: _Joint, names: Iterable[str], bodies: set[str]) -> list[str]:
        """Two common points of bodies on the axis of a joint: the outermost of `names`, or else new ones."""
        near = self.size * NEAR
        offset = {name: self.points[name].at - joint.at for name in names}
        along = {name: float(off @ joint.axis) for name, off in offset.items()}
        on_axis = [n for n, off in offset.items() if np.linalg.norm(off - along[n] * joint.axis) <= near]
        ends = sorted(on_axis, key=along.__getitem__)
        pair = ends[:1] + [name for name in ends[-1:] if along[name] - along[ends[0]] > near]
        for name in pair:
            self.points[name].bodies |= bodies
        if not pair:
            pair = [self._made(wish, joint.at, bodies, f"joint {joint.name}")]
        if len(pair) < 2:
            end = self.points[pair[0]].at + ARM * self.size * joint.axis
            pair.append(self._made(f"{wish}_end", end, bodies, f"joint {joint.name}"))
        return pair

    def _of(self, body: str) -> list[str]:
        """The points of a body, first those of the hinge that carries it."""
        own = [name for name, point in self.points.items() if body in point.bodies]
        return [*dict.fromkeys((*self.first.get(body, ()), *own))]

    # Joints.

    def _hinge(self, joint: _Joint) -> None:
        ours = {joint.body, joint.parent}
        theirs = [name for name, point in self.points.items() if len(point.bodies & ours) == 1]
        self.first[joint.body] = self._pair(f"{joint.name}_axis", joint, theirs, ours)
        self.on_axes |= ours
        on = {} if joint.parent == CHASSIS else {"on": joint.parent}
        if joint.body != CHASSIS:
            self.inputs[joint.name] = {"angle": joint.body, **on, "from": "drawing"}

    def _connect(self, connect: int) -> None:
        name, (bodies, (first, second)) = self._name("equality", connect), self._joined(connect)
        apart = float(np.linalg.norm(second - first))
        if apart > NEAR * self.size:
            problem = f"joins positions that are {1e3 * apart:.4g} mm apart in the home pose"
            raise FileError(self.path, f"connect {name}", problem, "positions that coincide")
        ours = {self.bodies[body] for body in bodies}
        if len(ours) > 1:
            self._shared(name, first, ours, f"connect {name}")

    def _slide(self, joint: _Joint) -> None:
        body, parent, own, source = joint.body, joint.parent, self._of(joint.body), f"joint {joint.name}"
        is_point = len(own) == 1 and body not in self.on_axes
        only = [name for name in own if parent not in self.points[name].bodies]
        ends = own if is_point else self._pair(joint.name, joint, only, {body})
        start, step = self.points[ends[0]].at, ARM * self.size * joint.axis
        if not is_point and self.points[ends[0]].bodies & self.points[ends[1]].bodies - {body}:
            # These are points of a hinge on this line. They belong to both its bodies, so they do not show
            # which body may not rotate. A new point is made, two steps away, where no other has been made.
            ends[1] = self._made(f"{joint.name}_end", start - 2.0 * step, {body}, source)
        words = [word for word, way in DIRECTIONS.items() if np.array_equal(way, joint.axis)]
        # Along a direction the drawn travel is 0. A line through two points needs them at a distance.
        through = self._shared(f"{joint.name}_zero", start if words else start - step, {parent}, source)
        line = {"body": parent, "through": through, "along": words[0] if words else ends[-1]}
        name = self._named(f"{joint.name}_slide")
        self.on_axes |= {body, parent}
        if is_point:
            self.points[ends[0]].bodies -= {body}
        moves = {"point": ends[0], **line} if is_point else {"points": ends, **line, "turns": False}
        self.slides[name], self.inputs[joint.name] = moves, {"travel": name}

    # Tables.

    def _tables(self) -> dict[str, Any]:
        """The tables of a mechanism file."""
        bodies: dict[str, list[str]] = {CHASSIS: self._of(CHASSIS)}
        rods: dict[str, list[str]] = {}
        for body in dict.fromkeys(body for point in self.points.values() for body in sorted(point.bodies)):
            own = self._of(body)
            if len(own) == 2 and body not in {CHASSIS, *self.on_axes}:
                rods[body] = own
            elif len(own) > 1 and body != CHASSIS:
                bodies[body] = [*own, *self._beside(body, own)]
        roles, wheels = self._roles(bodies)
        inputs = self._inputs(wheels)
        return {"bodies": bodies, "rods": rods, "slides": self.slides, "inputs": inputs, "roles": roles}

    def _beside(self, body: str, own: list[str]) -> list[str]:
        """A further point of a body whose points are collinear; empty for other bodies."""
        arms = np.array([self.points[name].at - self.points[own[0]].at for name in own[1:]])
        axis = arms[np.argmax(np.linalg.norm(arms, axis=1))]
        axis = axis / np.linalg.norm(axis)
        if np.linalg.norm(np.cross(arms, axis), axis=1).max() > NEAR * self.size:
            return []
        at = self.points[own[0]].at + ARM * self.size * across(axis)[0]
        return [self._made(f"{body}_beside", at, {body}, f"body {body}, whose points are collinear")]

    def _inputs(self, wheels: Mapping[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        """Inputs: first joints with actuators, under the actuators' names; then wheels; then other joints."""
        others, driven, model = dict(self.inputs), dict[str, dict[str, Any]](), self.model
        on_joints = np.flatnonzero(model.actuator_trntype == self.mujoco.mjtTrn.mjTRN_JOINT).tolist()
        for actuator in on_joints:
            joint = self._name("joint", model.actuator_trnid[actuator, 0])
            if joint in self.inputs:
                driven[self._name("actuator", actuator)] = self.inputs[joint]
                others.pop(joint, None)
        ordered = {**driven, **wheels, **{name: one for name, one in others.items() if name not in driven}}
        return {_word(name): one for name, one in ordered.items()}

    def _roles(self, bodies: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, dict[str, Any]]]:
        """Roles and wheel travels from the texts of the model; a message for each text that gives none.

        Of several wheels no roles are read, but each wheel can be driven: a live axle is on no joint.
        """
        roles, wheels, several = dict[str, Any](), dict[str, dict[str, Any]](), list[str]()
        for text, content in self.texts.items():
            part, _, role = text.rpartition(".")
            words, count = [*map(_word, content.split())], 2 if role in PAIR_ROLES else 1
            kind, known = ("body", bodies) if role == "knuckle" else ("site", self.points)
            if role not in ROLES:
                continue
            if unknown := [word for word in words if word not in known]:
                self.facts.append(f"text {text} is ignored: no {kind} is called {short(unknown[0])}")
            elif len(words) != count:
                named = counted_as(len(words), "name")
                self.facts.append(f"text {text} is ignored: it has {named}; allowed: {count}")
            else:
                if role == "wheel_axis":
                    wheels[f"{part}.{TRAVEL}" if part else TRAVEL] = {"height": words[1]}
                if part:
                    several.append(text)
                else:
                    roles[role] = words if count == 2 else words[0]
        if several:
            names = ", ".join(several)
            self.facts.append(f"of several wheels only the travel is read, not the roles {names}")
        return roles, wheels


def _word(name: str) -> str:
    """A name of letters, digits and underscores."""
    return re.sub(r"\W+", "_", name).strip("_") or "unnamed"
