"""Oriented quantities that tell the branches of a strut apart, followed through a solved motion.

Two assemblies meet where a product of vectors is zero: the ball joint's place beside the arm's axis, or the
tie rod's outer end beside the plane of kingpin and rack. As parts of the lengths that they are made of both
lie between -1 and 1; along a motion without a jump they keep the sign of the drawing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.hard.sides import drawn_choices
from validate.hard.trial import Facts, Tried

Array = NDArray[np.float64]


def sides(scene: Scene, position: Mapping[str, Array]) -> dict[str, Array]:
    """Both products at every instant, each of shape (N,), as parts of the lengths of their factors.

    Args:
        position: of the points, (N, 3), mm.
    """
    ball, front = position["lower_ball_joint"], position["lower_arm_front"]
    heave = front - np.array(scene.mechanism.points["lower_arm_front"])
    up = np.broadcast_to(np.array(scene.mechanism.up), heave.shape)
    top = position["strut_top"]
    return {
        "arm": _share(position["lower_arm_rear"] - front, up, ball - front),
        "tie": _share(top - ball, position["tie_rod_inner"] - ball, position["tie_rod_outer"] - ball),
    }


def _share(a: Array, b: Array, c: Array) -> Array:
    lengths = [np.linalg.norm(v, axis=-1) for v in (a, b, c)]
    return np.asarray(np.sum(np.cross(a, b) * c, axis=-1) / (lengths[0] * lengths[1] * lengths[2]))


def followed(tried: Tried) -> Facts:
    """For each solution its least share on the side of the drawing; negative where it is on another branch.

    A collinear strut's tie rod is drawn about the knuckle's own line, which points towards the top or away.
    """
    facts: dict[str, float | str] = {}
    drawn = drawn_choices(tried.scene)
    collinear = tried.scene.mechanism.closure == "collinear"
    signs = {"arm": drawn.arm, "tie": drawn.tie * (drawn.strut if collinear else 1)}
    for name, solution in tried.solutions.items():
        for side, shares in sides(tried.scene, solution.position).items():
            facts[f"{side} side of {name}, least share"] = float(np.min(signs[side] * shares))
    return facts
