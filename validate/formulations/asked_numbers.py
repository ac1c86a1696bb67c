"""The numbers that a scene asks a formulation for: names of points, bodies and angles by quantity."""

from __future__ import annotations

from collections.abc import Iterable

from pointcoord import Scene
from pointcoord.effects.effect import Effect
from pointcoord.effects.loads import LOADS
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES, plan_effects
from pointcoord.linkage.topology import Topology


def asked_numbers(scene: Scene) -> dict[str, tuple[str, ...]]:
    """The names that the scene's effects give, by quantity, in the order of pointcoord's registry."""
    effects = plan_effects(scene.effects).computed
    return numbers_of(effects, scene.mechanism.topology, scene.reported_points)


def numbers_of(
    effects: Iterable[Effect], topology: Topology, points: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    """The names that the given effects give, by quantity; quantities of points give all `points`."""
    every = {"point": points, "body": tuple(topology.bodies), "joint": (), "car": ()}
    found: dict[str, tuple[str, ...]] = {}
    for effect in effects:
        for quantity, names in effect.gives_numbers(topology).items():
            named = every[QUANTITIES[quantity].of] if names is None else names
            found[quantity] = tuple(dict.fromkeys((*found.get(quantity, ()), *named)))
    return {quantity: found[quantity] for quantity in QUANTITIES if quantity in found}


def known_names(topology: Topology) -> dict[str, tuple[str, ...]]:
    """All possible names by quantity, whether a scene asks for them or not."""
    return numbers_of((*ALWAYS, *EFFECTS.values()), topology, tuple(topology.points))


def asked_of_the_car(scene: Scene) -> tuple[str, ...]:
    """The names of the numbers of the car that a scene asks for, without forces."""
    asked = asked_numbers(scene).items()
    return tuple(n for q, names in asked if QUANTITIES[q].of == "car" and not is_force(q) for n in names)


def is_force(quantity: str) -> bool:
    """Whether a quantity is one of the forces that loads cause."""
    return QUANTITIES[quantity] in LOADS.quantities


def per_second(quantity: str) -> int:
    """The power of time in the divisor of a quantity's unit: 1 for a rate, 2 for an acceleration."""
    time, _, power = QUANTITIES[quantity].unit.partition("/")[2].partition("^")
    return int(power or 1) if time == "s" else 0
