"""A mechanism in MuJoCo.

MuJoCo's equality constraints are soft: its own solver lets them drift in proportion to their forces. But it
gives the residual of each `connect`, `efc_pos`, and its Jacobian, `efc_J`, to rounding. Newton's method and
the equations of the rates need nothing else (see `program`). The model is built by `mjSpec` in doubles,
because an XML file has fewer digits.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

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
        self.tree = tree
        self.model = model = spec_of(tree, tree.moving, tree.knuckles).compile()
        self.data = mujoco.MjData(model)
        self.as_drawn = self.coordinates
        self.sites = [model.site(name).id for name in tree.moving]
        self.turns = [model.site(f"body {body}").id for body in tree.knuckles]
        self.ends = [tuple(model.site(f"loop {k} {end}").id for end in "ab") for k in range(len(tree.loops))]
        driven = [model.joint(driven.body) for driven in tree.driven]
        self.driven_at = np.array([joint.qposadr[0] for joint in driven])
        self.driven = np.array([joint.dofadr[0] for joint in driven])
        # A rod may spin about its own axis, its body's z axis, without effect: that rate is fixed at 0.
        idle = [model.joint(rod).dofadr[0] + 2 for rod in tree.rods]
        self.unknown = np.array([i for i in range(model.nv) if i not in (*self.driven, *idle)], dtype=np.intp)

    @property
    def coordinates(self) -> Array:
        return np.array(self.data.qpos)

    def put(self, coordinates: Array) -> None:
        self.data.qpos[:] = coordinates

    def move(self, step: Array) -> None:
        mujoco.mj_integratePos(self.model, self.data.qpos, step, 1.0)

    def misses(self) -> tuple[Array, Array]:
        model, data = self.model, self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeConstraint(model, data)
        return data.efc_pos, data.efc_J.reshape(data.nefc, model.nv)

    def places(self) -> Array:
        mujoco.mj_kinematics(self.model, self.data)
        return np.asarray(self.data.site_xpos[self.sites])

    def apart(self, rates: Array, accelerations: Array) -> Array:
        self._move(rates, accelerations)
        parts = [self._acceleration(one)[3:] - self._acceleration(two)[3:] for one, two in self.ends]
        # There is no loop where each joint is driven.
        return np.concatenate([np.zeros(0), *parts])

    def moving(self, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        self._move(rates, accelerations)
        first, second = (
            [*(of(site)[3:] for site in self.sites), *(of(site)[:3] for site in self.turns)]
            for of in (self._velocity, self._acceleration)
        )
        return np.array(first), np.array(second)

    def _move(self, rates: Array, accelerations: Array) -> None:
        self.data.qvel[:], self.data.qacc[:] = rates, accelerations
        mujoco.mj_comVel(self.model, self.data)
        mujoco.mj_rnePostConstraint(self.model, self.data)

    def _velocity(self, site: int) -> Array:
        """Angular and linear velocity at a site, in the car's axes, (6,)."""
        result = np.empty(6)
        mujoco.mj_objectVelocity(self.model, self.data, mujoco.mjtObj.mjOBJ_SITE, site, result, 0)
        return result

    def _acceleration(self, site: int) -> Array:
        """Angular and linear acceleration at a site, in the car's axes, (6,)."""
        result = np.empty(6)
        mujoco.mj_objectAcceleration(self.model, self.data, mujoco.mjtObj.mjOBJ_SITE, site, result, 0)
        return result


def spec_of(tree: SpanningTree, points: Mapping[str, Place], reported: Iterable[str]) -> mujoco.MjSpec:
    """The model: bodies of mass 1 (no rate depends on it), with sites for points, the frames of the reported
    bodies, and the ends of loops.
    """
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

    for name, at in points.items():
        site(name, at)
    for body in reported:
        site(f"body {body}", Place(body, tree.frames[body][0]))
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
