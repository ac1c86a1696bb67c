"""Random scenes by number: the same number is the same scene, on every machine and in every run.

Seven in ten are struts as drawn, their ball joint beside the axis or on it, the others collinear ones; see
`drawings`. The whole car is then mirrored, turned, moved and scaled. Inputs are of every kind
and go from slow and small to fast and large. A share of the scenes comes close to a singular pose: the arm at
its dead point, tie rod and steering arm in line, a slide that runs out, or a drawing that is itself nearly
singular.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from validate.cars.closed_form import Closure
from validate.cars.input_limits import STRUT, Car, Linkage
from validate.cars.paper_car import EFFECTS
from validate.cars.random_struts import (
    Drawing,
    as_tuple,
    as_tuples,
    placed,
    random_drawing,
    with_slide_that_runs_out,
)

Array = NDArray[np.float64]
Kind = Literal["regular", "dead arm", "toggle", "slide out", "singular drawing"]
KINDS: tuple[Kind, ...] = ("regular", "dead arm", "toggle", "slide out", "singular drawing")
CLOSURES: tuple[Closure, ...] = ("drawn", "collinear")
SHARES = (0.88, 0.035, 0.035, 0.03, 0.02)
COLLINEAR = 0.3  # of the scenes, but for those whose slide runs out: it does so beside the ball joint only

SEED = 20261121  # another recipe for the scenes takes another seed: a store of results keeps it
NEAREST = -12.0  # decades: how near to a singular pose, as a share of the whole way to it


@dataclass(frozen=True)
class RandomCar:
    """A scene with its number, its kind of strut, and what it was made to come near to."""

    number: int
    closure: Closure
    kind: Kind
    scene: Scene


def random_car(number: int, samples: int = 3) -> RandomCar:
    """The random scene of a number, from zero up."""
    rng = np.random.default_rng([SEED, number])
    kind: Kind = KINDS[int(rng.choice(len(KINDS), p=SHARES))]
    closure: Closure = "collinear" if rng.random() < COLLINEAR and kind != "slide out" else "drawn"
    drawn = random_drawing(rng.uniform, closure)
    if kind == "slide out":
        drawn = with_slide_that_runs_out(rng.uniform, drawn)
    if kind == "singular drawing":
        drawn = _nearly_singular(rng, drawn, closure)
    side = str(rng.choice(["left", "right"]))
    if side == "right":
        drawn = {name: place * (1.0, -1.0, 1.0) for name, place in drawn.items()}
    points, up, right, scale = placed(rng, drawn)
    car = Car(as_tuples(points), side, as_tuple(up), as_tuple(right), closure)
    duration = 10.0 ** rng.uniform(-3.0, 2.0)
    start = float(rng.choice([0.0, rng.uniform(-duration, duration)]))
    content = {
        "title": f"random car {number}",
        "effects": list(EFFECTS),
        "tolerance": 1e-9 * scale,
        "mechanism": {
            "type": "macpherson",
            "closure": closure,
            "side": side,
            "up": list(car.up),
            "right": list(car.right),
            "points": {name: list(place) for name, place in car.points.items()},
        },
        "inputs": _inputs(rng, kind, Linkage.of(car), scale, start, start + duration),
        "time": {"start": start, "stop": start + duration, "samples": samples},
    }
    return RandomCar(number, closure, kind, Scene.from_mapping(content))


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
        if ends := _ends(linkage, {"arm_angle": held, "rack": travel}, "rack"):
            inputs["arm_angle"] = {"constant": held}
            inputs["rack"] = _approach(rng, travel, float(rng.choice([end for end, _ in ends])), start, stop)
    if kind == "slide out":
        ends = _ends(linkage, {"arm_angle": angle, "rack": travel}, "arm_angle")
        if run_out := [end for end, lock in ends if lock == STRUT]:
            inputs["arm_angle"] = _approach(rng, angle, float(rng.choice(run_out)), start, stop)
            inputs["rack"] = {"constant": travel}
    if rng.random() < 0.5:
        inputs["heave"] = _law(rng, rng.uniform(-30.0, 30.0) * scale, 200.0 * scale, start, stop)
    return inputs


def _ends(linkage: Linkage, home: dict[str, float], driven: str) -> list[tuple[float, str]]:
    found = (linkage.end(home, driven, ahead) for ahead in (True, False))
    return [end for end in found if end is not None]


def _nearly_singular(rng: np.random.Generator, drawn: Drawing, closure: Closure) -> Drawing:
    """The drawing with one joint moved close to where it locks."""
    points = dict(drawn)
    ball, outer, top = points["lower_ball_joint"], points["tie_rod_outer"], points["strut_top"]
    left = 10.0 ** rng.uniform(NEAREST, -1.0)
    what = rng.choice(["dead arm", "toggle", "thin knuckle", "slide"][: 4 if closure == "drawn" else 3])
    if closure == "drawn":
        # Near a lock what is left over on the rack's line would move the car far, or could not close.
        points.pop("rack_centre", None)
    if what == "dead arm":
        # The arm's dead points are in the vertical plane through its axis.
        pivot = points["lower_arm_front"]
        across = _unit(np.cross(points["lower_arm_rear"] - pivot, (0.0, 0.0, 1.0)))
        points["lower_ball_joint"] = ball - (1.0 - left) * ((ball - pivot) @ across) * across
    elif what == "toggle":
        across = _unit(np.cross(top - ball, points["tie_rod_inner"] - ball))
        points["tie_rod_outer"] = outer - (1.0 - left) * ((outer - ball) @ across) * across
    elif what == "thin knuckle":
        along = _unit(top - ball)
        foot = ball + ((outer - ball) @ along) * along
        points["tie_rod_outer"] = foot + left * (outer - foot)
    else:
        # The axis at a right angle to the line from the top to the ball joint, but for this.
        down = _unit(ball - top)
        axis = _unit(_unit(np.cross(down, rng.normal(size=3))) + left * down)
        points |= {"strut_lower": top + 400.0 * axis, "strut_rod_end": top + 150.0 * axis}
    return points


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
