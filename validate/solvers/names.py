"""Names that a solver's numbers can have, and whether another one is one of them misspelt."""

from __future__ import annotations

from collections.abc import Collection
from difflib import get_close_matches

from pointcoord.effects.registry import ALWAYS, EFFECTS
from pointcoord.linkage.topology import Topology
from validate.formulations.asked_numbers import numbers_of

ALIKE = 0.8  # of their letters, of names of which one is the other misspelt: "iterations" is no acceleration


def known_names(topology: Topology) -> dict[str, tuple[str, ...]]:
    """By quantity, every name that a number of it can have, whether a scene asks for it or not."""
    return numbers_of((*ALWAYS, *EFFECTS.values()), topology, tuple(topology.points))


def misspelt(name: object, known: Collection[str]) -> str:
    """What a name was to be, in words that follow it; empty of a known one, and of what may be another."""
    near = get_close_matches(str(name).lower(), known, n=1, cutoff=ALIKE)
    return f" (did you mean {near[0]!r}?)" if near and name not in known else ""
