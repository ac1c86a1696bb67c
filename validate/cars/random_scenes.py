"""Random scenes by number: a number gives the same scene on every machine.

All mechanisms are equally likely; the first of several closures has probability 0.7. The whole car is
mirrored, turned, moved and scaled. Inputs are any set that the mechanism allows, with laws of every kind,
from slow and small to fast and large. Some scenes come close to a singular pose: near the end of an input, or
drawn there.

The recipe has the seed 20261123: cars are perturbed base cars of every shipped mechanism. (Recipes up to
20261122 had only struts and double wishbones, each with its own recipe.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from pointcoord import PointcoordError, Scene
from validate.cars.base_cars import Variant
from validate.cars.car import content_of
from validate.cars.input_ends import Inputs, drawn_inputs, end, redrawn
from validate.cars.random_cars import RandomCar, random_car

Kind = Literal["regular", "near an end", "singular drawing"]
Random = np.random.Generator
Times = tuple[float, float]
"""Start and stop, s."""
KINDS: tuple[Kind, ...] = ("regular", "near an end", "singular drawing")
SHARES = (0.88, 0.09, 0.03)  # probabilities of the kinds
SEED = 20261123  # to be changed with the recipe: records of studies contain it
NEAREST = -12.0  # exponent of the least distance from a singular pose, as a share of the path to it
# Ranges of inputs, rad and shares of the car's size: offset from the drawing, motion by laws, chassis.
OFFSET, LARGEST, HEAVED = (0.25, 0.04), (0.5, 0.12), (0.3, 0.4)


@dataclass(frozen=True)
class RandomScene:
    """A scene with its number, its mechanism, and its kind."""

    number: int
    variant: Variant
    kind: Kind
    scene: Scene


def random_scene(number: int) -> RandomScene:
    """The random scene of a number, 0 or more. If no input has an end, its kind is `regular`."""
    rng = np.random.default_rng([SEED, number])
    kind: Kind = KINDS[int(rng.choice(len(KINDS), p=SHARES))]
    drawn = random_car(rng)
    home, driven, last = drawn_inputs(drawn.car, drawn.inputs), "", 0.0
    if kind != "regular":
        driven, last = _some_end(rng, drawn, home)
        kind = kind if driven else "regular"
    if kind == "singular drawing":
        drawn, home = _drawn_near(rng, drawn, home, driven, last)
    duration = 10.0 ** rng.uniform(-3.0, 2.0)
    start = float(rng.choice([0.0, rng.uniform(-duration, duration)]))
    times = start, start + duration
    if kind == "near an end":
        laws: dict[str, Any] = {name: {"constant": value} for name, value in home.items()}
        laws[driven] = _approach(rng, home[driven], last, times)
    else:
        laws = {name: _about(rng, drawn, name, value, LARGEST, times) for name, value in home.items()}
    for name in drawn.variant.chassis_motions:
        if rng.random() < 0.5:
            laws[name] = _about(rng, drawn, name, 0.0, HEAVED, times)
    tolerance, title = 1e-9 * drawn.scale, f"random car {number}"
    content = content_of(drawn.car, laws, start=start, stop=times[1], tolerance=tolerance, title=title)
    return RandomScene(number, drawn.variant, kind, Scene.from_mapping(content))


def _some_end(rng: Random, drawn: RandomCar, home: Inputs) -> tuple[str, float]:
    """A random input and one of its ends, with the others as drawn; an empty name if no input has an end."""
    ways = [(name, ahead) for name in drawn.inputs for ahead in (False, True)]
    for place in rng.permutation(len(ways)):
        driven, ahead = ways[int(place)]
        try:
            last = end(drawn.car, home, driven, ahead)
        except PointcoordError:
            continue
        if last is not None:
            return driven, last.value
    return "", 0.0


def _drawn_near(
    rng: Random, drawn: RandomCar, home: Inputs, driven: str, last: float
) -> tuple[RandomCar, Inputs]:
    """The car redrawn near an end, and its inputs there, at the first distance that can be solved."""
    left = 10.0 ** rng.uniform(NEAREST, -1.0)
    while True:
        try:
            there = redrawn(drawn.car, home | {driven: last + left * (home[driven] - last)})
            return replace(drawn, car=there), drawn_inputs(there, drawn.inputs)
        except PointcoordError:
            if left == 1.0:
                return drawn, home
            left = min(10.0 * left, 1.0)


def _about(
    rng: Random, drawn: RandomCar, name: str, value: float, largest: tuple[float, float], times: Times
) -> dict[str, Any]:
    """A random law about a value, or about one offset from it, that moves by up to `largest`, often much
    less.
    """
    middle = value + float(rng.choice([0.0, rng.uniform(-1.0, 1.0)])) * drawn.car.room(name, OFFSET)
    reach = drawn.car.room(name, largest) * 10.0 ** rng.uniform(-5.0, 0.0)
    (start, stop), duration = times, times[1] - times[0]
    kind = rng.choice(["constant", "polynomial", "sine", "table"])
    if kind == "constant":
        return {"constant": middle}
    if kind == "polynomial":
        moves = [reach * rng.uniform(-1.0, 1.0) / duration**k for k in range(1, int(rng.integers(2, 5)))]
        return {"polynomial": [middle, *moves]}
    if kind == "sine":
        wave = {"amplitude": reach * rng.uniform(-1.0, 1.0), "phase": rng.uniform(-3.0, 3.0)}
        return {"sine": {**wave, "angular_frequency": rng.uniform(0.1, 4.0) / duration, "offset": middle}}
    count = int(rng.integers(4, 7))
    inner = np.arange(1, count - 1) + rng.uniform(-0.3, 0.3, count - 2)
    instants = [start, *(start + duration * inner / (count - 1)).tolist(), stop]
    return {"table": {"times": instants, "values": (middle + reach * rng.uniform(-1.0, 1.0, count)).tolist()}}


def _approach(rng: Random, drawn: float, limit: float, times: Times) -> dict[str, Any]:
    """A law from the drawn value to near a limit; one in ten goes past the limit."""
    left = 10.0 ** rng.uniform(NEAREST, -1.0) * float(rng.choice([1.0, -1.0], p=[0.9, 0.1]))
    end = limit + left * (drawn - limit)
    kind = rng.choice(["held", "straight", "sine"])
    if kind == "held":
        return {"constant": end}
    begin = end + rng.uniform(0.1, 1.0) * (drawn - end)
    if kind == "straight":
        # A table, because its last value is exactly `end`, unlike that of a polynomial.
        return {
            "table": {"times": np.linspace(*times, 4).tolist(), "values": np.linspace(begin, end, 4).tolist()}
        }
    # A quarter of a sine wave: at rest at `begin`, with its largest rate at `end`.
    speed = 0.5 * math.pi / (times[1] - times[0])
    wave = {"amplitude": begin - end, "angular_frequency": speed, "phase": math.pi - speed * times[1]}
    return {"sine": {**wave, "offset": end}}
