"""What a proof needs of a solution, whichever way it was found."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from pointcoord.bounds.enclosed_rates import Summed

Array = NDArray[np.float64]


class SolvedCoordinates(Protocol):
    """The coordinates of a linkage and their time derivatives, as they were solved for."""

    def coordinates(self, instants: Array, derivatives: int) -> list[Array]:
        """y and its derivatives up to one, or as many as were solved for, each (N, size), units per s^d.

        Args:
            instants: shape (N,), s; they do not decrease.
        """
        ...

    def summed(self, instants: Array) -> Sequence[Summed]:
        """How each of these was summed from a series; empty if they were solved for at the instants."""
        ...

    def pieces(self, instants: Array) -> NDArray[np.intp]:
        """Number of the series that each instant is summed from, (N,); of those that were solved for any."""
        ...

    def unsolved(self, instants: Array) -> Array:
        """How far from its assembly each pose was left because no more was asked, proven, in units, (N,).

        Rounding, and what a series leaves out, are apart.
        """
        ...
