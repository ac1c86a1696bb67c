"""Reads a MuJoCo model (MJCF) with MuJoCo, in its home pose and in the scene's axes.

Elements that do not change the kinematics (geoms, masses, forces, contacts, sensors, pictures, ranges of
joints) are ignored. Equalities other than connect and weld, and mocap bodies, are refused.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.extras import needed
from validate.hardpoint_files.axes import Axes
from validate.hardpoint_files.contents import FARTHEST, short
from validate.tables.errors import FileError

Array = NDArray[np.float64]

# A car has some thirty bodies, and the time grows with the third power of their number.
MOST_BODIES = 100
# Largest distance, m, and angle, rad, of a weld in the home pose; MuJoCo saves models with six digits.
APART = 1e-5
SOLREF = (0.02, 1.0)  # the default of an equality
KINDS = ("free", "ball", "slide", "hinge")  # in the order of mjtJoint


@dataclass(frozen=True)
class Equality:
    """A connect or a weld between two bodies, which are given by number.

    Attributes:
        places: the position of the joint on each body, (2, 3), m.
        sites: numbers of the sites that define it, if any.
    """

    name: str
    bodies: tuple[int, int]
    places: Array
    sites: tuple[int, ...] = ()


class HomePose:
    """A model in its home pose. Bodies, joints and sites have MuJoCo's numbers; body 0 is the world.

    Attributes:
        to_scene: matrix that multiplies rows of the file's coordinates, (3, 3).
        parents: the parent of each body; the world is its own parent.
        sites, site_bodies: positions of the sites, (n, 3), m; the body of each site.
        joints: the joints of each body to its parent, in order; a body without a joint is fixed to its
            parent.
        kinds, anchors, axes: kinds of the joints, positions, (n, 3), m, and unit vectors of the axes, (n, 3).
        connects, welds: connects, which close loops; welds, which fix two bodies to each other.
        actuated: names of actuators by names of the joints that they drive.
        texts: texts of `custom`, by name.
    """

    def __init__(self, path: str, axes: Axes) -> None:
        """Read a model, with the files that it includes.

        Args:
            axes: directions of its x, y and z.
        Raises:
            FileError: MuJoCo refuses the model, or the model has an element that is not supported.
            MissingLibrary: MuJoCo is not installed.
        """
        self.path, self.to_scene, self.mujoco = path, axes.matrix.T, needed("import", "mujoco", "peers")
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
        self.parents: list[int] = model.body_parentid.tolist()
        first, count = model.body_jntadr, model.body_jntnum
        self.joints = [range(*ends) for ends in zip(first, first + count, strict=True)]
        self.kinds = [KINDS[kind] for kind in model.jnt_type]
        self.site_bodies: list[int] = model.site_bodyid.tolist()
        self.sites, self.anchors, self.axes = (
            places @ self.to_scene for places in (data.site_xpos, data.xanchor, data.xaxis)
        )
        self.connects: list[Equality] = []
        self.welds: list[Equality] = []
        for one in np.flatnonzero(model.eq_active0).tolist():
            if model.eq_type[one] == self.mujoco.mjtEq.mjEQ_CONNECT:
                self.connects.append(self._equality(one))
            elif model.eq_type[one] == self.mujoco.mjtEq.mjEQ_WELD:
                self._require_as_drawn(one)
                self.welds.append(self._equality(one))
            else:
                raise self._refuse("equality", one, "is of a kind that is not supported", "connect or weld")
        self.actuated: dict[str, str] = {
            self.name("joint", joint): self.name("actuator", one)
            for one, (joint, _) in enumerate(model.actuator_trnid)
            if model.actuator_trntype[one] == self.mujoco.mjtTrn.mjTRN_JOINT
        }

    def name(self, kind: str, number: int) -> str:
        """The name of an element, or its kind and number if it has none."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}_{number}"

    def ignored(self) -> Iterator[str]:
        """Messages on ignored tendons and on soft equalities, which are taken as rigid."""
        for one in range(self.model.ntendon):
            yield f"tendon {short(self.name('tendon', one))} is ignored"
        soft = self.model.eq_active0 & (self.model.eq_solref != SOLREF).any(axis=1)
        for one in np.flatnonzero(soft).tolist():
            yield f"solref of {short(self.name('equality', one))} is ignored: it is taken as rigid"

    def _refuse(self, kind: str, number: int, problem: str, allowed: str) -> FileError:
        return FileError(self.path, f"{kind} {short(self.name(kind, number))}", problem, allowed)

    def _equality(self, one: int) -> Equality:
        """The bodies that an equality joins, and its position on each."""
        model, data, name = self.model, self.data, self.name("equality", one)
        ends = int(model.eq_obj1id[one]), int(model.eq_obj2id[one])
        if model.eq_objtype[one] == self.mujoco.mjtObj.mjOBJ_SITE:
            first, second = (self.site_bodies[end] for end in ends)
            name = self.name("site", ends[0]) if name.startswith("equality_") else name
            return Equality(name, (first, second), self.sites[[*ends]], ends)
        anchors = model.eq_data[one, :6].reshape(2, 3)
        places = [
            data.xpos[end] + data.xmat[end].reshape(3, 3) @ anchor
            for end, anchor in zip(ends, anchors, strict=True)
        ]
        return Equality(name, ends, places @ self.to_scene)

    def _require_as_drawn(self, one: int) -> None:
        """Refuse a weld that would move its bodies from the home pose, or that leaves rotations free."""
        data, equality = self.data, self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        apart = data.efc_pos[(data.efc_type == equality) & (data.efc_id == one)]
        if np.abs(apart).max(initial=0.0) > APART or not self.model.eq_data[one, 10] > 0.0:
            name = self.name("equality", one)
            problem = "does not hold its bodies as drawn"
            raise FileError(self.path, f"weld {short(name)}", problem, "one without relpose")
