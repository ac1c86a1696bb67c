"""The formulations that can be compared, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from pointcoord.errors import MissingLibrary
from pointcoord.method import AUTO, CHORD, MAP, NEWTON, NEWTON_COLD
from validate.errors import UsageError
from validate.extras import not_there
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import Formulation
from validate.paper.printed import PRINTED

if TYPE_CHECKING:
    from validate.peers.linkage import Linkage
    from validate.peers.program import Program


_POINT_COORDINATES: dict[str, Formulation] = {
    f.name: f
    for f in (
        PointCoordinates("pointcoord", AUTO),
        PointCoordinates("pointcoord-map", MAP),
        PointCoordinates("pointcoord-newton", NEWTON),
        PointCoordinates("pointcoord-newton-cold", NEWTON_COLD),
        PointCoordinates("pointcoord-chord", CHORD),
        PointCoordinates("pointcoord-as-asked", AUTO, as_asked=True),
        PointCoordinates("printed", PRINTED),
    )
}

WORDS = {
    "pointcoord": "point coordinates, by a chain of power series in time, or by a map where that is too long",
    "pointcoord-map": "the same by a map: series in the inputs, proven in patches along their way",
    "pointcoord-newton": "point coordinates, by Newton's method at each instant, as the paper does",
    "pointcoord-newton-cold": "the same with each instant by itself, from the drawing",
    "pointcoord-chord": "the same with one factorisation kept for many instants",
    "pointcoord-as-asked": "the first again, only as fine as the scene's tolerance asks",
    "printed": "the same with the paper's formulas as printed, some of which are wrong",
    "absolute": "poses of rigid bodies (absolute coordinates), with Pinocchio",
    "relative": "a tree of joints with loop closures (relative coordinates), with Pinocchio",
    "mujoco": "the same suspension in MuJoCo, an outside witness",
    "exudyn": "the same suspension in Exudyn, another one",
    "reference": "exact equations in balls of many digits, rounded to doubles; some hundred times slower",
}
"""Every formulation by its name, in words."""

NAMES = tuple(WORDS)

OUTSIDE = ("mujoco", "exudyn")
"""Other people's programs, which the extra `peers` brings."""


MODELS = {
    "absolute": "validate.formulations.absolute_coordinates.AbsoluteCoordinates",
    "reference": "validate.formulations.many_digits.ManyDigits",
}
PROGRAMS = {
    "relative": "validate.peers.in_pinocchio.InPinocchio",
    "mujoco": "validate.peers.in_mujoco.InMujoco",
    "exudyn": "validate.peers.in_exudyn.InExudyn",
}
"""What makes a linkage a model of a program."""


def formulation(name: str) -> Formulation:
    """A formulation by its name; what it needs is imported when it is used.

    Raises:
        UsageError: no formulation has this name.
        MissingLibrary: a package that it needs is not installed, or does not load.
    """
    if name in _POINT_COORDINATES:
        return _POINT_COORDINATES[name]
    if name not in WORDS:
        raise UsageError(f"no formulation is called {name!r}; there are: {', '.join(NAMES)}")
    try:
        if name in MODELS:
            model: Formulation = _imported(MODELS[name])()
            return model
        from validate.formulations.trees import InTree

        return InTree(name, program_of(name))
    except MissingLibrary:
        raise
    except ImportError as error:
        raise not_there(name, error) from error


def program_of(name: str) -> Callable[[Linkage], Program]:
    """What makes a linkage a model of a program: `relative`, or one of `OUTSIDE`.

    Raises:
        MissingLibrary: the program is not installed, or does not load.
    """
    found: Callable[[Linkage], Program] = _imported(PROGRAMS[name])
    return found


def _imported(path: str) -> Any:
    module, _, name = path.rpartition(".")
    return getattr(import_module(module), name)


def second_there() -> tuple[str, str]:
    """What stands beside pointcoord where nobody names a second one, and why it is not the absolute model.

    There are systems that Pinocchio is not built for; the programs in `OUTSIDE` are, and the reference needs
    none of them.
    """
    why = ""
    for name in ("absolute", *OUTSIDE, "reference"):
        try:
            formulation(name)
        except MissingLibrary as error:
            why = why or str(error)
        else:
            return name, why
    return "absolute", why


def missing(names: Iterable[str]) -> dict[str, str]:
    """Those of some formulations that need a package which is not there, and what to say of each."""
    lacking: dict[str, str] = {}
    for name in dict.fromkeys(names):
        try:
            formulation(name)
        except MissingLibrary as error:
            lacking[name] = str(error)
    return lacking
