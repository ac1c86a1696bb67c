"""The laws of a scene's inputs at instants, as numbers for ways that take them so."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene

Array = NDArray[np.float64]


def laws_at(scene: Scene, instants: Array) -> dict[str, Array]:
    """Value, rate and acceleration of every input, (N, 3), rad or mm, and s."""
    return {name: law.series(instants, 2) * (1.0, 1.0, 2.0) for name, law in scene.functions.items()}
