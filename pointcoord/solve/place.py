"""Poses of a map, and what reaching them took; from a pose to what of it moves, and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors, factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.numerics.partial_map import PartialMap

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Place:
    """One pose or a batch of them.

    Attributes:
        y: coordinates, shape (..., size). factors: of C_u there.
        left: proven distance to the exact assembly, rounding apart, where a tolerance ended the correction,
            shape (...,), in units; zero where it went on to rounding.
        work: what it took.
    """

    y: Array
    factors: Factors
    left: Array
    work: Work

    def taken(self, members: NDArray[np.intp]) -> Self:
        """Some of them, by number; one batch dimension."""
        return replace(self, y=self.y[members], factors=self.factors.taken(members), left=self.left[members])


@dataclass(frozen=True)
class Path(Place):
    """How far a batch of poses followed their paths.

    Attributes:
        iterations: Newton steps that the last correction took, shape (...,).
        done: share of each path, 1 where the end was reached, shape (...,).
    """

    iterations: NDArray[np.int64]
    done: Array

    def reshaped(self, batch: tuple[int, ...]) -> Self:
        """The same with other batch dimensions."""
        return replace(
            self,
            y=self.y.reshape(*batch, self.y.shape[-1]),
            factors=self.factors.reshaped(batch),
            left=self.left.reshape(batch),
            iterations=self.iterations.reshape(batch),
            done=self.done.reshape(batch),
        )

    def taken(self, members: NDArray[np.intp]) -> Self:
        """The paths of some members, by number; one batch dimension."""
        taken = super().taken(members)
        return replace(taken, iterations=self.iterations[members], done=self.done[members])


def starting_place(part: PartialMap, pose: Place) -> Place:
    """A pose as the start of a motion of the part that moves.

    What stands still is solved once more, to rounding, before it is taken as known: nothing corrects it
    later.
    """
    if part.is_whole:
        return Place(pose.y, pose.factors, pose.left, Work())
    y, left, work = pose.y, pose.left, Work()
    if np.any(left > 0.0):
        refined = newton_refine(part.whole, y)
        # Where rounding keeps it from converging the pose is as good as it gets.
        y = np.where(refined.converged[..., None], refined.y, y)
        left = np.where(refined.converged, refined.left, left)
        work = refined.work
    y = part.taken(y)
    members = int(np.prod(y.shape[:-1]))
    return Place(y, factorise(part.system.jacobian(y)), left, work + Work(factorisations=members))


def whole_place(part: PartialMap, y: Array, factors: Factors) -> Place:
    """A place of the part as one of the whole: what stops a motion is told with all that takes part."""
    if part.is_whole:
        return Place(y, factors, np.zeros(y.shape[:-1]), Work())
    whole = part.back(y)
    left, work = np.zeros(y.shape[:-1]), Work(factorisations=int(np.prod(y.shape[:-1])))
    return Place(whole, factorise(part.whole.jacobian(whole)), left, work)
