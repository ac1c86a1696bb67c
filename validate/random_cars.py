"""Random scenes by number: the same number is the same scene, on every machine and in every run.

Hardpoints lie up to two hundred millimetres from the paper's in every coordinate, with the strut nearly in
line, as in `strategies`; the whole car is then mirrored, turned, moved and scaled. Inputs are of every kind
and go from slow and small to fast and large. A share of the scenes comes close to a singular pose:
the arm at its dead point, tie rod and steering arm in line, or a drawing that is itself nearly singular.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.locks import arm_limits, rack_limits
from validate.paper_car import EFFECTS, FREE, PAPER, Points, mirrored

Array = NDArray[np.float64]
Kind = Literal["regular", "dead arm", "toggle", "singular drawing"]
KINDS: tuple[Kind, ...] = ("regular", "dead arm", "toggle", "singular drawing")
SHARES = (0.9, 0.04, 0.04, 0.02)

SEED = 20250101  # another recipe for the scenes takes another seed: a store of results keeps it
REACH = 200.0  # mm, from the paper's hardpoints
NEAREST = -12.0  # decades: how near to a singular pose, as a share of the whole way to it


@dataclass(frozen=True)
class RandomCar:
    """A scene with its number, and what it was made to come near to."""

    number: int
    kind: Kind
    scene: Scene


def random_car(number: int, samples: int = 3) -> RandomCar:
    """The random scene of a number, from zero up."""
    rng = np.random.default_rng([SEED, number])
    kind: Kind = KINDS[int(rng.choice(len(KINDS), p=SHARES))]
    drawn = _hardpoints(rng)
    if kind == "singular drawing":
        drawn = _nearly_singular(rng, drawn)
    side = str(rng.choice(["left", "right"]))
    points, up, right, scale = _placed(rng, mirrored(drawn) if side == "right" else drawn)
    duration = 10.0 ** rng.uniform(-3.0, 2.0)
    start = float(rng.choice([0.0, rng.uniform(-duration, duration)]))
    stop = start + duration
    arm = points["lower_ball_joint"] - points["lower_arm_front"]
    angle = math.acos(float(arm @ up) / float(np.linalg.norm(arm)))
    middle = angle + float(rng.choice([0.0, rng.uniform(-0.25, 0.25)]))
    inputs = {
        "arm_angle": _law(rng, middle, 0.5, start, stop),
        "rack": _law(rng, rng.uniform(-20.0, 20.0) * scale, 60.0 * scale, start, stop),
    }
    if kind == "dead arm":
        inputs["arm_angle"] = _approach(rng, angle, float(rng.choice(arm_limits(points, up))), start, stop)
    if kind == "toggle":
        held = min(max(middle, 0.0), math.pi)
        limits = rack_limits(points, up, right, held, 400.0 * scale)
        if limits:
            inputs["arm_angle"] = {"constant": held}
            inputs["rack"] = _approach(rng, 0.0, float(rng.choice(limits)), start, stop)
    if rng.random() < 0.5:
        inputs["heave"] = _law(rng, rng.uniform(-30.0, 30.0) * scale, 200.0 * scale, start, stop)
    content = {
        "title": f"random car {number}",
        "effects": list(EFFECTS),
        "tolerance": 1e-9 * scale,
        "mechanism": {
            "type": "macpherson",
            "closure": "collinear",
            "side": side,
            "up": up.tolist(),
            "right": right.tolist(),
            "points": {name: point.tolist() for name, point in points.items()},
        },
        "inputs": inputs,
        "time": {"start": start, "stop": stop, "samples": samples},
    }
    return RandomCar(number, kind, Scene.from_mapping(content))


def _hardpoints(rng: np.random.Generator) -> Points:
    """A left-hand strut in the paper's axes, mm."""
    points = {name: np.array(PAPER[name]) + rng.uniform(-REACH, REACH, 3) for name in FREE}
    top, ball = points["strut_top"], points["lower_ball_joint"]
    length = float(np.linalg.norm(ball - top))
    for name, low, high in (("strut_lower", 0.55, 0.95), ("strut_rod_end", 0.2, 0.5)):
        place = rng.uniform(low, high)
        nearer = min(place, 1.0 - place) * length
        points[name] = top + place * (ball - top) + 0.08 * nearer * rng.uniform(-1.0, 1.0, 3)
    points["tie_rod_inner"] = points["rack_centre"] + rng.uniform(-5.0, 5.0, 3)
    return {name: _triple(points[name]) for name in PAPER}


def _nearly_singular(rng: np.random.Generator, drawn: Points) -> Points:
    """The drawing with one point moved close to where its joint locks."""
    points = {name: np.array(point) for name, point in drawn.items()}
    ball, outer = points["lower_ball_joint"], points["tie_rod_outer"]
    left = 10.0 ** rng.uniform(NEAREST, -1.0)
    what = rng.choice(["dead arm", "toggle", "thin knuckle"])
    if what == "dead arm":
        # The arm's dead points are in the vertical plane through its axis.
        pivot = points["lower_arm_front"]
        across = _unit(np.cross(points["lower_arm_rear"] - pivot, (0.0, 0.0, 1.0)))
        points["lower_ball_joint"] = ball - (1.0 - left) * ((ball - pivot) @ across) * across
    elif what == "toggle":
        across = _unit(np.cross(points["strut_top"] - ball, points["tie_rod_inner"] - ball))
        points["tie_rod_outer"] = outer - (1.0 - left) * ((outer - ball) @ across) * across
    else:
        along = _unit(points["strut_top"] - ball)
        foot = ball + ((outer - ball) @ along) * along
        points["tie_rod_outer"] = foot + left * (outer - foot)
    return {name: _triple(point) for name, point in points.items()}


def _placed(rng: np.random.Generator, drawn: Points) -> tuple[dict[str, Array], Array, Array, float]:
    """The car scaled, turned and moved: points, up, right, and the scale."""
    scale = float(rng.choice([1.0, 10.0 ** rng.uniform(-3.0, 3.0)]))
    turn = np.eye(3)
    if rng.random() < 0.5:
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        turn = turn * np.linalg.det(turn)
    away = _unit(rng.normal(size=3)) * 10.0 ** rng.uniform(0.0, 7.0) * scale * rng.choice([0.0, 1.0])
    points = {name: turn @ np.array(point) * scale + away for name, point in drawn.items()}
    return points, turn @ (0.0, 0.0, 1.0), turn @ (0.0, 1.0, 0.0), scale


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


def _unit(vector: Array) -> Array:
    return np.asarray(vector / np.linalg.norm(vector))


def _triple(vector: Array) -> tuple[float, float, float]:
    x, y, z = (float(component) for component in vector)
    return x, y, z
