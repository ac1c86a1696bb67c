"""A mechanism in Exudyn: a kinematic tree whose loops are closed by Exudyn's spherical joints.

Exudyn's static solver gives the residuals of these constraints and their Jacobian, and its sensors give the
motion of any point of the tree (`program` uses both). A ball joint of the tree is three revolute joints in
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
MOVES = ("Velocity", "Acceleration", "AngularVelocity", "AngularAcceleration")


class InExudyn(Program):
    """A mechanism as an Exudyn system; the pose that was computed last is the system's."""

    def __init__(self, tree: SpanningTree) -> None:
        self.tree = tree
        self.container = exudyn.SystemContainer()
        self.system = system = self.container.AddSystem()
        self.last: dict[str, int] = {}  # the link that has the points of a body, by body
        self.frames: dict[str, tuple[Array, Array]] = {CHASSIS: (np.zeros(3), np.eye(3))}
        self.links = self._links()
        points = tree.moving.values()
        self.places_of = [self._sensor(place, "Position") for place in points]
        bodies = [Place(body, self.frames[body][0]) for body in tree.knuckles]
        self.moves_of = [
            [
                *(self._sensor(place, of_point) for place in points),
                *(self._sensor(place, of_body) for place in bodies),
            ]
            for of_point, of_body in zip(MOVES[:2], MOVES[2:], strict=True)
        ]
        self.ends = []
        for loop in tree.loops:
            sides = (loop.first, loop.second)
            markers = [self._marker(side) for side in sides]
            system.AddObject(items.ObjectJointSpherical(markerNumbers=markers))
            self.ends.append([self._sensor(side, "Acceleration") for side in sides])
        system.Assemble()
        self.solver, self.settings = exudyn.MainSolverStatic(), exudyn.SimulationSettings()
        self.settings.solution.file.write = False
        self.settings.staticSolver.verboseMode = 0
        self.solver.InitializeSolver(system, self.settings)
        self.size, rows = self.solver.GetODE2size(), self.solver.GetAEsize()
        self.nothing = np.zeros((self.size + rows, self.size + rows))
        self.as_drawn = np.zeros(self.size)
        self.driven = np.array([self.last[driven.body] for driven in tree.driven])
        self.driven_at = self.driven
        self.unknown = np.array([i for i in range(self.size) if i not in self.driven], dtype=np.intp)

    @property
    def coordinates(self) -> Array:
        return np.array(self.system.systemData.GetODE2Coordinates())

    def put(self, coordinates: Array) -> None:
        self.system.systemData.SetODE2Coordinates(coordinates)

    def move(self, step: Array) -> None:
        self.put(self.coordinates + step)

    def misses(self) -> tuple[Array, Array]:
        solver, size = self.solver, self.size
        solver.ComputeAlgebraicEquations(self.system)
        solver.SetSystemJacobian(self.nothing)
        solver.ComputeJacobianAE(self.system)
        jacobian = np.asarray(solver.GetSystemJacobian())
        return np.asarray(solver.GetSystemResidual())[size:], jacobian[size:, :size]

    def places(self) -> Array:
        return self._read(self.places_of)

    def apart(self, rates: Array, accelerations: Array) -> Array:
        self.system.systemData.SetODE2Coordinates_t(rates)
        self.system.systemData.SetODE2Coordinates_tt(accelerations)
        parts = [self._read([two])[0] - self._read([one])[0] for one, two in self.ends]
        # There is no loop where each joint is driven.
        return np.concatenate([np.zeros(0), *parts])

    def moving(self, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        self.system.systemData.SetODE2Coordinates_t(rates)
        self.system.systemData.SetODE2Coordinates_tt(accelerations)
        first, second = (self._read(sensors) for sensors in self.moves_of)
        return first, second

    def _links(self) -> int:
        """Exudyn's number of the tree; each link has one coordinate and mass 1 (no result depends on it)."""
        kinds, parents, turns, offsets = list[object](), list[int](), list[Array](), list[Array]()
        for joint in self.tree.joints:
            axes, own = _axes_and_turns(self.tree, joint)
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

    def _read(self, sensors: Sequence[int | None]) -> Array:
        """Values of sensors, (sensors, 3); zero for the chassis, which has no sensor and is at rest."""
        system, still = self.system, np.zeros(3)
        return np.array([still if s is None else system.GetSensorValues(s) for s in sensors])

    def _sensor(self, place: Place, what: str) -> int | None:
        """A sensor at a place of a body; None for the chassis."""
        if place.body == CHASSIS:
            return None
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
