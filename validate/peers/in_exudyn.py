"""A mechanism in Exudyn: a kinematic tree whose loops are closed by Exudyn's spherical joints.

Exudyn's static solver gives the Jacobian of these constraints, and its sensors give the positions and rates
of the sites (`program` uses both). A ball joint of the tree is three revolute joints in
series, about the car's axes right, forward and up as drawn; the middle angle, a body's camber, must not reach
90 deg. A rod's ball joint is two revolute joints across the rod, because a spin about the rod has no effect.
The first one's axis is as nearly as possible that of the mechanism's first hinge that is not along the rod,
since bodies turn farthest about hinges.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import Any

import numpy as np

from validate.arrays import Array
from validate.extras import needing
from validate.peers.program import Program
from validate.spanning_tree.tree import CHASSIS, Joint, Place, SpanningTree, axes_along, car_directions

# Imported by name, since exudyn's type hints differ from the arguments that its compiled functions take.
with needing("exudyn"):
    exudyn: Any = import_module("exudyn")
    items: Any = import_module("exudyn.itemInterface")

TURNS = (exudyn.JointType.RevoluteX, exudyn.JointType.RevoluteY, exudyn.JointType.RevoluteZ)
READ = ("Position", "Velocity", "AngularVelocity", "Acceleration", "AngularAcceleration")


class InExudyn(Program):
    """A mechanism as an Exudyn system; the pose that was computed last is the system's."""

    def __init__(self, tree: SpanningTree) -> None:
        self.container = exudyn.SystemContainer()
        self.system = system = self.container.AddSystem()
        self.last: dict[str, int] = {}  # the link that has the points of a body, by body
        self.frames: dict[str, tuple[Array, Array]] = {CHASSIS: (np.zeros(3), np.eye(3))}
        self.links = self._links(tree)
        for loop in tree.loops:
            markers = [self._marker(side) for side in (loop.first, loop.second)]
            system.AddObject(items.ObjectJointSpherical(markerNumbers=markers))
        self.sensors = {what: [self._sensor(place, what) for place in tree.sites] for what in READ}
        system.Assemble()
        self.solver, self.settings = exudyn.MainSolverStatic(), exudyn.SimulationSettings()
        self.settings.solution.file.write = False
        self.settings.staticSolver.verboseMode = 0
        self.solver.InitializeSolver(system, self.settings)
        self.size, rows = self.solver.GetODE2size(), self.solver.GetAEsize()
        self.nothing = np.zeros((self.size + rows, self.size + rows))
        super().__init__(tree, self.size, rods_spin=False)

    def joint(self, body: str) -> tuple[int, int]:
        return self.last[body], self.last[body]

    @property
    def coordinates(self) -> Array:
        return np.array(self.system.systemData.GetODE2Coordinates())

    def put(self, coordinates: Array) -> None:
        self.system.systemData.SetODE2Coordinates(coordinates)

    def move(self, step: Array) -> None:
        self.put(self.coordinates + step)

    def positions(self, which: slice) -> Array:
        return self._read("Position", which)

    def gap_jacobian(self) -> Array:
        self.solver.SetSystemJacobian(self.nothing)
        self.solver.ComputeJacobianAE(self.system)
        # Exudyn's constraints are second - first.
        return -np.asarray(self.solver.GetSystemJacobian())[self.size :, : self.size]

    def set_rates(self, rates: Array, accelerations: Array) -> None:
        self.system.systemData.SetODE2Coordinates_t(rates)
        self.system.systemData.SetODE2Coordinates_tt(accelerations)

    def rates_of(self, which: slice, order: int) -> Array:
        kinds = READ[1:3] if order == 1 else READ[3:]
        return np.stack([self._read(what, which) for what in kinds], axis=1)

    def _links(self, tree: SpanningTree) -> int:
        """Exudyn's number of the tree; each link has one coordinate and mass 1 (no result depends on it)."""
        kinds, parents, turns, offsets = list[object](), list[int](), list[Array](), list[Array]()
        for joint in tree.joints:
            axes, own = _axes_and_turns(tree, joint)
            origin, parent = self.frames[joint.parent]
            first, others = len(kinds), len(own) - 1
            turns += [parent.T @ axes, *[np.eye(3)] * others]
            offsets += [parent.T @ (joint.at - origin), *[np.zeros(3)] * others]
            parents += [self.last.get(joint.parent, -1), *range(first, first + others)]
            kinds += own
            self.last[joint.body], self.frames[joint.body] = first + others, (joint.at, axes)
        count = len(kinds)
        node = items.NodeGenericODE2(
            referenceCoordinates=[0.0] * count,
            initialCoordinates=[0.0] * count,
            initialCoordinates_t=[0.0] * count,
            numberOfODE2Coordinates=count,
        )
        links = items.ObjectKinematicTree(
            nodeNumber=self.system.AddNode(node),
            jointTypes=kinds,
            linkParents=parents,
            jointTransformations=exudyn.Matrix3DList(turns),
            jointOffsets=exudyn.Vector3DList(offsets),
            linkInertiasCOM=exudyn.Matrix3DList([np.eye(3)] * count),
            linkCOMs=exudyn.Vector3DList([np.zeros(3)] * count),
            linkMasses=[1.0] * count,
        )
        return int(self.system.AddObject(links))

    def _place(self, place: Place) -> dict[str, Any]:
        """A place in its link's frame, in Exudyn's words."""
        origin, axes = self.frames[place.body]
        return {"linkNumber": self.last[place.body], "localPosition": axes.T @ (place.at - origin)}

    def _read(self, what: str, which: slice) -> Array:
        """Values of the sensors of some sites, (sites, 3)."""
        sensors = self.sensors[what][which]
        values = [self.system.GetSensorValues(s) if isinstance(s, int) else s for s in sensors]
        return np.reshape(values, (-1, 3))

    def _sensor(self, place: Place, what: str) -> int | Array:
        """A sensor at a place of a body; the value itself for the chassis, which is at rest."""
        if place.body == CHASSIS:
            return place.at if what == "Position" else np.zeros(3)
        kind = getattr(exudyn.OutputVariableType, what)
        sensor = items.SensorKinematicTree(
            objectNumber=self.links, outputVariableType=kind, writeToFile=False, **self._place(place)
        )
        return int(self.system.AddSensor(sensor))

    def _marker(self, place: Place) -> int:
        if place.body == CHASSIS:
            ground = self.system.AddObject(items.ObjectGround())
            marker = items.MarkerBodyRigid(bodyNumber=ground, localPosition=place.at)
        else:
            marker = items.MarkerKinematicTreeRigid(objectNumber=self.links, **self._place(place))
        return int(self.system.AddMarker(marker))


def _axes_and_turns(tree: SpanningTree, joint: Joint) -> tuple[Array, Sequence[object]]:
    """Axes of a joint's body as columns, and the series of one-coordinate joints that replaces the joint."""
    if joint.body in tree.rods:
        return _rod_axes(tree, tree.rods[joint.body]), TURNS[:2]
    if joint.kind == "ball":
        car = car_directions(tree.plain)
        return np.stack([car["right"], car["forward"], car["up"]], axis=-1), TURNS
    return axes_along(joint.axis), (TURNS[2] if joint.kind == "hinge" else exudyn.JointType.PrismaticZ,)


def _rod_axes(tree: SpanningTree, rod: Array) -> Array:
    """Axes of a rod's turns as columns; the third is the rod."""
    for joint in tree.joints:
        beside = joint.axis - float(joint.axis @ rod) * rod
        if joint.kind == "hinge" and np.linalg.norm(beside) > 0.5:
            first = beside / np.linalg.norm(beside)
            return np.stack([first, np.cross(rod, first), rod], axis=-1)
    return axes_along(rod)
