"""Which equations hold: the strut's axis fixed in the knuckle as drawn, or the paper's straight strut."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import validate.reference.equations as straight
import validate.reference.knuckle_equations as drawn
from validate.reference.equations import Known
from validate.reference.errors import BadInputError
from validate.reference.vectors import Scalar, Vector


class Equations(Protocol):
    """C(y) = 0 of one kind of strut, for every kind of number.

    Attributes:
        LINKS: pairs of points whose drawn distance the equations need.
        SIZE: unknowns, and equations.
        COORDINATES: so many unknowns, the first, are coordinates of points.
        KINGPIN_TOP: the steering axis runs from the ball joint to this point.
    """

    LINKS: tuple[tuple[int, int], ...]
    SIZE: int
    COORDINATES: int
    KINGPIN_TOP: int

    def knuckle_of(self, table: Mapping[int, Vector]) -> dict[int, Vector]:
        """What the equations need of the knuckle as drawn, exact."""

    def residual(self, unknown: Sequence[Scalar], known: Known) -> list[Scalar]:
        """C(y)."""

    def jacobian(self, unknown: Sequence[Scalar], known: Known) -> list[tuple[int, int, Scalar]]:
        """dC/dy as (row, column, entry), zeros left out."""

    def points_of(self, unknown: Sequence[Scalar], known: Known) -> dict[int, Vector]:
        """All points by number."""

    def unknown_of(self, points: Mapping[int, Vector], known: Known) -> list[Scalar]:
        """y of assembled points."""

    def implied(self, points: Mapping[int, Vector], known: Known) -> list[Scalar]:
        """The unknowns that are no coordinates, of assembled points."""

    def knuckle_frame(self, unknown: Sequence[Scalar], known: Known) -> tuple[Vector, Vector]:
        """Two vectors that are fixed in the knuckle and not parallel."""

    def handedness(self, unknown: Sequence[Scalar]) -> Scalar:
        """Positive for an assembly, negative for a zero that mirrors the knuckle."""


CLOSURES: dict[str, Equations] = {"drawn": drawn, "collinear": straight}
DEFAULT = "drawn"


def equations_for(closure: str) -> Equations:
    """The equations of a closure.

    Raises:
        BadInputError: there is no such closure.
    """
    if closure not in CLOSURES:
        raise BadInputError("closure", closure, " or ".join(repr(name) for name in CLOSURES))
    return CLOSURES[closure]
