"""A chain of linkages of any length: rockers in a row, each driven by the one before.

Rocker j turns about an axis along x in a lane of its own, x = 40 j. A rod joins its tip to the next one's, so
two neighbours and their rod are a planar four-bar. The pivots lie in turns on two lines, so that every second
four-bar is the first one backwards: a swing neither dies nor grows along the chain, however long it is.
"""

from __future__ import annotations

import math

import numpy as np

from pointcoord import Scene

LANE = 40.0  # mm
AXIS = 60.0  # mm, between the two points of a rocker's axis
RISE = 150.0  # mm, from the lower line of pivots to the upper one
ROCKERS = (100.0, 80.0)  # mm, of even and of odd number
# The first rocker's angle, rad: about the horizontal, where it is drawn; there the height tells it best.
SWING = {"amplitude": 0.35, "angular_frequency": 2.0 * math.pi, "phase": 0.0, "offset": 0.5 * math.pi}
STOP = 0.25  # s: a quarter of the swing
INSTANTS = np.linspace(0.0, STOP, 6)[1:]
TOLERANCE = 1e-9  # mm


def chain_scene(unknowns: int) -> Scene:
    """The chain over a quarter of the swing, for its positions alone.

    Args:
        unknowns: a multiple of three: the coordinates of the tip of each rocker.
    """
    points, rods = dict[str, list[float]](), dict[str, list[str]]()
    bodies: dict[str, list[str]] = {"chassis": []}
    for j in range(unknowns // 3):
        pivot, names = np.array([LANE * j, 0.0, RISE * (j % 2)]), [f"pivot_{j}", f"axis_{j}", f"tip_{j}"]
        places = pivot + np.array([[0.0, 0.0, 0.0], [AXIS, 0.0, 0.0], [0.0, ROCKERS[j % 2], 0.0]])
        points |= dict(zip(names, places.tolist(), strict=True))
        bodies["chassis"] += names[:2]
        bodies[f"rocker_{j}"] = names
        if j:
            rods[f"rod_{j}"] = [f"tip_{j - 1}", f"tip_{j}"]
    mechanism = {
        "bodies": bodies,
        "rods": rods,
        "inputs": {"arm_angle": {"angle": "rocker_0", "of": "tip_0", "about": "pivot_0", "from": "up"}},
        "side": "right",
        "points": points,
    }
    content = {
        "title": f"chain of {unknowns // 3} rockers",
        "tolerance": TOLERANCE,
        "mechanism": mechanism,
        "inputs": {"arm_angle": {"sine": SWING}},
        "time": {"start": 0.0, "stop": STOP, "samples": 6},
    }
    return Scene.from_mapping(content, "chain of four-bars")
