"""The ways that are raced: a line for each family."""

from __future__ import annotations

from collections.abc import Iterable

from pointcoord import UnknownName
from validate.cost.way import Way
from validate.cost.ways import (
    absolute,
    differences,
    peers,
    point_coordinates,
    printed,
    relative,
    scipy_solvers,
)

WAYS: tuple[Way, ...] = (
    *point_coordinates.WAYS,
    *differences.WAYS,
    *printed.WAYS,
    *absolute.WAYS,
    *relative.WAYS,
    *scipy_solvers.WAYS,
    *peers.WAYS,
)
"""All of them, in the order in which tables show them. Optional packages are imported when they are used."""


def ways_named(names: Iterable[str]) -> tuple[Way, ...]:
    """Some of them, in the order of the registry.

    Raises:
        UnknownName: there is no such way.
    """
    known = {way.name: way for way in WAYS}
    asked = set(names)
    for name in names:
        if name not in known:
            raise UnknownName("way", name, known)
    return tuple(way for way in WAYS if way.name in asked)
