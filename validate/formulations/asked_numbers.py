"""What a scene asks a formulation for: which quantities, of which points, bodies and angles."""

from __future__ import annotations

from collections.abc import Iterable

from pointcoord import Scene
from pointcoord.effects.effect import Effect
from pointcoord.effects.loads import LOADS
from pointcoord.effects.plan import plan_effects
from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES
from pointcoord.linkage.topology import Topology


def asked_numbers(scene: Scene) -> dict[str, tuple[str, ...]]:
    """By quantity, in the order of pointcoord's registry, the names of what the scene's effects give."""
    effects = plan_effects(scene.effects).computed
    return numbers_of(effects, scene.mechanism.topology, scene.reported_points)


def numbers_of(
    effects: Iterable[Effect], topology: Topology, points: tuple[str, ...]
) -> dict[str, tuple[str, ...]]:
    """The same of effects, with all of these points."""
    every = {"point": points, "body": tuple(topology.bodies), "joint": (), "car": ()}
    found: dict[str, tuple[str, ...]] = {}
    for effect in effects:
        for quantity, names in effect.gives_numbers(topology).items():
            named = every[QUANTITIES[quantity].of] if names is None else names
            found[quantity] = tuple(dict.fromkeys((*found.get(quantity, ()), *named)))
    return {quantity: found[quantity] for quantity in QUANTITIES if quantity in found}


def known_names(topology: Topology) -> dict[str, tuple[str, ...]]:
    """By quantity, every name that a number of it can have, whether a scene asks for it or not."""
    return numbers_of((*ALWAYS, *EFFECTS.values()), topology, tuple(topology.points))


def asked_of_the_car(scene: Scene) -> tuple[str, ...]:
    """The names of the numbers of the car that it asks for, of all quantities but forces."""
    asked = asked_numbers(scene).items()
    return tuple(n for q, names in asked if QUANTITIES[q].of == "car" and not is_force(q) for n in names)


def is_force(quantity: str) -> bool:
    """Whether it is one of what loads make."""
    return QUANTITIES[quantity] in LOADS.quantities


def per_second(quantity: str) -> int:
    """How many times a quantity is divided by a time: 1 of a rate, 2 of an acceleration, by its unit."""
    time, _, power = QUANTITIES[quantity].unit.partition("/")[2].partition("^")
    return int(power or 1) if time == "s" else 0
