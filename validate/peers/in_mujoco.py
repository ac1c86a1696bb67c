"""A mechanism in MuJoCo.

MuJoCo's equality constraints are soft: its own solver lets them drift in proportion to their forces. But it
gives the Jacobian of each `connect`, `efc_J`, and the positions and rates of sites to rounding. Newton's
method and the equations of the rates need nothing else (see `program`). The model is built by `mjSpec` in
doubles, because an XML file has fewer digits.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from validate.arrays import Array
from validate.extras import needing
from validate.peers.program import Program
from validate.spanning_tree.tree import CHASSIS, Place, SpanningTree

with needing("mujoco"):
    import mujoco


KINDS = {
    "hinge": mujoco.mjtJoint.mjJNT_HINGE,
    "ball": mujoco.mjtJoint.mjJNT_BALL,
    "slide": mujoco.mjtJoint.mjJNT_SLIDE,
}


class InMujoco(Program):
    """A mechanism as a MuJoCo model, and MuJoCo's data of the pose that was computed last."""

    def __init__(self, tree: SpanningTree) -> None:
        names = [f"site {number}" for number in range(len(tree.sites))]
        self.model = model = spec_of(tree, dict(zip(names, tree.sites, strict=True))).compile()
        self.data = mujoco.MjData(model)
        self.sites = [model.site(name).id for name in names]
        super().__init__(tree, model.nv)

    def joint(self, body: str) -> tuple[int, int]:
        joint = self.model.joint(body)
        return joint.qposadr[0], joint.dofadr[0]

    @property
    def coordinates(self) -> Array:
        return np.array(self.data.qpos)

    def put(self, coordinates: Array) -> None:
        self.data.qpos[:] = coordinates

    def move(self, step: Array) -> None:
        mujoco.mj_integratePos(self.model, self.data.qpos, step, 1.0)

    def positions(self, which: slice) -> Array:
        mujoco.mj_kinematics(self.model, self.data)
        return np.asarray(self.data.site_xpos[self.sites[which]])

    def gap_jacobian(self) -> Array:
        model, data = self.model, self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeConstraint(model, data)
        return np.asarray(data.efc_J.reshape(data.nefc, model.nv))

    def set_rates(self, rates: Array, accelerations: Array) -> None:
        self.data.qvel[:], self.data.qacc[:] = rates, accelerations
        mujoco.mj_comVel(self.model, self.data)
        mujoco.mj_rnePostConstraint(self.model, self.data)

    def rates_of(self, which: slice, order: int) -> Array:
        of = (mujoco.mj_objectVelocity, mujoco.mj_objectAcceleration)[order - 1]
        sites = self.sites[which]
        found = np.empty((len(sites), 6))
        for site, row in zip(sites, found, strict=True):
            of(self.model, self.data, mujoco.mjtObj.mjOBJ_SITE, site, row, 0)
        # MuJoCo gives the angular part first.
        return found.reshape(-1, 2, 3)[:, ::-1]


def spec_of(tree: SpanningTree, sites: Mapping[str, Place]) -> mujoco.MjSpec:
    """The model: bodies of mass 1 (no rate depends on it), with sites, also at the ends of the loops."""
    spec = mujoco.MjSpec()
    spec.option.gravity = np.zeros(3)
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    bodies = {CHASSIS: spec.worldbody.add_body(name=CHASSIS)}
    for joint in tree.joints:
        turn, own = tree.frames[joint.parent][1], tree.frames[joint.body][1]
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, (turn.T @ own).ravel())
        bodies[joint.body] = body = bodies[joint.parent].add_body(
            name=joint.body,
            pos=tree.local(Place(joint.parent, joint.at)),
            quat=quaternion,
            mass=1.0,
            inertia=[1.0, 1.0, 1.0],
            explicitinertial=True,
            ipos=np.zeros(3),
        )
        body.add_joint(name=joint.body, type=KINDS[joint.kind], axis=own.T @ joint.axis)

    def site(name: str, at: Place) -> None:
        bodies[at.body].add_site(name=name, pos=tree.local(at))

    for name, at in sites.items():
        site(name, at)
    for number, loop in enumerate(tree.loops):
        names = [f"loop {number} {end}" for end in "ab"]
        for name, at in zip(names, (loop.first, loop.second), strict=True):
            site(name, at)
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=names[0],
            name2=names[1],
            active=True,
        )
    return spec
