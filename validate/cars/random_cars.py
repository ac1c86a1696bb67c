"""Random cars: any suspension on either side, scaled, turned and moved, some made to lock in one way."""

from __future__ import annotations

from typing import Literal

import numpy as np

from validate.cars.car import Car, as_tuples, other_side, placed
from validate.cars.registry import SUSPENSIONS, Variant
from validate.cars.suspension import LEFT_OVER, REACH

# What a car, or a motion of it, comes close to: "upper lock" is that of the knuckle's upper end, the slide of
# a strut or the upper arm of a double wishbone.
Kind = Literal["regular", "dead arm", "toggle", "upper lock", "singular drawing"]
KINDS: tuple[Kind, ...] = ("regular", "dead arm", "toggle", "upper lock", "singular drawing")
FIRST = 0.7  # of the cars of a suspension with several closures are of the first one
NEAREST = -12.0  # decades: how near to a singular pose, as a share of the whole way to it


def random_variant(rng: np.random.Generator) -> Variant:
    """Every suspension as often as any other, and its first closure more often than the rest."""
    types = tuple(SUSPENSIONS)
    suspension = SUSPENSIONS[types[int(rng.integers(len(types)))]]
    first, *rest = suspension.closures
    if rest and rng.random() >= FIRST:
        return Variant(suspension.name, rest[int(rng.integers(len(rest)))])
    return Variant(suspension.name, first)


def random_car(rng: np.random.Generator, kind: Kind) -> tuple[Car, float]:
    """A random car, and its scale.

    Args:
        kind: which of its locks a motion of it must be able to reach. The upper end of a suspension locks
            as it is drawn first: a collinear strut's slide never runs out.
    """
    variant = random_variant(rng)
    suspension = SUSPENSIONS[variant.suspension]
    if kind == "upper lock":
        variant = Variant(suspension.name, suspension.closures[0])
    drawn = suspension.drawing(rng.uniform, variant.closure, REACH, LEFT_OVER)
    if kind == "upper lock":
        drawn = suspension.with_upper_lock(rng.uniform, drawn)
    if kind == "dead arm":
        drawn = suspension.with_arm_lock(rng.uniform, drawn)
    if kind == "singular drawing":
        nearly = suspension.nearly_singular[variant.closure]
        left = 10.0 ** rng.uniform(NEAREST, -1.0)
        drawn = nearly[str(rng.choice(list(nearly)))](rng, drawn, left)
    car = Car(as_tuples(drawn), "left", closure=variant.closure, suspension=variant.suspension)
    return placed(rng, other_side(car) if rng.random() < 0.5 else car)
