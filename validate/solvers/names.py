"""Names that a solver's numbers can have, and whether another one is one of them misspelt."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

from pointcoord import Scene
from pointcoord.effects.registry import EFFECTS, QUANTITIES
from validate.formulations.asked_numbers import asked_numbers

ALIKE = 0.8  # of their letters, of names of which one is the other misspelt: "iterations" is no acceleration


def known_names(scene: Scene) -> dict[str, tuple[str, ...]]:
    """By quantity, every name that a number of it can have, whether the scene asks for it or not."""
    topology = scene.mechanism.topology
    every = {"point": topology.points, "body": tuple(topology.bodies), "car": ()}
    asked = asked_numbers(scene)
    found = {q: tuple(dict.fromkeys((*asked.get(q, ()), *every[kind.of]))) for q, kind in QUANTITIES.items()}
    for effect in EFFECTS.values():
        for quantity, names in effect.gives_numbers.items():
            found[quantity] = tuple(dict.fromkeys((*found[quantity], *(names or ()))))
    return found


def misspelt(name: object, known: Collection[str]) -> str:
    """What a name was to be, in words that follow it; empty of a known one, and of what may be another."""
    near = get_close_matches(str(name).lower(), known, n=1, cutoff=ALIKE)
    return f" (did you mean {near[0]!r}?)" if near and name not in known else ""
