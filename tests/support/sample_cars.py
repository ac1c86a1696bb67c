"""A car of every suspension and closure that can be solved, for tests that say the same of all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology
from pointcoord.mechanism import mechanism_file
from validate.cars.paper_car import PAPER

Array = NDArray[np.float64]
Points = Mapping[str, tuple[float, float, float]]
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}


@dataclass(frozen=True)
class SampleCar:
    """A car, its type and closure, and the side it is drawn for; axes x rearward, y right, z up; mm."""

    type: str
    closure: str
    side: str
    points: Points

    @property
    def name(self) -> str:
        """For the names of tests."""
        return f"{self.type} {self.closure}"

    @property
    def whole(self) -> Topology:
        """The topology of a car that gives every point."""
        return mechanism_file(self.type).topology(self.closure)

    @property
    def topology(self) -> Topology:
        """The topology of this car."""
        return mechanism_file(self.type).topology(self.closure, points=self.points)

    def mechanism(self, points: Mapping[str, object] | None = None) -> Mechanism:
        """The mechanism of this car, or of one with other points."""
        return build_mechanism(self.topology, points or self.points, AXES)

    @property
    def drawn_inputs(self) -> dict[str, float]:
        """The inputs at which the car is drawn, from its points: arm angle, rad, and rack, mm."""
        p = {name: np.array(place) for name, place in self.points.items()}
        arm = p["lower_ball_joint"] - p["lower_arm_front"]
        centre = p.get("rack_centre", p["tie_rod_inner"])
        return {
            "arm_angle": float(np.arccos(arm[2] / np.linalg.norm(arm))),
            "rack": float(centre[1] - p["tie_rod_inner"][1]),
        }


def _of_scene(name: str) -> SampleCar:
    part = Scene.load(name).mechanism
    return SampleCar(part.type, part.closure, part.side, dict(part.points))


PAPER_STRUT = SampleCar("macpherson", "collinear", "left", dict(PAPER))
GENERAL_STRUT = _of_scene("off-axis-strut")
WISHBONE = _of_scene("double-wishbone")
SAMPLES = (PAPER_STRUT, GENERAL_STRUT, WISHBONE)

by_car = pytest.mark.parametrize("car", SAMPLES, ids=lambda car: car.name)
by_drawn_car = pytest.mark.parametrize("car", [GENERAL_STRUT, WISHBONE], ids=lambda car: car.name)
