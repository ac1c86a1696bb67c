"""The methods of the study, in the order of the tables."""

from __future__ import annotations

from collections.abc import Sequence

from pointcoord import UnknownName
from validate.cost.way import Way
from validate.cost.ways import absolute, peers, point_coordinates, scipy_solvers

WAYS: tuple[Way, ...] = (
    *point_coordinates.WAYS,
    *absolute.WAYS,
    *scipy_solvers.WAYS,
    *peers.WAYS,
)
NAMES = tuple(way.name for way in WAYS)
OURS = tuple(way.name for way in point_coordinates.WAYS)
"""The methods of pointcoord; all others are competitors."""


def ways_named(names: Sequence[str]) -> tuple[Way, ...]:
    """The methods with these names, in the order of the registry.

    Raises:
        UnknownName: there is no such method.
    """
    for name in names:
        if name not in NAMES:
            raise UnknownName("way", name, NAMES)
    return tuple(way for way in WAYS if way.name in names)
