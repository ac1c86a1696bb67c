"""Poses at instants by proven steps from each to the next, in the plainest form."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve.assembly import Pose
from pointcoord.solve.follower import follow
from pointcoord.time_functions import TimeFunction

Array = NDArray[np.float64]


def one_by_one(
    mechanism: Mechanism, functions: Mapping[str, TimeFunction], pose: Pose, times: Array, tolerance: float
) -> Array:
    """The poses y up to the first instant that cannot be reached, shape (n, size)."""
    known = mechanism.known_series({name: f.series(times, 0) for name, f in functions.items()})[:, 0]
    poses, factors = [pose.y], pose.factors
    for goal in known[1:]:
        path = follow(mechanism.map, poses[-1], goal, factors, tolerance)
        if path.done < 1.0:
            break
        poses.append(path.y)
        factors = path.factors
    return np.array(poses)
