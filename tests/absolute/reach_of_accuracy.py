"""How far off numbers of a motion may be by the accuracy that it states, by its condition number alone."""

import numpy as np
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]


def off(motion: absolute.Solution) -> Array:
    """(N,) mm: points that miss their rows by the accuracy lie within so many times that."""
    assert motion.condition is not None
    return np.asarray(motion.accuracy * motion.condition)
