"""The laws of a scene's inputs at instants, as numbers for ways that take them so."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene

Array = NDArray[np.float64]


def laws_at(scene: Scene, instants: Array) -> dict[str, Array]:
    """Value, rate and acceleration of every input, (N, 3), rad or mm, and s."""
    return {name: law.series(instants, 2) * (1.0, 1.0, 2.0) for name, law in scene.functions.items()}


def chassis_motion(scene: Scene, laws: Mapping[str, Array]) -> Array | None:
    """What the inputs that move the chassis come to, (N, 3, 3), mm and s; None if there are none."""
    part = scene.mechanism
    directions = {"up": part.up, "right": part.right}
    moves = [
        laws[name][:, :, None] * np.array(directions[direction])
        for name, direction in part.topology.chassis_motion.items()
        if name in laws
    ]
    return np.asarray(sum(moves[1:], moves[0])) if moves else None
