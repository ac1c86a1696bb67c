"""A type of suspension: its name and the ways in which its drawing can be closed."""

from __future__ import annotations

from collections.abc import Mapping

from pointcoord.data_classes import dataclass
from pointcoord.linkage.topology import Topology


@dataclass(frozen=True)
class Suspension:
    """A type of suspension.

    Attributes:
        type: the name that a scene gives it.
        closures: its topology for each way to close a drawing. "drawn" takes the drawing as it stands and is
            what a scene means that names none; others put points in place.
    """

    type: str
    closures: Mapping[str, Topology]

    @property
    def points(self) -> tuple[str, ...]:
        """Every point that a car of this type may have, whatever its closure."""
        return tuple(dict.fromkeys(name for topology in self.closures.values() for name in topology.points))
