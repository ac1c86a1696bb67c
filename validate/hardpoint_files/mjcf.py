"""A MuJoCo model (MJCF), read by MuJoCo: its bodies, joints, sites, connects and welds in the home pose.

Everything is placed in the scene's axes. What changes no motion (geoms, masses, forces, contacts, sensors,
pictures, ranges of joints) is passed over; other equalities and bodies moved from outside are refused.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.extras import needed
from validate.hardpoint_files.contents import FARTHEST, short
from validate.tables.errors import FileError

Array = NDArray[np.float64]

WORLD = "world"
# A car has some thirty, and time grows with the third power.
MOST_BODIES = 100
# m and rad: a weld that is drawn apart by more is no weld as drawn; MuJoCo saves models with six digits.
APART = 1e-5
SOLREF = (0.02, 1.0)  # of an equality that says nothing of it
KINDS = ("free", "ball", "slide", "hinge")  # in the order of mjtJoint


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
        ignored: what the model says beside, in words.
    """

    bodies: Mapping[str, MjcfBody]
    sites: Mapping[str, tuple[str, Array]]
    connects: tuple[Connect, ...]
    welds: tuple[tuple[str, str], ...]
    actuated: Mapping[str, str]
    texts: Mapping[str, str]
    ignored: tuple[str, ...] = ()


def read_mjcf(path: str, axes: Array) -> Mjcf:
    """Read a model, with the files that it includes.

    Args:
        axes: the scene's coordinates from the file's, (3, 3).
    Raises:
        FileError: MuJoCo does not take it, or it has what changes its motion and is not known here.
        MissingLibrary: MuJoCo is not installed.
    """
    mujoco = needed("import", "mujoco", "peers")
    try:
        spec = mujoco.MjSpec.from_file(path)
        model, texts = spec.compile(), {one.name: one.data for one in spec.texts}
    except ValueError as error:
        problem = f"is no model that MuJoCo takes ({' '.join(str(error).split())})"
        raise FileError(path, "", problem, "MJCF, as MuJoCo reads it") from None
    if model.nbody > MOST_BODIES:
        raise FileError(path, "", f"has {model.nbody - 1} bodies", f"fewer than {MOST_BODIES}")
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_makeConstraint(model, data)
    if not (np.abs([*data.site_xpos.flat, *data.xanchor.flat]) <= float(FARTHEST)).all():
        raise FileError(path, "", "has places that are farther off than any car", f"at most {FARTHEST:g} m")
    return _Reader(mujoco, path, model, data, axes).read(texts)


@dataclass(frozen=True)
class _Reader:
    """A compiled model with its home pose."""

    mujoco: Any
    path: str
    model: Any
    data: Any
    axes: Array

    def refuse(self, what: str, name: str, problem: str, allowed: str) -> FileError:
        return FileError(self.path, f"{what} {short(name)}", problem, allowed)

    def name(self, kind: str, number: int) -> str:
        """An element's name, or its kind and number."""
        own = self.mujoco.mj_id2name(self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind.upper()}"), number)
        return own or f"{kind}_{number}"

    def read(self, texts: Mapping[str, str]) -> Mjcf:
        model = self.model
        for one in range(1, model.nbody):
            if model.body_mocapid[one] >= 0:
                raise self.refuse("body", self.name("body", one), "is moved from outside (mocap)", "joints")
        sites = {
            self.name("site", one): (self.name("body", model.site_bodyid[one]), self._turned(place))
            for one, place in enumerate(self.data.site_xpos)
        }
        connects, welds = [], []
        for one, active in enumerate(model.eq_active0):
            if not active:
                continue
            if model.eq_type[one] == self.mujoco.mjtEq.mjEQ_CONNECT:
                connects.append(self._connect(one))
            elif model.eq_type[one] == self.mujoco.mjtEq.mjEQ_WELD:
                self._require_as_drawn(one)
                welds.append(self._connect(one).bodies)
            else:
                raise self.refuse("equality", self.name("equality", one), "is not known", "connect or weld")
        joints = [self._joint(one) for one in range(model.njnt)]
        bodies_of = [
            MjcfBody(
                self.name("body", one),
                self.name("body", model.body_parentid[one]),
                tuple(joint for joint, of in zip(joints, model.jnt_bodyid, strict=True) if of == one),
            )
            for one in range(1, model.nbody)
        ]
        actuated = {
            joints[model.actuator_trnid[one, 0]].name: self.name("actuator", one)
            for one in range(model.nu)
            if model.actuator_trntype[one] == self.mujoco.mjtTrn.mjTRN_JOINT
        }
        by_name = {body.name: body for body in bodies_of}
        return Mjcf(by_name, sites, tuple(connects), tuple(welds), actuated, texts, self._ignored())

    def _ignored(self) -> tuple[str, ...]:
        """Tendons, and how softly an equality holds: forces, which no linkage has."""
        model = self.model
        found = [f"tendon {short(self.name('tendon', one))} is ignored" for one in range(model.ntendon)]
        soft = model.eq_active0 & (model.eq_solref != SOLREF).any(axis=1)
        for one in np.flatnonzero(soft).tolist():
            found.append(f"solref of {short(self.name('equality', one))} is ignored: it is taken as rigid")
        return tuple(found)

    def _turned(self, vector: Array) -> Array:
        return np.asarray(self.axes @ vector)

    def _joint(self, one: int) -> MjcfJoint:
        kind = KINDS[self.model.jnt_type[one]]
        axis = self._turned(self.data.xaxis[one]) if kind in ("hinge", "slide") else np.zeros(3)
        return MjcfJoint(self.name("joint", one), kind, self._turned(self.data.xanchor[one]), axis)

    def _connect(self, one: int) -> Connect:
        """What an equality joins, and where it holds either body."""
        model, data, name = self.model, self.data, self.name("equality", one)
        ends = int(model.eq_obj1id[one]), int(model.eq_obj2id[one])
        if model.eq_objtype[one] == self.mujoco.mjtObj.mjOBJ_SITE:
            sites = [self.name("site", end) for end in ends]
            bodies = [model.site_bodyid[end] for end in ends]
            here, there = (self._turned(data.site_xpos[end]) for end in ends)
            name = sites[0] if name.startswith("equality_") else name
        else:
            sites, bodies, anchors = [], [*ends], model.eq_data[one, :6].reshape(2, 3)
            here, there = (
                self._turned(data.xpos[end] + data.xmat[end].reshape(3, 3) @ anchor)
                for end, anchor in zip(ends, anchors, strict=True)
            )
        first, second = (self.name("body", body) for body in bodies)
        return Connect(name, (first, second), (here, there), tuple(sites))

    def _require_as_drawn(self, one: int) -> None:
        """Refuse a weld that would move its bodies, or lets them turn."""
        data, equality = self.data, self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        apart = data.efc_pos[(data.efc_type == equality) & (data.efc_id == one)]
        if np.abs(apart).max(initial=0.0) > APART or not self.model.eq_data[one, 10] > 0.0:
            name = self.name("equality", one)
            raise self.refuse("weld", name, "does not hold its bodies as drawn", "one without relpose")
