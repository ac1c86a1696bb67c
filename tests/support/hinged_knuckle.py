"""A knuckle that is hinged to a moving arm and held by one link: a hinge between two bodies that move."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pointcoord import Scene

TABLES: dict[str, Any] = {
    "bodies": {
        "chassis": ["arm_front", "arm_rear", "link_inner"],
        "arm": ["arm_front", "arm_rear", "king_low", "king_top"],
        # Lists the points of its hinge in another order than the arm.
        "knuckle": ["king_top", "king_low", "link_outer", "inner", "centre"],
    },
    "rods": {"link": ["link_inner", "link_outer"]},
    "inputs": {"travel": {"height": "centre"}},
    "roles": {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"]},
}
POINTS = {
    "arm_front": (-200.0, 300.0, 300.0),
    "arm_rear": (180.0, 320.0, 310.0),
    "king_low": (10.0, 640.0, 180.0),
    "king_top": (25.0, 600.0, 420.0),
    "link_inner": (-140.0, 310.0, 260.0),
    "link_outer": (-130.0, 630.0, 250.0),
    "inner": (0.0, 650.0, 300.0),
    "centre": (0.0, 750.0, 310.0),
}


def hinged_knuckle(
    load: Mapping[str, Any],
    radius: float,
    samples: int = 5,
    bodies: tuple[str, ...] = ("chassis", "arm", "knuckle"),
) -> Scene:
    """It goes down and up under a load, with its bodies listed in an order."""
    tables = {**TABLES, "bodies": {body: TABLES["bodies"][body] for body in bodies}}
    wheel = {"side": "right", "points": POINTS, "wheel_radius": radius, "loads": load}
    return Scene.from_mapping(
        {
            "effects": ["loads"],
            "mechanism": {**tables, **wheel},
            "inputs": {"travel": {"polynomial": [-20.0, 45.0]}},
            "time": {"start": 0.0, "stop": 1.0, "samples": samples},
        }
    )
