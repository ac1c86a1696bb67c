"""A knuckle that slides along a line of a moving arm and is kept from turning about it by a link."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pointcoord import Scene

TABLES: dict[str, Any] = {
    "bodies": {
        "chassis": ["arm_front", "arm_rear", "link_inner"],
        "arm": ["arm_front", "arm_rear", "guide", "guide_end"],
        "knuckle": ["near", "far", "beside", "inner", "centre"],
    },
    "rods": {"link": ["link_inner", "beside"]},
    "inputs": {"travel": {"height": "centre"}, "reach": {"travel": "guide"}},
    "roles": {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"]},
}
POINTS = {
    "arm_front": (-200.0, 300.0, 300.0),
    "arm_rear": (180.0, 320.0, 310.0),
    "guide": (10.0, 400.0, 280.0),
    "guide_end": (20.0, 600.0, 300.0),
    "near": (15.0, 500.0, 290.0),
    "far": (22.5, 650.0, 305.0),
    "link_inner": (180.0, 600.0, 620.0),
    "beside": (170.0, 640.0, 250.0),
    "inner": (0.0, 650.0, 290.0),
    "centre": (0.0, 750.0, 300.0),
}


def guided_knuckle(load: Mapping[str, Any], radius: float, samples: int = 5, driven: str = "near") -> Scene:
    """It goes up and outwards under a load, with one of its two points on the line driven along it."""
    points = ["near", "far"] if driven == "near" else ["far", "near"]
    slide = {"points": points, "body": "arm", "through": "guide", "along": "guide_end"}
    wheel = {"side": "right", "points": POINTS, "wheel_radius": radius, "loads": load}
    return Scene.from_mapping(
        {
            "effects": ["loads"],
            "mechanism": {**TABLES, "slides": {"guide": slide}, **wheel},
            "inputs": {"travel": {"polynomial": [-20.0, 45.0]}, "reach": {"polynomial": ["drawn", 30.0]}},
            "time": {"start": 0.0, "stop": 1.0, "samples": samples},
        }
    )
