"""A mechanism in Pinocchio, by the coordinates of its joints: the relative-coordinate model.

The sites of the tree are frames of the model: Pinocchio gives their positions, Jacobians, rates and
accelerations.
"""

from __future__ import annotations

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
        self.model = model = pinocchio.Model()
        self.number = {CHASSIS: 0}
        for joint in tree.joints:
            turn, own = tree.frames[joint.parent][1], tree.frames[joint.body][1]
            placed = pinocchio.SE3(turn.T @ own, tree.local(Place(joint.parent, joint.at)))
            parent = self.number[joint.parent]
            self.number[joint.body] = model.addJoint(parent, _kind(joint, own), placed, joint.body)
        self.sites = []
        for number, place in enumerate(tree.sites):
            at, kind = pinocchio.SE3(np.eye(3), tree.local(place)), pinocchio.FrameType.OP_FRAME
            frame = pinocchio.Frame(f"site {number}", self.number[place.body], at, kind)
            self.sites.append(model.addFrame(frame))
        self.data, self.q = model.createData(), np.array(pinocchio.neutral(model))
        super().__init__(tree, model.nv)

    def joint(self, body: str) -> tuple[int, int]:
        joint = self.model.joints[self.number[body]]
        return joint.idx_q, joint.idx_v

    @property
    def coordinates(self) -> Array:
        return self.q.copy()

    def put(self, coordinates: Array) -> None:
        self.q = np.array(coordinates)

    def move(self, step: Array) -> None:
        self.q = pinocchio.normalize(self.model, pinocchio.integrate(self.model, self.q, step))

    def positions(self, which: slice) -> Array:
        pinocchio.framesForwardKinematics(self.model, self.data, self.q)
        return np.reshape([self.data.oMf[site].translation for site in self.sites[which]], (-1, 3))

    def gap_jacobian(self) -> Array:
        model, data = self.model, self.data
        pinocchio.computeJointJacobians(model, data, self.q)
        pinocchio.updateFramePlacements(model, data)
        each = [pinocchio.getFrameJacobian(model, data, site, CAR)[:3] for site in self.sites[self.ends]]
        first, second = np.reshape(each, (2, -1, model.nv))
        return np.asarray(first - second)

    def set_rates(self, rates: Array, accelerations: Array) -> None:
        pinocchio.forwardKinematics(self.model, self.data, self.q, rates, accelerations)

    def rates_of(self, which: slice, order: int) -> Array:
        of = (pinocchio.getFrameVelocity, pinocchio.getFrameClassicalAcceleration)[order - 1]
        each = [of(self.model, self.data, site, CAR).vector for site in self.sites[which]]
        return np.reshape(each, (-1, 2, 3))


def _kind(joint: Joint, own: Array) -> object:
    """Pinocchio's joint; its axis is given in the axes of the body that it carries."""
    if joint.kind == "ball":
        return pinocchio.JointModelSpherical()
    axis = own.T @ joint.axis
    if joint.kind == "hinge":
        return pinocchio.JointModelRevoluteUnaligned(axis)
    return pinocchio.JointModelPrismaticUnaligned(axis)
