"""Solution methods, each described by a data class."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial

from pointcoord.effects.effect import Effect
from pointcoord.errors import UnknownName
from pointcoord.linkage.topology import Topology
from pointcoord.solve.pointwise import (
    InstantSolver,
    SquareVelocityTerm,
    solve_instants,
    square_velocity_term,
)


@dataclass(frozen=True)
class Method:
    """A solution method.

    Attributes:
        name: in results and messages.
        by_series: whether it builds a chain of power series, dense in time.
        by_map: whether it builds series in the inputs along their path, dense in time as well. With
            `by_series`, used only where a chain is too long or no step of the chain follows an input.
        at_instants: solver at the scene's instants, used without `by_series` and `by_map`.
        map_effort: most factorisations for a map; the limit of `patches.way_map` if None.
        linkage: converts a scene's linkage to one that the method solves, or to None if it cannot; None if
            the method solves every linkage as it is.
        only: which linkages it solves, and why only these, in words.
        square_velocity_term: the term of the acceleration equation that is quadratic in the velocities;
            series include this term already.
        effects: by name, the effects that this method computes differently.
    """

    name: str
    by_series: bool = False
    by_map: bool = False
    at_instants: InstantSolver = solve_instants
    map_effort: int | None = None
    linkage: Callable[[Topology], Topology | None] | None = None
    only: str = ""
    square_velocity_term: SquareVelocityTerm = square_velocity_term
    effects: Mapping[str, Effect] = field(default_factory=dict)

    @property
    def dense(self) -> bool:
        """Whether its motions are also known between the scene's instants."""
        return self.by_series or self.by_map

    def __str__(self) -> str:
        return self.name


AUTO = Method("auto", by_series=True, by_map=True)
"""A chain of power series, or a map of the inputs where the chain is too long or the motion too rough."""

SERIES = Method("series", by_series=True)
"""A chain of power series, dense in time."""

MAP = Method("map", by_map=True)
"""A map of the inputs along their way, dense in time, however long or rough the motion is."""

NEWTON = Method("newton")
"""The paper's algorithm, at the scene's instants only, starting each instant from the one before."""

NEWTON_COLD = Method("newton-cold", at_instants=partial(solve_instants, cold=True))
"""As `newton`, but each instant starts from the drawing."""

CHORD = Method("chord", at_instants=partial(solve_instants, chord=True))
"""As `newton`, but one factorisation is kept for many instants."""

METHODS: Mapping[str, Method] = {
    method.name: method for method in (AUTO, SERIES, MAP, NEWTON, NEWTON_COLD, CHORD)
}


def method_of(name: Method | str) -> Method:
    """The method of a name; a `Method` is returned as it is.

    Raises:
        UnknownName: there is no such method.
    """
    if isinstance(name, Method):
        return name
    if name not in METHODS:
        raise UnknownName("method", name, METHODS)
    return METHODS[name]
