"""Methods: the ways to solve a scene, each as data."""

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
    """A way to solve a scene.

    Attributes:
        name: in results and messages.
        by_series: a chain of power series, dense in time; or poses at each of the scene's instants.
        by_map: series in the inputs along their way, dense in time as well; beside `by_series`, only where a
            chain is too long or no step of it follows an input.
        at_instants: how these are solved for.
        map_effort: factorisations that a map may take at most; as `patches.way_map` has it if not given.
        linkage: what it makes of a scene's linkage, None of one that it does not solve; None if it solves
            every one as it is.
        only: which it solves alone, and why, in words.
        square_velocity_term: the term of the acceleration equation that is quadratic in the velocities;
            series have it in themselves.
        effects: by name, the effects that it computes in another way than others.
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
        """Whether its motions are known between the scene's instants too."""
        return self.by_series or self.by_map

    def __str__(self) -> str:
        return self.name


AUTO = Method("auto", by_series=True, by_map=True)
"""A chain of power series, or a map of the inputs where that is too long or too rough."""

SERIES = Method("series", by_series=True)
"""A chain of power series, dense in time."""

MAP = Method("map", by_map=True)
"""A map of the inputs along their way, dense in time, however long or rough the motion is."""

NEWTON = Method("newton")
"""The paper's algorithm, at the scene's instants only, each from the one before."""

NEWTON_COLD = Method("newton-cold", at_instants=partial(solve_instants, cold=True))
"""The same with each instant by itself, from the drawing."""

CHORD = Method("chord", at_instants=partial(solve_instants, chord=True))
"""The same as `newton` with one factorisation kept for many instants."""

METHODS: Mapping[str, Method] = {
    method.name: method for method in (AUTO, SERIES, MAP, NEWTON, NEWTON_COLD, CHORD)
}


def method_of(name: Method | str) -> Method:
    """A method by its name, or itself.

    Raises:
        UnknownName: there is no such method.
    """
    if isinstance(name, Method):
        return name
    if name not in METHODS:
        raise UnknownName("method", name, METHODS)
    return METHODS[name]
