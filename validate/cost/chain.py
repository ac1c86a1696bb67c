r"""A chain of linkages of any length, with a closed form: rockers in a row, each driven by the one before.

Rocker j turns about an axis along x in a lane of its own, x = 40 j. A rod joins its tip to the next one's.
The first rocker is driven by its arm angle theta from the upward vertical,

    p_j = a_j + r_j (0, sin theta_j, cos theta_j),

with a_j = (40 j, 0, 0) and r_j = 100 mm for even j, (40 j, 0, 150) and 80 mm for odd j. Tips stay in their
lanes, so two neighbours and their rod are a planar four-bar. The pivots lie in turns on two lines, so that
every second four-bar is the first one backwards: all even rockers turn as the driven one does, all odd ones
as its follower, and a swing neither dies nor grows along the chain, however long it is. So the closed form is
one intersection of two circles. Every drawn number is an integer: nothing of the drawing is rounded.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.time_functions import Sine

Array = NDArray[np.float64]

LANE = 40.0  # mm
AXIS = 60.0  # mm, between the two points of a rocker's axis
RISE = 150.0  # mm, from the lower line of pivots to the upper one
ROCKERS = (100.0, 80.0)  # mm, of even and of odd number
SWING = Sine(amplitude=0.35, angular_frequency=2.0 * np.pi, phase=0.0, offset=0.5 * np.pi)
"""The driven angle, rad: about the horizontal, where it is drawn; there the height tells it best."""
STOP = 0.25  # s: a quarter of the swing
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
        "inputs": {"arm_angle": {"sine": asdict(SWING)}},
        "time": {"start": 0.0, "stop": STOP, "samples": 6},
    }
    return Scene.from_mapping(content, "chain of four-bars")


def closed_form(unknowns: int, instants: Array) -> dict[str, Array]:
    """The place of every tip at instants of shape (N,), (N, 3), mm, in long doubles and rounded once.

    With d the vector from the even tip to the odd pivot, the odd tip is the intersection of the circles of
    radius c (the rod's drawn length in the plane) and r_1 about its ends, on the side where it is drawn.
    """
    even, odd, rise = (np.longdouble(length) for length in (*ROCKERS, RISE))
    t, law = np.asarray(instants, np.longdouble), SWING
    angle = law.offset + law.amplitude * np.sin(law.angular_frequency * t + law.phase)
    y, z = even * np.sin(angle), even * np.cos(angle)
    dy, dz = -y, rise - z
    square, rod = dy * dy + dz * dz, (even - odd) ** 2 + rise * rise
    # Share of d from the even tip to the foot of the odd one, and the height over d in parts of d.
    share = (square + rod - odd * odd) / (2 * square)
    height = np.sqrt(rod / square - share * share)
    tips = (y, z), (y + share * dy + height * dz, z + share * dz - height * dy)
    return {
        f"tip_{j}": np.stack([np.full(t.shape, LANE * j), *tips[j % 2]], axis=-1).astype(float)
        for j in range(unknowns // 3)
    }
