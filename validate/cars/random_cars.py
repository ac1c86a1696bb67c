"""Random cars of every mechanism: points moved, mirrored, turned, scaled and displaced.

A car is one that pointcoord reads and solves at its own drawing, and that somebody would draw: where a
closure puts points in place it moves none far. Any other drawing is drawn back towards the base car. A
mechanism some of whose rows follow from others in the drawing, as those of a planar one do, is only mirrored,
turned, scaled and displaced: nothing else is sure to keep them true.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np

from pointcoord import PointcoordError, simulate
from validate.cars.base_cars import Variant, variants
from validate.cars.car import Car, moved, other_side, random_rotation, scaled, turned
from validate.cars.input_ends import at, drawn_inputs
from validate.cars.moved_points import LEFT_OVER, SHARE, Moves, drawn_back, sliding, with_every_point

FIRST = 0.7  # of the cars of a mechanism with several closures are of the first one
# Of the car's size: the most that closing a drawing moves a point. The paper's own strut moves by 0.022;
# drawn much worse, a strut may be nearer to another assembly than to the one that its maker meant.
CLOSED_BY = 0.05
OWN = 0.5  # of the cars have the inputs of their base car's scene


@dataclass(frozen=True)
class RandomCar:
    """A random car with the inputs that drive it.

    Attributes:
        inputs: names; the chassis' own motions are not among them.
        scale: by which the whole car is multiplied.
    """

    variant: Variant
    car: Car
    inputs: tuple[str, ...]
    scale: float


def is_accepted(car: Car, inputs: Collection[str]) -> bool:
    """Whether pointcoord reads the car and solves it near its own drawing."""
    try:
        # Points that coincide make no number, which is no car.
        with np.errstate(all="ignore"):
            solved = simulate(at(car, drawn_inputs(car, inputs)))
            closes = solved.closing.largest <= CLOSED_BY * solved.closing.size
            return closes and float(solved.proof().condition.max()) < np.inf
    except (PointcoordError, ValueError, ArithmeticError):
        return False


def random_car(rng: np.random.Generator) -> RandomCar:
    """A random car of any mechanism, each as often as any other."""
    variant = _variant(rng)
    own, *others = variant.input_sets
    inputs = own if not others or rng.random() < OWN else others[int(rng.integers(len(others)))]
    base = with_every_point(variant.base)
    moves, (scale, put) = _moves(rng, base), _placing(rng, variant)
    if variant.holds_its_shape:
        moves = Moves()
    car = drawn_back(base, moves, lambda there: is_accepted(put(there), inputs))
    return RandomCar(variant, put(car), inputs, scale)


def _variant(rng: np.random.Generator) -> Variant:
    """Every mechanism as often as any other, and its first closure more often than the rest."""
    names = tuple(dict.fromkeys(variant.suspension for variant in variants()))
    name = names[int(rng.integers(len(names)))]
    first, *rest = (variant for variant in variants() if variant.suspension == name)
    return rest[int(rng.integers(len(rest)))] if rest and rng.random() >= FIRST else first


def _moves(rng: np.random.Generator, base: Car) -> Moves:
    """Most points moved by up to a share of the car's size; now and then a point off its line or left out."""
    reach = SHARE * base.size * 10.0 ** rng.uniform(-1.0, 0.0)
    on_lines = sliding(base)
    return Moves(
        points={name: rng.uniform(-reach, reach, 3) for name in base.points},
        slid={name: rng.uniform(-1.0, 1.0) for name in on_lines},
        beside={n: rng.uniform(-LEFT_OVER, LEFT_OVER, 3) for n in on_lines if rng.random() < 0.3},
        without=frozenset(name for name in base.structure.stand_ins if rng.random() < 0.3),
    )


def _placing(rng: np.random.Generator, variant: Variant) -> tuple[float, Callable[[Car], Car]]:
    """By how much a car is scaled, up to a thousand, and what puts it on the other side, turns and moves it.

    Each in one of two.
    """
    mirrored = bool(rng.random() < 0.5) and not variant.of_parts
    scale = 10.0 ** rng.uniform(-3.0, 3.0) if rng.random() < 0.5 else 1.0
    turn = random_rotation(rng) if rng.random() < 0.5 else np.eye(3)
    away = np.zeros(3)
    if rng.random() < 0.5:
        away = rng.normal(size=3)
        away *= scale * 10.0 ** rng.uniform(0.0, 7.0) / np.linalg.norm(away)

    def put(car: Car) -> Car:
        return moved(scaled(turned(other_side(car) if mirrored else car, turn), scale), away)

    return scale, put
