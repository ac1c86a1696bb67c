"""Poses of a map with the work that they took; a pose reduced to the part that moves, and back."""

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
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y.
        left: proven distance to the exact assembly, without rounding, where a tolerance ended the correction,
            shape (...,), in units; zero where the correction went on to rounding.
        work: work that the poses took.
    """

    y: Array
    factors: Factors
    left: Array
    work: Work

    def taken(self, members: NDArray[np.intp]) -> Self:
        """The poses of some members, by number; one batch dimension."""
        return replace(self, y=self.y[members], factors=self.factors.taken(members), left=self.left[members])


@dataclass(frozen=True)
class Path(Place):
    """How far a batch of poses followed their paths.

    Attributes:
        iterations: Newton steps of the last correction, shape (...,).
        done: share of each path that was followed, 1 where the end was reached, shape (...,).
    """

    iterations: NDArray[np.int64]
    done: Array

    def reshaped(self, batch: tuple[int, ...]) -> Self:
        """The paths with other batch dimensions."""
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
    """A pose reduced to the part that moves, as the start of a motion.

    If the pose was corrected to a tolerance only, the whole pose is first corrected to rounding: nothing
    corrects the part that stands still later.
    """
    if part.is_whole:
        return Place(pose.y, pose.factors, pose.left, Work())
    y, left, work = pose.y, pose.left, Work()
    if np.any(left > 0.0):
        refined = newton_refine(part.whole, y)
        # Where rounding prevents convergence the pose cannot be improved.
        y = np.where(refined.converged[..., None], refined.y, y)
        left = np.where(refined.converged, refined.left, left)
        work = refined.work
    y = part.taken(y)
    members = int(np.prod(y.shape[:-1]))
    return Place(y, factorise(part.system.jacobian(y)), left, work + Work(factorisations=members))


def whole_place(part: PartialMap, y: Array, factors: Factors) -> Place:
    """A pose of the part as a pose of the whole, so that an error can name every link that stops a motion."""
    if part.is_whole:
        return Place(y, factors, np.zeros(y.shape[:-1]), Work())
    whole = part.back(y)
    left, work = np.zeros(y.shape[:-1]), Work(factorisations=int(np.prod(y.shape[:-1])))
    return Place(whole, factorise(part.whole.jacobian(whole)), left, work)
