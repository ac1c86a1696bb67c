"""The registry of all effects, one line for each group, and the plan of the effects that a scene asks for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pointcoord.effects.car_number import Angle, CarNumbers, Number
from pointcoord.effects.effect import Effect, Quantity
from pointcoord.effects.knuckle_rates import KNUCKLE_RATES
from pointcoord.effects.loads import LOADS
from pointcoord.effects.numbers import CAR_NUMBERS, WAYS, WITH_GRADIENTS, gradients
from pointcoord.effects.point_states import POSITION, RATES
from pointcoord.linkage.slopes import Way
from pointcoord.linkage.topology import Topology

ALWAYS: tuple[Effect, ...] = (POSITION,)
"""The effects that every motion reports."""

EFFECTS: Mapping[str, Effect] = {
    effect.name: effect
    for effect in (
        *RATES,
        KNUCKLE_RATES,
        *WITH_GRADIENTS,
        *(gradients(effect, way) for way in WAYS for effect in WITH_GRADIENTS),
        *(effect for effect in CAR_NUMBERS.values() if effect not in WITH_GRADIENTS),
        LOADS,
    )
}
"""The effects that a scene may list, by name."""

NUMBERS_OF_THE_CAR: Mapping[str, Number] = {
    number.name: number
    for effect in EFFECTS.values()
    if isinstance(effect, CarNumbers)
    for number in effect.numbers
}
"""Numbers of the car by name; for a part's wheel, the part and a dot come before these names."""


def number_called(name: str) -> Number | None:
    """The number of the car with a name, which may be a part's; None if there is no such number."""
    return NUMBERS_OF_THE_CAR.get(name.rpartition(".")[2])


def words_of(name: str) -> str:
    """A number of the car in words, with its part; the name itself if there is no such number."""
    number, part = number_called(name), name.rpartition(".")[0]
    return f"{part} {number.words}".strip() if number else name


ANGLES: Mapping[str, Angle] = {
    name: number for name, number in NUMBERS_OF_THE_CAR.items() if isinstance(number, Angle)
}
"""The numbers that are angles of a line."""


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity for effect in (*ALWAYS, *EFFECTS.values()) for quantity in effect.quantities
}
"""The quantities that a motion can report, in order."""


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
    """The plan for a list of effects, which the scene has checked.

    Args:
        instead: name -> effect that replaces the registry's.
        unreported: points of the car whose states are not reported.
    """
    known, asked = {**EFFECTS, **(instead or {})}, {*effects}
    return Plan((*ALWAYS, *(known[name] for name in EFFECTS if name in asked)), tuple(unreported))
