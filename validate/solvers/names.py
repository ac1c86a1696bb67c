"""Names that a solver's numbers can have, and whether another one is one of them misspelt."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

from pointcoord.effects.registry import ALWAYS, EFFECTS, QUANTITIES
from pointcoord.linkage.topology import Topology

ALIKE = 0.8  # of their letters, of names of which one is the other misspelt: "iterations" is no acceleration


def known_names(topology: Topology) -> dict[str, tuple[str, ...]]:
    """By quantity, every name that a number of it can have, whether a scene asks for it or not."""
    every = {"point": topology.points, "body": tuple(topology.bodies), "car": ()}
    found: dict[str, tuple[str, ...]] = {}
    for effect in (*ALWAYS, *EFFECTS.values()):
        for quantity, names in effect.gives_numbers(topology).items():
            there = every[QUANTITIES[quantity].of] if names is None else names
            found[quantity] = tuple(dict.fromkeys((*found.get(quantity, ()), *there)))
    return found


def misspelt(name: object, known: Collection[str]) -> str:
    """What a name was to be, in words that follow it; empty of a known one, and of what may be another."""
    near = get_close_matches(str(name).lower(), known, n=1, cutoff=ALIKE)
    return f" (did you mean {near[0]!r}?)" if near and name not in known else ""
