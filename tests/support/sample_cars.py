"""A car of every suspension and closure that arm angle and rack drive, for tests that say the same of all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pytest

from pointcoord import Scene
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.linkage.topology import Topology

Points = Mapping[str, tuple[float, float, float]]
AXES = {"up": (0.0, 0.0, 1.0), "right": (0.0, 1.0, 0.0)}


@dataclass(frozen=True)
class SampleCar:
    """The car of a shipped scene, with its type and closure and the side it is drawn for; mm."""

    name: str
    type: str
    closure: str
    side: str
    points: Points

    @classmethod
    def of(cls, scene: str) -> SampleCar:
        part = Scene.load(scene).mechanism
        return cls(scene, str(part.type), part.closure, part.side, dict(part.points))

    @property
    def topology(self) -> Topology:
        return Scene.load(self.name).mechanism.file.topology(self.closure, points=self.points)

    def mechanism(self) -> Mechanism:
        return build_mechanism(self.topology, self.points, AXES)

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


SAMPLES = tuple(map(SampleCar.of, ("bounce", "off-axis-strut", "double-wishbone")))
PAPER_STRUT, GENERAL_STRUT, WISHBONE = SAMPLES

by_car = pytest.mark.parametrize("car", SAMPLES, ids=lambda car: car.name)
by_drawn_car = pytest.mark.parametrize("car", [GENERAL_STRUT, WISHBONE], ids=lambda car: car.name)
