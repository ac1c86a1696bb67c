"""The ways that are raced, in the order in which tables show them."""

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
"""The ways of this project's solver; every other way is a contestant."""


def ways_named(names: Sequence[str]) -> tuple[Way, ...]:
    """Some of them, in the order of the registry.

    Raises:
        UnknownName: there is no such way.
    """
    for name in names:
        if name not in NAMES:
            raise UnknownName("way", name, NAMES)
    return tuple(way for way in WAYS if way.name in names)
