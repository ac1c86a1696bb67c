"""A mechanism in Pinocchio, by the coordinates of its joints: the relative-coordinate model.

Points are frames of the model: Pinocchio gives their positions, Jacobians, rates and accelerations. The
residuals of the loops are differences of positions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.extras import needing
from validate.peers.program import Program
from validate.spanning_tree.tree import CHASSIS, Joint, Place, SpanningTree

with needing("relative"):
    import pinocchio


CAR = pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED  # rates of the place itself, in the car's axes


class InPinocchio(Program):
    """A mechanism as Pinocchio's model, and its data of the pose that was computed last."""

    def __init__(self, tree: SpanningTree) -> None:
        self.tree = tree
        self.model = model = pinocchio.Model()
        self.number = {CHASSIS: 0}
        for joint in tree.joints:
            turn, own = tree.frames[joint.parent][1], tree.frames[joint.body][1]
            placed = pinocchio.SE3(turn.T @ own, tree.local(Place(joint.parent, joint.at)))
            parent = self.number[joint.parent]
            self.number[joint.body] = model.addJoint(parent, _kind(joint, own), placed, joint.body)
        self.as_drawn = np.array(pinocchio.neutral(model))
        self.q = self.as_drawn
        joints = [model.joints[self.number[driven.body]] for driven in tree.driven]
        self.driven_at = np.array([joint.idx_q for joint in joints])
        self.driven = np.array([joint.idx_v for joint in joints])
        # A rod may spin about its own axis, its body's z axis, without effect: that rate is fixed at 0.
        idle = [model.joints[self.number[rod]].idx_v + 2 for rod in tree.rods]
        self.unknown = np.array([i for i in range(model.nv) if i not in (*self.driven, *idle)], dtype=np.intp)
        self.points = self._frames(tree.moving.values())
        self.bodies = self._frames(Place(body, tree.frames[body][0]) for body in tree.knuckles)
        self.sides = [
            self._frames(loop.first for loop in tree.loops),
            self._frames(loop.second for loop in tree.loops),
        ]
        self.data = model.createData()

    @property
    def coordinates(self) -> Array:
        return self.q.copy()

    def put(self, coordinates: Array) -> None:
        self.q = np.array(coordinates)

    def move(self, step: Array) -> None:
        self.q = pinocchio.normalize(self.model, pinocchio.integrate(self.model, self.q, step))

    def misses(self) -> tuple[Array, Array]:
        pinocchio.computeJointJacobians(self.model, self.data, self.q)
        pinocchio.updateFramePlacements(self.model, self.data)
        first, second = (
            (self._placed(side), np.reshape([self._jacobian(frame) for frame in side], (-1, self.model.nv)))
            for side in self.sides
        )
        return (first[0] - second[0]).reshape(-1), first[1] - second[1]

    def places(self) -> Array:
        pinocchio.framesForwardKinematics(self.model, self.data, self.q)
        return self._placed(self.points)

    def apart(self, rates: Array, accelerations: Array) -> Array:
        pinocchio.forwardKinematics(self.model, self.data, self.q, rates, accelerations)
        first, second = (np.reshape([self._rates(f)[1].linear for f in side], (-1, 3)) for side in self.sides)
        return np.asarray((first - second).reshape(-1))

    def moving(self, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        pinocchio.forwardKinematics(self.model, self.data, self.q, rates, accelerations)
        moved, turned = ([self._rates(frame) for frame in of] for of in (self.points, self.bodies))
        first, second = (
            np.array([*(one[order].linear for one in moved), *(one[order].angular for one in turned)])
            for order in range(2)
        )
        return first, second

    def _frames(self, places: Iterable[Place]) -> list[int]:
        """Places of bodies as frames of the model, by their numbers."""
        found = []
        for place in places:
            at = pinocchio.SE3(np.eye(3), self.tree.local(place))
            name, kind = f"place {self.model.nframes}", pinocchio.FrameType.OP_FRAME
            found.append(self.model.addFrame(pinocchio.Frame(name, self.number[place.body], at, kind)))
        return found

    def _placed(self, frames: Sequence[int]) -> Array:
        return np.reshape([self.data.oMf[frame].translation for frame in frames], (-1, 3))

    def _jacobian(self, frame: int) -> Array:
        return np.asarray(pinocchio.getFrameJacobian(self.model, self.data, frame, CAR)[:3])

    def _rates(self, frame: int) -> tuple[Any, Any]:
        """Velocity and acceleration of a place, and the angular ones of its body, in the car's axes."""
        model, data = self.model, self.data
        velocity = pinocchio.getFrameVelocity(model, data, frame, CAR)
        return velocity, pinocchio.getFrameClassicalAcceleration(model, data, frame, CAR)


def _kind(joint: Joint, own: Array) -> object:
    """Pinocchio's joint; its axis is given in the axes of the body that it carries."""
    if joint.kind == "ball":
        return pinocchio.JointModelSpherical()
    axis = own.T @ joint.axis
    if joint.kind == "hinge":
        return pinocchio.JointModelRevoluteUnaligned(axis)
    return pinocchio.JointModelPrismaticUnaligned(axis)
