"""Knuckles on an arm that moves too, held by one link: hinged to it, or sliding along a line of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pointcoord import Scene

ROLES = {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"]}
ARM = {
    "arm_front": (-200.0, 300.0, 300.0),
    "arm_rear": (180.0, 320.0, 310.0),
    "inner": (0.0, 650.0, 300.0),
    "centre": (0.0, 750.0, 310.0),
}
HINGED = {
    "chassis": ["arm_front", "arm_rear", "link_inner"],
    "arm": ["arm_front", "arm_rear", "king_low", "king_top"],
    # Lists the points of its hinge in another order than the arm.
    "knuckle": ["king_top", "king_low", "link_outer", "inner", "centre"],
}
KING = {
    "king_low": (10.0, 640.0, 180.0),
    "king_top": (25.0, 600.0, 420.0),
    "link_inner": (-140.0, 310.0, 260.0),
    "link_outer": (-130.0, 630.0, 250.0),
}
GUIDED = {
    "chassis": ["arm_front", "arm_rear", "link_inner"],
    "arm": ["arm_front", "arm_rear", "guide", "guide_end"],
    "knuckle": ["near", "far", "beside", "inner", "centre"],
}
GUIDE = {
    "guide": (10.0, 400.0, 280.0),
    "guide_end": (20.0, 600.0, 300.0),
    "near": (15.0, 500.0, 290.0),
    "far": (22.5, 650.0, 305.0),
    "link_inner": (180.0, 600.0, 620.0),
    "beside": (170.0, 640.0, 250.0),
    "inner": (0.0, 650.0, 290.0),
    "centre": (0.0, 750.0, 300.0),
}


def hinged_knuckle(
    load: Mapping[str, Any],
    radius: float,
    samples: int = 5,
    bodies: tuple[str, ...] = ("chassis", "arm", "knuckle"),
) -> Scene:
    """It goes down and up under a load, with its bodies listed in an order."""
    tables = {
        "bodies": {body: HINGED[body] for body in bodies},
        "rods": {"link": ["link_inner", "link_outer"]},
        "inputs": {"travel": {"height": "centre"}},
    }
    return _scene(tables, ARM | KING, load, radius, samples)


def guided_knuckle(load: Mapping[str, Any], radius: float, samples: int = 5) -> Scene:
    """It goes up and outwards under a load, with the nearer of its two points on the line driven along it."""
    line = {"points": ["near", "far"], "body": "arm", "through": "guide", "along": "guide_end"}
    tables = {
        "bodies": GUIDED,
        "rods": {"link": ["link_inner", "beside"]},
        "slides": {"guide": line},
        "inputs": {"travel": {"height": "centre"}, "reach": {"travel": "guide"}},
    }
    return _scene(tables, ARM | GUIDE, load, radius, samples, reach={"polynomial": ["drawn", 30.0]})


def _scene(
    tables: Mapping[str, Any],
    points: Mapping[str, Any],
    load: Mapping[str, Any],
    radius: float,
    samples: int,
    **inputs: Any,
) -> Scene:
    wheel = {"roles": ROLES, "side": "right", "points": points, "wheel_radius": radius, "loads": load}
    return Scene.from_mapping(
        {
            "effects": ["loads"],
            "mechanism": {**tables, **wheel},
            "inputs": {"travel": {"polynomial": [-20.0, 45.0]}, **inputs},
            "time": {"start": 0.0, "stop": 1.0, "samples": samples},
        }
    )
