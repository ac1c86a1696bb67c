"""A mechanism in Pinocchio, by its joints' coordinates: the relative-coordinate model.

Pinocchio places the joints, gives their columns (`data.J`, about the origin of the car) and carries rates and
accelerations along the tree; the loops are differences of what it says of points.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from validate.extras import MissingPackage
from validate.peers.linkage import Linkage
from validate.peers.program import Program
from validate.spanning_tree.cut import CHASSIS, Joint, Place

try:
    import pinocchio
except ModuleNotFoundError as error:
    raise MissingPackage("relative", error) from None

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Points:
    """Points of bodies, taken together: numbers of the bodies' joints, (P,), and where they are, (P, 3)."""

    body: NDArray[np.intp]
    at: Array


class InPinocchio(Program):
    """A linkage as Pinocchio's model, and its data of the pose that was computed last."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = linkage
        self.model = model = pinocchio.Model()
        self.number = {CHASSIS: 0}
        for joint in linkage.tree.joints:
            turn, own = linkage.frames[joint.parent][1], linkage.frames[joint.body][1]
            placed = pinocchio.SE3(turn.T @ own, linkage.local(Place(joint.parent, joint.at)))
            parent = self.number[joint.parent]
            self.number[joint.body] = model.addJoint(parent, _kind(joint, own), placed, joint.body)
        self.data = model.createData()
        self.as_drawn = np.array(pinocchio.neutral(model))
        self.q, self.v = self.as_drawn, np.zeros(model.nv)
        joints = [model.joints[self.number[driven.body]] for driven in linkage.tree.driven]
        self.driven_at = np.array([joint.idx_q for joint in joints])
        self.driven = np.array([joint.idx_v for joint in joints])
        # A rod may turn about itself, its body's z axis, which changes nothing: that rate is held at 0.
        idle = [model.joints[self.number[rod]].idx_v + 2 for rod in linkage.tree.rods]
        self.unknown = np.array([i for i in range(model.nv) if i not in (*self.driven, *idle)], dtype=np.intp)
        self.moves = np.zeros((model.njoints, model.nv, 1))
        for number in range(1, model.njoints):
            joint = model.joints[number]
            self.moves[number] = self.moves[model.parents[number]]
            self.moves[number, joint.idx_v : joint.idx_v + joint.nv] = 1.0
        self.points = self._together(linkage.points.values())
        self.sides = [self._together(loop.first for loop in linkage.tree.loops)]
        self.sides.append(self._together(loop.second for loop in linkage.tree.loops))
        self.turns = [self.number[body] for body in linkage.bodies.values()]

    @property
    def coordinates(self) -> Array:
        """Angles, travels and quaternions."""
        return self.q.copy()

    def put(self, coordinates: Array) -> None:
        """Set all joints."""
        self.q = np.array(coordinates)

    def move(self, step: Array) -> None:
        """Move all joints."""
        self.q = pinocchio.normalize(self.model, pinocchio.integrate(self.model, self.q, step))

    def misses(self) -> tuple[Array, Array]:
        """What the loops miss, and its Jacobian."""
        pinocchio.computeJointJacobians(self.model, self.data, self.q)
        linear, angular = self.data.J[:3].T, self.data.J[3:].T
        places, moved = [], []
        for side in self.sides:
            places.append(place := self._placed(side))
            moved.append((linear + np.cross(angular, place[:, None])) * self.moves[side.body])
        jacobian = np.swapaxes(moved[0] - moved[1], 1, 2).reshape(-1, self.model.nv)
        return (places[0] - places[1]).reshape(-1), jacobian

    def places(self) -> Array:
        """Where the points are."""
        pinocchio.forwardKinematics(self.model, self.data, self.q)
        return self._placed(self.points)

    def set_rates(self, rates: Array) -> None:
        """Set the joints' rates."""
        self.v = np.array(rates)

    def apart(self, accelerations: Array) -> Array:
        """How the sides of the loops accelerate apart."""
        states = self._states(accelerations)
        first, second = (self._rates(side, *states)[1] for side in self.sides)
        return np.asarray((first - second).reshape(-1))

    def moving(self, accelerations: Array) -> tuple[Array, Array]:
        """Rates and accelerations of the points and of the reported bodies' turns."""
        states = self._states(accelerations)
        rates = self._rates(self.points, *states)
        first, second = (
            np.concatenate([rates[k], states[k][self.turns, 3:].reshape(-1, 3)]) for k in range(2)
        )
        return first, second

    def _together(self, places: Iterable[Place]) -> Points:
        found = list(places)
        bodies = np.array([self.number[place.body] for place in found], dtype=np.intp)
        return Points(bodies, np.reshape([self.linkage.local(place) for place in found], (-1, 3)))

    def _arms(self, points: Points) -> Array:
        """From their bodies' joints to points, in the car's axes, (P, 3)."""
        turns = np.array([placed.rotation for placed in self.data.oMi])
        return np.asarray((turns[points.body] @ points.at[..., None])[..., 0])

    def _placed(self, points: Points) -> Array:
        starts = np.array([placed.translation for placed in self.data.oMi])
        return np.asarray(starts[points.body] + self._arms(points))

    def _states(self, accelerations: Array) -> tuple[Array, Array]:
        """Rates of all joints' frames in the car's axes, linear and angular, (joints, 6), and theirs."""
        model, data, frame = self.model, self.data, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
        pinocchio.forwardKinematics(model, data, self.q, self.v, accelerations)
        velocity, acceleration = np.zeros((model.njoints, 6)), np.zeros((model.njoints, 6))
        for i in range(1, model.njoints):
            velocity[i] = pinocchio.getVelocity(model, data, i, frame).vector
            acceleration[i] = pinocchio.getClassicalAcceleration(model, data, i, frame).vector
        return velocity, acceleration

    def _rates(self, points: Points, velocity: Array, acceleration: Array) -> tuple[Array, Array]:
        """Velocities and accelerations of points, (P, 3) each."""
        arms, v, a = self._arms(points), velocity[points.body], acceleration[points.body]
        turned = np.cross(v[:, 3:], arms)
        return v[:, :3] + turned, a[:, :3] + np.cross(a[:, 3:], arms) + np.cross(v[:, 3:], turned)


def _kind(joint: Joint, own: Array) -> object:
    """Pinocchio's joint, its axis in the axes of its own body."""
    if joint.kind == "ball":
        return pinocchio.JointModelSpherical()
    axis = own.T @ joint.axis
    if joint.kind == "hinge":
        return pinocchio.JointModelRevoluteUnaligned(axis)
    return pinocchio.JointModelPrismaticUnaligned(axis)
