"""The formulations that can be compared, by name."""

from __future__ import annotations

from collections.abc import Callable

from pointcoord.method import NEWTON, SERIES
from validate.extras import MissingPackage
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import Formulation
from validate.paper.printed import PRINTED


class UnknownFormulation(Exception):
    """A name that no formulation has; the message lists those that exist."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"no formulation is called {name!r}; there are: {', '.join(NAMES)}")


_POINT_COORDINATES: dict[str, Formulation] = {
    f.name: f
    for f in (
        PointCoordinates("pointcoord", SERIES),
        PointCoordinates("pointcoord-newton", NEWTON),
        PointCoordinates("printed", PRINTED),
    )
}

WORDS = {
    "pointcoord": "point coordinates, by a chain of power series in time",
    "pointcoord-newton": "point coordinates, by Newton's method at each instant, as the paper does",
    "printed": "the same with the paper's formulas as printed, some of which are wrong",
    "absolute": "poses of rigid bodies (absolute coordinates), with Pinocchio",
    "relative": "a tree of joints with loop closures (relative coordinates), with Pinocchio",
}
"""Every formulation by its name, in words."""

NAMES = tuple(WORDS)


def formulation(name: str) -> Formulation:
    """A formulation by its name. Only the models in Pinocchio need it, and only when they are used.

    Raises:
        UnknownFormulation: no formulation has this name.
        MissingPackage: Pinocchio is not installed, or does not load.
    """
    if name in _POINT_COORDINATES:
        return _POINT_COORDINATES[name]
    if name not in _IN_PINOCCHIO:
        raise UnknownFormulation(name)
    try:
        return _IN_PINOCCHIO[name]()
    except MissingPackage:
        raise
    except ImportError as error:
        raise MissingPackage(name, error) from error


def _absolute() -> Formulation:
    from validate.formulations.absolute_coordinates import AbsoluteCoordinates

    return AbsoluteCoordinates()


def _relative() -> Formulation:
    from validate.formulations.relative_coordinates import RelativeCoordinates

    return RelativeCoordinates()


_IN_PINOCCHIO: dict[str, Callable[[], Formulation]] = {"absolute": _absolute, "relative": _relative}
