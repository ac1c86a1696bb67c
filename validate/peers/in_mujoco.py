"""A suspension in MuJoCo, with Newton's method of our own on its constraints.

MuJoCo's equality constraints are soft: its own solver lets them drift by what its forces need. But it gives
what each `connect` misses, `efc_pos`, and the Jacobian of that, `efc_J`, to rounding, and that is all that
Newton's method and the equations of the rates need:

    J_u dq = -efc_pos,    J_u v_u = -J_d v_d,    J_u a_u = -J_d a_d - (dJ/dt) v

u unknown and d driven joints. The last term is how the two sides of a loop accelerate apart when no joint
accelerates, which MuJoCo computes by its recursion over the bodies. The model is built by `mjSpec` in
doubles: an XML file is written with fewer digits.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from validate.peers.linkage import CHASSIS, DRIVEN, KNUCKLE, TIE_ROD, Linkage, PeerError
from validate.peers.motion import Poses, Rates

Array = NDArray[np.float64]

# Newton's method doubles its digits: six steps lead from half a digit to all, and twice that leaves room.
LIMIT = 12
# rad and car sizes: a first step that is longer may lead to another assembly, and the way is halved.
LONGEST_STEP = 0.25
HALVINGS = 12
# Below the root of the rounding unit a step that does not halve is rounding.
ROUNDING_STEP = 1e-8
KINDS = {
    "hinge": mujoco.mjtJoint.mjJNT_HINGE,
    "ball": mujoco.mjtJoint.mjJNT_BALL,
    "slide": mujoco.mjtJoint.mjJNT_SLIDE,
}


class InMujoco:
    """A linkage as a MuJoCo model; it keeps MuJoCo's data of the pose that was computed last."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self.model = _model(linkage)
        self.data = mujoco.MjData(self.model)
        model = self.model
        self.sites = {name: model.site(name).id for name in linkage.points}
        self.ends = [
            (model.site(loop.name + " a").id, model.site(loop.name + " b").id) for loop in linkage.loops
        ]
        self.knuckle = model.body(KNUCKLE).id
        driven = [model.joint(body) for body in DRIVEN]
        self.driven_places = np.array([joint.qposadr[0] for joint in driven])
        self.driven = np.array([joint.dofadr[0] for joint in driven])
        # The tie rod may turn about itself, its body's z axis, which changes nothing: that rate is held at 0.
        idle = model.joint(TIE_ROD).dofadr[0] + 2
        self.unknown = np.array([dof for dof in range(model.nv) if dof not in (*self.driven, idle)])
        self._residuals = self._steps = 0

    def closed(self, tolerance: float) -> Poses:
        """The drawing, closed at its own inputs: one pose.

        Args:
            tolerance: Newton's method ends with a correction of all joints below it, rad and car sizes.
        Raises:
            PeerError: it cannot be closed, or only as another assembly.
        """
        mujoco.mj_resetData(self.model, self.data)
        for joint in self.linkage.joints:
            if joint.kind == "slide":
                self.data.joint(joint.child).qpos[0] = joint.drawn
        self._residuals = self._steps = 0
        driven = self.linkage.drawn_inputs
        step = self._newton(driven, tolerance, shorten=True)
        if step is None:
            raise PeerError("the drawing cannot be closed")
        places = self.data.site_xpos[None, list(self.sites.values())]
        poses = self._solved(driven[None], self.data.qpos[None].copy(), places, np.array([step]))
        if self.linkage.on_other_side(self.linkage.with_chassis(poses.places)).any():
            raise PeerError("closing the drawing leads to another assembly than is drawn")
        return poses

    def poses(self, driven: Array, tolerance: float, start: Poses) -> Poses:
        """Solve at driven inputs, each pose from the one before.

        Args:
            driven: turn of the arm and travel of the rack, (N, 2).
            tolerance: see `closed`.
            start: whose last pose the first one is solved from.
        Raises:
            PeerError: a pose is not reached, or is one of another assembly.
        """
        data, count = self.data, len(driven)
        self._residuals = self._steps = 0
        coordinates = np.empty((count, self.model.nq))
        places = np.empty((count, len(self.sites), 3))
        steps = np.empty(count)
        sites = list(self.sites.values())
        here, data.qpos[:] = start.driven[-1], start.coordinates[-1]
        for i in range(count):
            step = self._go(here, driven[i], tolerance)
            if step is None:
                raise PeerError("no pose is reached from the one before", i)
            here, steps[i] = driven[i], step
            coordinates[i] = data.qpos
            places[i] = data.site_xpos[sites]
        poses = self._solved(driven, coordinates, places, steps)
        other = self.linkage.on_other_side(self.linkage.with_chassis(poses.places))
        if other.any():
            raise PeerError("Newton's method came to another assembly than is drawn", int(np.argmax(other)))
        return poses

    def _solved(self, driven: Array, coordinates: Array, places: Array, steps: Array) -> Poses:
        counts = {
            "newton_steps": self._steps,
            "factorisations": self._steps,
            "jacobians": self._residuals,
            "residuals": self._residuals,
        }
        named = {name: places[:, k] for k, name in enumerate(self.sites)}
        return Poses(driven, coordinates, named, steps, counts)

    def rates(self, poses: Poses, rate: Array, bend: Array) -> Rates:
        """Velocities and accelerations of poses.

        Args:
            rate, bend: first and second time derivative of what is driven, (N, 2), per s and s^2.
        Raises:
            PeerError: the rates are not determined at a pose.
        """
        model, data, count = self.model, self.data, len(rate)
        names = list(self.sites)
        # Of each moving point and at last of the knuckle's turning, 3 each.
        first, second = (np.empty((count, len(names) + 1, 3)) for _ in range(2))
        for i in range(count):
            data.qpos[:] = poses.coordinates[i]
            jacobian = self._jacobian()
            try:
                inverse = np.linalg.inv(jacobian[:, self.unknown])
            except np.linalg.LinAlgError:
                raise PeerError("the pose is where two assemblies meet", i) from None
            lever = inverse @ jacobian[:, self.driven]
            data.qvel[:] = 0.0
            data.qvel[self.driven] = rate[i]
            data.qvel[self.unknown] = -lever @ rate[i]
            mujoco.mj_comVel(model, data)
            data.qacc[:] = 0.0
            data.qacc[self.driven] = bend[i]
            data.qacc[self.unknown] = -inverse @ self._apart()
            mujoco.mj_rnePostConstraint(model, data)
            for k, site in enumerate(self.sites.values()):
                first[i, k] = _velocity(model, data, site)[3:]
                second[i, k] = _acceleration(model, data, site)[3:]
            wheel = self.sites["wheel_centre"]
            first[i, -1] = _velocity(model, data, wheel)[:3]
            second[i, -1] = _acceleration(model, data, wheel)[:3]
        velocity, acceleration = (
            {name: array[:, k] for k, name in enumerate(names)} for array in (first, second)
        )
        return Rates(velocity, acceleration, first[:, -1], second[:, -1])

    def _apart(self) -> Array:
        """How the two sides of each loop accelerate apart with the joints' accelerations as they are."""
        model, data = self.model, self.data
        mujoco.mj_rnePostConstraint(model, data)
        parts = [
            _acceleration(model, data, one)[3:] - _acceleration(model, data, two)[3:]
            for one, two in self.ends
        ]
        return np.concatenate(parts)

    def _go(self, start: Array, goal: Array, tolerance: float) -> float | None:
        """Follow the inputs to a goal, by halves where Newton's method would step too far; its last step."""
        data = self.data
        done, share = 0.0, 1.0
        step = None
        while done < 1.0:
            kept = data.qpos.copy()
            share = min(share, 1.0 - done)
            step = self._newton(
                start + (done + share) * (goal - start) if done + share < 1.0 else goal, tolerance
            )
            if step is None:
                data.qpos[:] = kept
                share *= 0.5
                if share < 0.5**HALVINGS:
                    return None
            else:
                done += share
        return step

    def _newton(self, driven: Array, tolerance: float, shorten: bool = False) -> float | None:
        """Close the loops at driven inputs, and place all bodies; the last step, None if it fails.

        Args:
            shorten: whether a step that is too long is shortened, or fails.
        """
        model, data, unknown = self.model, self.data, self.unknown
        data.qpos[self.driven_places] = driven
        step, previous = np.zeros(model.nv), np.inf
        for _ in range(LIMIT):
            jacobian = self._jacobian()
            try:
                step[unknown] = np.linalg.solve(jacobian[:, unknown], -data.efc_pos)
            except np.linalg.LinAlgError:
                return None
            size = float(np.abs(step).max())
            if not size <= LONGEST_STEP:
                if not (shorten and np.isfinite(size)):
                    return None
                step *= LONGEST_STEP / size
            mujoco.mj_integratePos(model, data.qpos, step, 1.0)
            self._steps += 1
            if size <= tolerance or (size < ROUNDING_STEP and size >= 0.5 * previous):
                mujoco.mj_kinematics(model, data)
                return size
            previous = size
        return None

    def _jacobian(self) -> Array:
        """Place all bodies; the Jacobian of what the loops miss, by all joints' rates."""
        model, data = self.model, self.data
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_makeConstraint(model, data)
        self._residuals += 1
        return np.asarray(data.efc_J).reshape(data.nefc, model.nv)


