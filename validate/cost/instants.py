r"""The instants at which every way solves, and at which errors are measured.

They must be special to no way: not the ends of a chain's segments, where Newton's method has just been, nor
an even grid, on which differences and sums of periodic motions cancel. So the time of a scene is cut into N
equal parts, and instant i lies in its part i at the golden ratio's offset,

    t_i = start + (i + frac((i + 1) / phi)) (stop - start) / N,        i = 0 .. N - 1,

whose multiples keep from any fraction of small denominator as well as multiples of a number can (Hurwitz).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene

Array = NDArray[np.float64]

GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0
MOST, MOST_QUICK = 200, 24  # the reference takes some 5 ms for each, and more tell no more about an error


def study_instants(scene: Scene, count: int | None = None, *, quick: bool = False) -> Array:
    """Instants inside a scene's time, increasing, shape (N,), s.

    Args:
        count: N; as many as the scene has samples, but at most 200, or 24 of a quick study, if None.
    """
    if scene.time.start == scene.time.stop:
        return np.array([scene.time.start])
    if count is None:
        count = min(scene.time.samples, MOST_QUICK if quick else MOST)
    places = np.arange(count) + np.modf(np.arange(1, count + 1) / GOLDEN)[0]
    instants = scene.time.start + places * ((scene.time.stop - scene.time.start) / count)
    return np.asarray(np.clip(instants, scene.time.start, scene.time.stop))
