"""Poses of a map at the ends of their paths, with the work that they took."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

from pointcoord.numerics.arrays import Array, Indices, Integers
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import Factors


@dataclass(frozen=True)
class Path:
    """How far a pose or a batch of poses followed their paths.

    Attributes:
        y: coordinates, shape (..., size).
        factors: factorisation of C_u at y.
        left: proven distance to the exact assembly, without rounding, where a tolerance ended the correction,
            shape (...,), in units; zero where the correction went on to rounding.
        work: work that the poses took.
        iterations: Newton steps of the last correction, shape (...,).
        done: share of each path that was followed, 1 where the end was reached, shape (...,).
    """

    y: Array
    factors: Factors
    left: Array
    work: Work
    iterations: Integers
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

    def taken(self, members: Indices) -> Self:
        """The paths of some members, by number; one batch dimension."""
        return replace(
            self,
            y=self.y[members],
            factors=self.factors.taken(members),
            left=self.left[members],
            iterations=self.iterations[members],
            done=self.done[members],
        )