def _velocity(model: mujoco.MjModel, data: mujoco.MjData, site: int) -> Array:
    """Angular and linear velocity at a site, in the car's axes, (6,)."""
    result = np.empty(6)
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_SITE, site, result, 0)
    return result


def _acceleration(model: mujoco.MjModel, data: mujoco.MjData, site: int) -> Array:
    """Angular and linear acceleration at a site, likewise."""
    result = np.empty(6)
    mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_SITE, site, result, 0)
    return result


def _model(linkage: Linkage) -> mujoco.MjModel:
    """Bodies of mass 1, on which no rate depends; sites for points and for the ends of loops."""
    spec = mujoco.MjSpec()
    spec.option.gravity = np.zeros(3)
    spec.option.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    bodies = {CHASSIS: spec.worldbody}
    # The frame of each body: where its origin is in drawn coordinates, and how it is turned.
    frames = {CHASSIS: (np.zeros(3), np.eye(3))}
    for joint in linkage.joints:
        place, turn = frames[joint.parent]
        own = _turned_along(joint.axis) if joint.child == TIE_ROD else np.eye(3)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, own.ravel())
        bodies[joint.child] = body = bodies[joint.parent].add_body(
            name=joint.child,
            pos=turn.T @ (joint.on_parent - place),
            quat=quaternion,
            mass=1.0,
            inertia=[1.0, 1.0, 1.0],
            explicitinertial=True,
        )
        body.add_joint(name=joint.child, type=KINDS[joint.kind], axis=own.T @ joint.axis)
        frames[joint.child] = (joint.on_child, own)

    def site(name: str, body: str, at: Array) -> None:
        place, turn = frames[body]
        bodies[body].add_site(name=name, pos=turn.T @ (at - place))

    for name, (body_name, at) in linkage.points.items():
        site(name, body_name, at)
    for loop in linkage.loops:
        ends: Sequence[tuple[str, str, Array]] = (
            (loop.name + " a", loop.body, loop.place),
            (loop.name + " b", loop.other, loop.other_place),
        )
        for end in ends:
            site(*end)
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_CONNECT,
            objtype=mujoco.mjtObj.mjOBJ_SITE,
            name1=ends[0][0],
            name2=ends[1][0],
            active=True,
        )
    return spec.compile()


def _turned_along(axis: Array) -> Array:
    """Axes as columns, of which the third lies along a unit vector."""
    other = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(other, axis)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first), axis], axis=-1)
