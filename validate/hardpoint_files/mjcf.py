"""A MuJoCo model (MJCF), read by MuJoCo, in its home pose and in the scene's axes.

What changes no motion (geoms, masses, forces, contacts, sensors, pictures, ranges of joints) is passed over;
equalities other than connect and weld, and bodies moved from outside, are refused.
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

# A car has some thirty, and time grows with the third power.
MOST_BODIES = 100
# m and rad: a weld that is drawn apart by more is no weld as drawn; MuJoCo saves models with six digits.
APART = 1e-5
SOLREF = (0.02, 1.0)  # of an equality that says nothing of it
KINDS = ("free", "ball", "slide", "hinge")  # in the order of mjtJoint


@dataclass(frozen=True)
class Equality:
    """Two bodies, by number, that meet or are one.

    Attributes:
        places: where it is of either, (2, 3), m. sites: by number, those that say so.
    """

    name: str
    bodies: tuple[int, int]
    places: Array
    sites: tuple[int, ...] = ()


class HomePose:
    """A model in its home pose; bodies, joints and sites by MuJoCo's numbers, of which body 0 is the world.

    Attributes:
        to_scene: by what rows of the file's coordinates are multiplied, (3, 3).
        parents: of each body, its parent; of the world, itself.
        sites, site_bodies: where they are, (n, 3), m; the body of each.
        joints: those of each body to its parent, in their order; without one it is a piece of it.
        kinds, anchors, axes: of joints, where they are, m, and along or about which unit vector, (n, 3).
        connects, welds: what closes loops; bodies that are one.
        actuated: names of actuators by the joints that they drive. texts: of `custom`, by name.
    """

    def __init__(self, path: str, axes: Axes) -> None:
        """Read a model, with the files that it includes.

        Args:
            axes: where its x, y and z point.
        Raises:
            FileError: MuJoCo does not take it, or it has what changes its motion and is not known here.
            MissingLibrary: MuJoCo is not installed.
        """
        self.path, self.to_scene, self.mujoco = path, axes.matrix.T, needed("import", "mujoco", "peers")
        try:
            spec = self.mujoco.MjSpec.from_file(path)
            self.model = model = spec.compile()
            self.texts: dict[str, str] = {one.name: one.data for one in spec.texts}
        except ValueError as error:
            problem = f"is no model that MuJoCo takes ({' '.join(str(error).split())})"
            raise FileError(path, "", problem, "MJCF, as MuJoCo reads it") from None
        if model.nbody > MOST_BODIES:
            raise FileError(path, "", f"has {model.nbody - 1} bodies", f"fewer than {MOST_BODIES}")
        self.data = data = self.mujoco.MjData(model)
        self.mujoco.mj_kinematics(model, data)
        self.mujoco.mj_comPos(model, data)
        self.mujoco.mj_makeConstraint(model, data)
        if not (np.abs([*data.site_xpos.flat, *data.xanchor.flat]) <= float(FARTHEST)).all():
            problem = "has places that are farther off than any car"
            raise FileError(path, "", problem, f"at most {FARTHEST:g} m")
        for body in np.flatnonzero(model.body_mocapid >= 0).tolist():
            raise self._refuse("body", body, "is moved from outside (mocap)", "joints")
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
                raise self._refuse("equality", one, "is not known", "connect or weld")
        self.actuated: dict[str, str] = {
            self.name("joint", joint): self.name("actuator", one)
            for one, (joint, _) in enumerate(model.actuator_trnid)
            if model.actuator_trntype[one] == self.mujoco.mjtTrn.mjTRN_JOINT
        }

    def name(self, kind: str, number: int) -> str:
        """An element's name, or its kind and number."""
        return str(getattr(self.model, kind)(number).name) or f"{kind}_{number}"

    def ignored(self) -> Iterator[str]:
        """Tendons, and how softly an equality holds: forces, which no linkage has."""
        for one in range(self.model.ntendon):
            yield f"tendon {short(self.name('tendon', one))} is ignored"
        soft = self.model.eq_active0 & (self.model.eq_solref != SOLREF).any(axis=1)
        for one in np.flatnonzero(soft).tolist():
            yield f"solref of {short(self.name('equality', one))} is ignored: it is taken as rigid"

    def _refuse(self, kind: str, number: int, problem: str, allowed: str) -> FileError:
        return FileError(self.path, f"{kind} {short(self.name(kind, number))}", problem, allowed)

    def _equality(self, one: int) -> Equality:
        """What an equality joins, and where it holds either body."""
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
        """Refuse a weld that would move its bodies, or lets them turn."""
        data, equality = self.data, self.mujoco.mjtConstraint.mjCNSTR_EQUALITY
        apart = data.efc_pos[(data.efc_type == equality) & (data.efc_id == one)]
        if np.abs(apart).max(initial=0.0) > APART or not self.model.eq_data[one, 10] > 0.0:
            name = self.name("equality", one)
            problem = "does not hold its bodies as drawn"
            raise FileError(self.path, f"weld {short(name)}", problem, "one without relpose")
