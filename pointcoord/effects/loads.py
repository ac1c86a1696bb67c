r"""Loads: forces in rods and joints under loads at the wheels; statics at each pose, by virtual work.

A load acts on the knuckle at the contact point. If a rod grew by dl, all else held, the contact point would
move by dc and the knuckle rotate by dt, and

    N dl = F . dc + M . dt,

with N the rod's tension. N of the damper follows in the same way: the damper holds its corner in place of the
input that moves the wheel, which is free. With W_q and l_q the work and the damper's length per unit of that
input, and W_s and l_s along another way s, the work along s with the damper held is W_s - W_q l_s / l_q. At a
ball joint the half of one body moves by e from that of the other, on which the force f acts: f . e = F . dc +
M . dt. At each of the two points of a hinge this gives the force across the hinge's line. Along the line only
the sum of both forces is determined, since a body stretched between the points would not move as a rigid one.
A point on a slide has the force that belongs to moving the slide's line away from it: across the line, and
along it where an input drives the travel.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from pointcoord.effects.arithmetic import dot, ratio, root, times
from pointcoord.effects.car_number import BY_TRAVEL, KINDS
from pointcoord.effects.corner import (
    Wheel,
    contact_place,
    corner_of,
    turning_of,
    velocity_at,
    wheels_of,
)
from pointcoord.effects.effect import Effect, Poses, Quantity, lacks, no_radius, no_role, not_one_input
from pointcoord.linkage.directions import CarAxes
from pointcoord.linkage.slopes import GAP, ByGap, ByLength, Way
from pointcoord.linkage.topology import Topology

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_points import EnclosedPoses


ROD_FORCE = Quantity(
    "rod_force",
    "force in the rod",
    "N",
    "car",
    "of each rod, and of `damper`: the work of the loads per mm of lengthening, all else held",
    "tension",
)
JOINT_FORCE = Quantity(
    "joint_force",
    "force at the joint",
    "N",
    "joint",
    "of each ball joint, of both points of a hinge, and of each point on a slide: (Fx, Fy, Fz) on the "
    "knuckle, else on the moving body that the mechanism's file names first, or on the point itself if no "
    "body has it, as at the end of a rack; for a hinge across its line only; for a slide across its line, "
    "and along it where an input drives the travel",
    "along the user's axes",
)
HINGE_THRUST = Quantity(
    "hinge_thrust",
    "force along the hinge",
    "N",
    "car",
    "of each hinge, by its first point: sum of the forces on the same body along the line at both points",
    "from the first point that the body lists to the second",
)
HOLDING = "damper"
ROLES = ("wheel_axis", "knuckle")
AXES = np.eye(3)


@dataclass(frozen=True, eq=False)
class Loads(Effect):
    """The forces that hold a mechanism under its scene's loads.

    It needs derivatives along lengths, gaps and the inputs that dampers replace.
    """

    def gives_numbers(self, topology: Topology) -> Mapping[str, tuple[str, ...]]:
        """Names of rods and dampers; points of ball joints, hinges and slides; hinges with thrusts."""
        dampers = (f"{wheel.prefix}{HOLDING}" for wheel in _held(topology))
        return {
            ROD_FORCE.name: (*topology.rods, *dampers),
            JOINT_FORCE.name: _joined(topology),
            HINGE_THRUST.name: tuple(points[0] for points in topology.joints if len(points) == 2),
        }

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        """The free inputs, the lengths of rods, and three gaps for each point of a joint."""
        return (
            *(wheel.way(BY_TRAVEL) for wheel in _held(topology)),
            *map(ByLength, topology.rods),
            *(ByGap(point, axis) for point in _joined(topology) for axis in range(3)),
        )

    def needs(self, topology: Topology) -> Collection[str]:
        return topology.points

    def evaluate(self, poses: Poses | EnclosedPoses) -> dict[str, dict[str, Any]]:
        """Tensions, forces at joints and thrusts of hinges."""
        topology, places = poses.mechanism.topology, poses.points[0]
        slopes, damped = cast("Mapping[Way, Any]", poses.slopes), _held(topology)

        def stretch(way: Way, ends: Sequence[str]) -> Any:
            """Change of the distance between two points along a way."""
            line, moved = (of[ends[1]] - of[ends[0]] for of in (places, slopes[way][0]))
            return ratio(dot(line, moved), root(dot(line, line)))

        def along(way: Way) -> list[Any]:
            """Work of all loads, N times the unit of length, and changes of the dampers' lengths."""
            works = []
            for part, (force, moment) in poses.axes.loads.items():
                corner = corner_of(poses, Wheel(topology, part), slopes[way])
                works.append(dot(poses.constant(force), velocity_at(corner, contact_place(corner))))
                for i in np.flatnonzero(moment).tolist():
                    # The knuckle's rotation about an axis: how far the next axis moves along the one after.
                    turn = turning_of(corner, poses.constant(AXES[i - 2]))
                    works.append(dot(poses.constant(moment[i] / poses.unit * AXES[i - 1]), turn))
            return [reduce(add, works), *(stretch(way, wheel.role(HOLDING)) for wheel in damped)]

        def with_held(found: list[Any], i: int) -> list[Any]:
            """Changes with a damper held, and the input that moves this damper free."""
            share = ratio(found[1 + i], free[i][1 + i])
            return [one - share * other for one, other in zip(found, free[i], strict=True)]

        def work(way: Way) -> Any:
            """The work along a way with all dampers held."""
            return reduce(with_held, range(len(free)), along(way))[0]

        free = [along(wheel.way(BY_TRAVEL)) for wheel in damped]
        for i in range(len(free)):
            free = [one if k == i else with_held(one, i) for k, one in enumerate(free)]
        rods = {}
        for rod, ends in topology.rods.items():
            rods[rod] = ratio(work(ByLength(rod)), stretch(ByLength(rod), ends))
        for i, wheel in enumerate(damped):
            rods[f"{wheel.prefix}{HOLDING}"] = ratio(free[i][0], free[i][1 + i])
        joints, thrusts = {}, {}
        for point in _joined(topology):
            parts = []
            for axis in range(3):
                gap = slopes[ByGap(point, axis)][0][GAP]
                parts.append(times(ratio(work(ByGap(point, axis)), dot(gap, gap)), gap))
            force = reduce(add, parts)
            _, of_line = topology.sliding.get(point, ("", point in topology.chassis))
            joints[point] = -force if of_line else force
        for points in (points for points in topology.joints if len(points) == 2):
            line = places[points[1]] - places[points[0]]
            parts = [dot(joints[point], line) for point in points]
            thrusts[points[0]] = ratio(parts[0] + parts[1], root(dot(line, line)))
            for point, part in zip(points, parts, strict=True):
                joints[point] = joints[point] - times(ratio(part, dot(line, line)), line)
        return {ROD_FORCE.name: rods, JOINT_FORCE.name: joints, HINGE_THRUST.name: thrusts}

    def refusal(self, topology: Topology, axes: CarAxes) -> str:
        if not axes.loads:
            advice = "give one under [mechanism.loads], such as force = [0.0, 0.0, 3000.0]"
            return lacks(self.name, "a load, which the scene does not give", advice)
        for part in axes.loads:
            wheel = Wheel(topology, part)
            for role in ROLES:
                if not wheel.role(role):
                    return no_role(self.name, wheel.prefix + role, topology)
        if axes.wheel_radius is None:
            return no_radius(self.name)
        if topology.left_out:
            rows = ", ".join(topology.left_labels)
            needs = f"a mechanism without redundant joints, and in {topology.name!r} these rows follow from"
            return lacks(self.name, f"{needs} the others: {rows}", "remove redundant joints")
        for wheel in _held(topology):
            driven = wheel.driven(BY_TRAVEL)
            if len(driven) != 1:
                which = f"that {KINDS[BY_TRAVEL]} for the {wheel.prefix}{HOLDING} to hold instead"
                return not_one_input(self.name, which, driven)
        return ""


def _joined(topology: Topology) -> tuple[str, ...]:
    return (*(point for points in topology.joints for point in points), *topology.sliding)


def _held(topology: Topology) -> tuple[Wheel, ...]:
    """The wheels that a damper holds."""
    return wheels_of(topology, (HOLDING,))


LOADS = Loads(
    name="loads",
    gives="forces in rods and joints under the loads at the wheels, N",
    derivative=0,
    quantities=(ROD_FORCE, JOINT_FORCE, HINGE_THRUST),
    way="lengths",
    no_number="the wheel's travel does not change the damper's length there",
)
