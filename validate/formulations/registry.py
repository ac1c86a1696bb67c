"""The formulations that can be compared, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from pointcoord.errors import MissingLibrary
from pointcoord.method import AUTO, CHORD, MAP, NEWTON, NEWTON_COLD
from validate.errors import UsageError
from validate.extras import needed
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import Formulation
from validate.paper.printed import PRINTED

if TYPE_CHECKING:
    from validate.peers.program import Program
    from validate.spanning_tree.tree import SpanningTree


WORDS = {
    "pointcoord": "point coordinates, by a chain of power series in time, or a map if the chain is too long",
    "pointcoord-map": "point coordinates, by a map: series in the inputs, proven in patches along their path",
    "pointcoord-newton": "point coordinates, by Newton's method at each instant, as in the paper",
    "pointcoord-newton-cold": "as pointcoord-newton, but each instant starts from the drawing",
    "pointcoord-chord": "as pointcoord-newton, but one factorisation serves many instants",
    "pointcoord-as-asked": "as pointcoord, but only to the tolerance of the scene",
    "printed": "as pointcoord-newton, with the paper's formulas as printed, some of which are wrong",
    "absolute": "poses of rigid bodies (absolute coordinates), with Pinocchio",
    "relative": "a tree of joints with loop closures (relative coordinates), with Pinocchio",
    "mujoco": "a tree of joints with loop closures, in MuJoCo, an independent program",
    "exudyn": "a tree of joints with loop closures, in Exudyn, an independent program",
    "reference": "exact equations in balls of many digits, rounded to doubles; some hundred times slower",
}
"""Description of every formulation, by name."""

NAMES = tuple(WORDS)

OUTSIDE = ("mujoco", "exudyn")
"""Formulations that use programs of others; the extra `peers` installs the programs."""

AS_ASKED = "pointcoord-as-asked"
METHODS = {
    "pointcoord": AUTO,
    "pointcoord-map": MAP,
    "pointcoord-newton": NEWTON,
    "pointcoord-newton-cold": NEWTON_COLD,
    "pointcoord-chord": CHORD,
    AS_ASKED: AUTO,
    "printed": PRINTED,
}
"""Method of each formulation in point coordinates."""
MODELS = {
    "absolute": ("validate.formulations.absolute_coordinates", "AbsoluteCoordinates"),
    "reference": ("validate.formulations.reference_solution", "ManyDigits"),
}
"""Module and class of the models with a formulation of their own."""
PROGRAMS = {
    "relative": ("validate.peers.in_pinocchio", "InPinocchio"),
    "mujoco": ("validate.peers.in_mujoco", "InMujoco"),
    "exudyn": ("validate.peers.in_exudyn", "InExudyn"),
}
"""Module and class of each program's model of a tree."""


def formulation(name: str) -> Formulation:
    """A formulation by its name; the packages that it needs are imported now.

    Raises:
        UsageError: no formulation has this name.
        MissingLibrary: a package that the formulation needs is not installed, or does not load.
    """
    if name in METHODS:
        return PointCoordinates(name, METHODS[name], as_asked=name == AS_ASKED)
    if name not in WORDS:
        raise UsageError(f"no formulation is called {name!r}; there are: {', '.join(NAMES)}")
    if name in PROGRAMS:
        tree: Formulation = needed(name, "validate.formulations.trees").InTree(name, program_of(name))
        return tree
    module, of = MODELS[name]
    model: Formulation = getattr(needed(name, module), of)()
    return model


def program_of(name: str) -> Callable[[SpanningTree], Program]:
    """The class of a program's model of a tree, for `relative` or one of `OUTSIDE`.

    Raises:
        MissingLibrary: the program is not installed, or does not load.
    """
    module, of = PROGRAMS[name]
    found: Callable[[SpanningTree], Program] = getattr(needed(name, module), of)
    return found


def missing(names: Iterable[str]) -> dict[str, str]:
    """The formulations among `names` whose packages are not installed, each with the message."""
    absent: dict[str, str] = {}
    for name in names:
        try:
            formulation(name)
        except MissingLibrary as error:
            absent[name] = str(error)
    return absent


def second_there() -> tuple[str, str]:
    """The default second formulation, and the reason if it is not the absolute model.

    Pinocchio is not built for all operating systems. The programs in `OUTSIDE` are, and the reference needs
    none of them.
    """
    why = missing(["absolute"]).get("absolute", "")
    return next(
        (name for name in ("absolute", *OUTSIDE, "reference") if not missing([name])), "absolute"
    ), why
