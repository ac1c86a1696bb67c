"""Random scenes by number: the same number is the same scene, on every machine and in every run.

Every suspension comes up as often as any other; of the struts seven in ten are as drawn, the others
collinear. The whole car is mirrored, turned, moved and scaled. Inputs are of every kind and go from slow and
small to fast and large. A share of the scenes comes close to a singular pose: the arm at its dead point, tie
rod and steering arm in line, what holds the knuckle's upper end locked, or a drawing that is itself nearly
singular.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from pointcoord import Scene
from validate.cars.input_limits import Linkage
from validate.cars.random_cars import KINDS, NEAREST, Kind, random_car
from validate.cars.registry import Variant
from validate.cars.scene_content import scene_content

SHARES = (0.88, 0.035, 0.035, 0.03, 0.02)  # of the kinds
SEED = 20261122  # another recipe for the scenes takes another seed: a store of results keeps it


@dataclass(frozen=True)
class RandomScene:
    """A scene with its number, its kind of suspension, and what it was made to come near to."""

    number: int
    variant: Variant
    kind: Kind
    scene: Scene


def random_scene(number: int, samples: int = 3) -> RandomScene:
    """The random scene of a number, from zero up."""
    rng = np.random.default_rng([SEED, number])
    kind: Kind = KINDS[int(rng.choice(len(KINDS), p=SHARES))]
    car, scale = random_car(rng, kind)
    duration = 10.0 ** rng.uniform(-3.0, 2.0)
    start = float(rng.choice([0.0, rng.uniform(-duration, duration)]))
    laws = _inputs(rng, kind, Linkage.of(car), scale, start, start + duration)
    content = scene_content(
        car,
        **laws,
        start=start,
        stop=start + duration,
        samples=samples,
        tolerance=1e-9 * scale,
        title=f"random car {number}",
    )
    return RandomScene(number, Variant.of(car), kind, Scene.from_mapping(content))


def _inputs(
    rng: np.random.Generator, kind: Kind, linkage: Linkage, scale: float, start: float, stop: float
) -> dict[str, Any]:
    angle, travel = linkage.drawn_angle, linkage.drawn_rack
    middle = angle + float(rng.choice([0.0, rng.uniform(-0.25, 0.25)]))
    inputs = {
        "arm_angle": _law(rng, middle, 0.5, start, stop),
        "rack": _law(rng, rng.uniform(-20.0, 20.0) * scale, 60.0 * scale, start, stop),
    }
    if kind == "dead arm":
        inputs["arm_angle"] = _approach(rng, angle, float(rng.choice(linkage.dead_points())), start, stop)
    if kind == "toggle":
        held = min(max(middle, 0.0), math.pi)
        if ends := linkage.ends({"arm_angle": held, "rack": travel}, "rack"):
            inputs["arm_angle"] = {"constant": held}
            inputs["rack"] = _approach(rng, travel, float(rng.choice([end for end, _ in ends])), start, stop)
    if kind == "upper lock":
        ends = linkage.ends(linkage.home, "arm_angle")
        if locked := [end for end, lock in ends if lock == linkage.suspension.upper_lock]:
            inputs["arm_angle"] = _approach(rng, angle, float(rng.choice(locked)), start, stop)
            inputs["rack"] = {"constant": travel}
    if rng.random() < 0.5:
        inputs["heave"] = _law(rng, rng.uniform(-30.0, 30.0) * scale, 200.0 * scale, start, stop)
    return inputs


def _law(
    rng: np.random.Generator, middle: float, largest: float, start: float, stop: float
) -> dict[str, Any]:
    """An input about `middle` that moves by up to about `largest` from start to stop, often much less."""
    reach, duration = largest * 10.0 ** rng.uniform(-5.0, 0.0), stop - start
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
    times = [start, *(start + duration * inner / (count - 1)).tolist(), stop]
    return {"table": {"times": times, "values": (middle + reach * rng.uniform(-1.0, 1.0, count)).tolist()}}


def _approach(
    rng: np.random.Generator, start_value: float, limit: float, start: float, stop: float
) -> dict[str, Any]:
    """An input that goes from its drawn value close to a limit, by one time in ten past it."""
    left = 10.0 ** rng.uniform(NEAREST, -1.0) * float(rng.choice([1.0, -1.0], p=[0.9, 0.1]))
    end = limit + left * (start_value - limit)
    kind = rng.choice(["held", "straight", "slowing"])
    if kind == "held":
        return {"constant": end}
    begin = end + rng.uniform(0.1, 1.0) * (start_value - end)
    if kind == "straight":
        times = np.linspace(start, stop, 4)
        # The last value is `end` to the last bit, which no polynomial's would be.
        return {"table": {"times": times.tolist(), "values": np.linspace(begin, end, 4).tolist()}}
    # end + (begin - end) cos, a quarter of a wave later: it arrives with no rate, but an acceleration.
    speed = 0.5 * math.pi / (stop - start)
    wave = {"amplitude": begin - end, "angular_frequency": speed, "phase": math.pi - speed * stop}
    return {"sine": {**wave, "offset": end}}
