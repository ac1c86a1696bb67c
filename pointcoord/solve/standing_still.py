"""From a pose of a mechanism to what of it moves, and back.

What stands still is solved once more, to rounding, before it is taken as known: nothing corrects it later.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.partial_map import PartialMap
from pointcoord.solve.assembly import Pose

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PartialPlace:
    """A pose in the coordinates of a part of its map, or the other way round.

    Attributes:
        y: shape (..., size). factors: of the Jacobian there by what is unknown.
        left: proven distance to the exact assembly, rounding apart, shape (...,).
        work: what it took.
    """

    y: Array
    factors: Factors
    left: Array
    work: Work


def starting_place(part: PartialMap, pose: Pose) -> PartialPlace:
    """A pose as the start of a motion of the part that moves."""
    if part.is_whole:
        return PartialPlace(pose.y, pose.factors, pose.left, Work())
    y, left, work = pose.y, pose.left, Work()
    if np.any(left > 0.0):
        refined = newton_refine(part.whole, y)
        # Where rounding keeps it from converging the pose is as good as it gets.
        y = np.where(refined.converged[..., None], refined.y, y)
        left = np.where(refined.converged, refined.left, left)
        work = refined.work
    y = part.taken(y)
    members = int(np.prod(y.shape[:-1]))
    return PartialPlace(y, factorise(part.system.jacobian(y)), left, work + Work(factorisations=members))


def whole_place(part: PartialMap, y: Array, factors: Factors) -> PartialPlace:
    """A place of the part as one of the whole: what stops a motion is told with all that takes part."""
    if part.is_whole:
        return PartialPlace(y, factors, np.zeros(y.shape[:-1]), Work())
    whole = part.back(y)
    members = int(np.prod(y.shape[:-1]))
    return PartialPlace(
        whole,
        factorise(part.whole.jacobian(whole)),
        np.zeros(y.shape[:-1]),
        Work(factorisations=members),
    )
