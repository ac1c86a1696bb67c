"""The plan of a scene: which effects are computed, and which points and derivatives they need."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pointcoord.effects.effect import Effect
from pointcoord.effects.registry import ALWAYS, EFFECTS
from pointcoord.errors import UnknownName
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology


@dataclass(frozen=True)
class Plan:
    """The effects to compute.

    Attributes:
        computed: effects that are always computed, then the requested ones, in the registry's order.
        unreported: points of the car whose states are not reported.
    """

    computed: tuple[Effect, ...]
    unreported: tuple[str, ...] = ()

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the requested effects."""
        return tuple(effect.name for effect in self.computed if effect.name in EFFECTS)

    @property
    def left_out(self) -> tuple[str, ...]:
        return tuple(name for name in EFFECTS if name not in self.effects)

    def lacking(self, quantity: str, topology: Topology) -> dict[str, tuple[str, ...] | None]:
        """Names of a quantity that each effect left out would add; None for every point or every body."""
        gives = {name: EFFECTS[name].gives_numbers(topology) for name in self.left_out}
        return {name: each[quantity] for name, each in gives.items() if quantity in each}

    @property
    def derivative(self) -> int:
        """Highest time derivative to be solved for, over all points."""
        return max(effect.derivative for effect in self.computed)

    @property
    def along_ways(self) -> bool:
        return any(effect.way for effect in self.computed)

    def ways(self, topology: Topology) -> tuple[Way, ...]:
        return tuple(dict.fromkeys(way for effect in self.computed for way in effect.ways(topology)))

    def reported(self, topology: Topology) -> tuple[str, ...]:
        """The points whose states are reported, in the topology's order."""
        return tuple(name for name in topology.points if name not in self.unreported)

    def derivatives(self, topology: Topology) -> dict[str, int]:
        """Highest time derivative to be evaluated of each point that is reported or needed."""
        found: dict[str, int] = {}
        for effect in self.computed:
            points = self.reported(topology) if effect.reports_states else effect.needs(topology)
            for point in points:
                found[point] = max(found.get(point, 0), effect.derivative)
        return {point: found[point] for point in topology.points if point in found}


def plan_effects(
    effects: Iterable[str],
    instead: Mapping[str, Effect] | None = None,
    unreported: Iterable[str] = (),
) -> Plan:
    """The plan for a list of effects.

    Args:
        instead: name -> effect that replaces the registry's.
        unreported: points of the car whose states are not reported.
    Raises:
        UnknownName: an effect that does not exist.
    """
    asked = tuple(effects)
    for name in asked:
        if name not in EFFECTS:
            raise UnknownName("effect", name, EFFECTS)
    known = {**EFFECTS, **(instead or {})}
    computed = (*ALWAYS, *(known[name] for name in EFFECTS if name in asked))
    return Plan(computed, tuple(unreported))
