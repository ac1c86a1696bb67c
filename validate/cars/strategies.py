"""Random cars and motions for property-based tests, built so that most of them can be assembled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from pointcoord import Scene
from validate.cars.closed_form import Closure
from validate.cars.input_limits import Car, Linkage
from validate.cars.paper_car import EFFECTS, mirrored
from validate.cars.random_scenes import CLOSURES
from validate.cars.random_struts import LEFT_OVER, REACH, as_tuples, random_drawing
from validate.extras import MissingPackage

try:
    from hypothesis import strategies as st
except ModuleNotFoundError as error:
    raise MissingPackage("validate.cars.strategies", error, "test") from None

UP, RIGHT = (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


def _between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_subnormal=False)


def _floats(reach: float) -> st.SearchStrategy[float]:
    return _between(-reach, reach)


@st.composite
def cars(
    draw: st.DrawFn,
    closures: Sequence[Closure] = CLOSURES,
    reach: float = REACH,
    left_over: float = LEFT_OVER,
) -> Car:
    """A random strut on either side, of one of these kinds; see `drawings`."""
    kind = draw(st.sampled_from(closures))
    points = as_tuples(random_drawing(lambda low, high: draw(_between(low, high)), kind, reach, left_over))
    side = draw(st.sampled_from(["left", "right"]))
    return Car(mirrored(points) if side == "right" else points, side, UP, RIGHT, kind)


@st.composite
def scenes(
    draw: st.DrawFn, closures: Sequence[Closure] = CLOSURES, reach: float = REACH, samples: int = 5
) -> Scene:
    """A random car with random inputs and rates about its own drawing.

    The arm turns and the rack slides by polynomials or sines, and the chassis may heave. Whether the
    mechanism can follow is not known beforehand.
    """
    car = draw(cars(closures, reach))
    inputs: dict[str, Any] = {
        "arm_angle": draw(_law(Linkage.of(car).drawn_angle, 0.25, 0.6)),
        "rack": draw(_law(0.0, 20.0, 60.0)),
    }
    if draw(st.booleans()):
        inputs["heave"] = draw(_law(0.0, 30.0, 200.0))
    return make_scene(
        car.points,
        inputs,
        closure=car.closure,
        side=car.side,
        stop=draw(st.sampled_from([0.05, 0.2, 0.5])),
        samples=samples,
    )


@st.composite
def _law(draw: st.DrawFn, middle: float, reach: float, rate: float) -> dict[str, Any]:
    offset = middle + draw(_floats(reach))
    if draw(st.booleans()):
        return {"polynomial": [offset, draw(_floats(rate)), draw(_floats(rate))]}
    speed = draw(st.floats(0.5, 8.0))
    wave = {"amplitude": draw(_floats(rate)) / speed, "angular_frequency": speed}
    return {"sine": {**wave, "phase": draw(_floats(3.0)), "offset": offset}}


def make_scene(
    points: Mapping[str, Sequence[float]],
    inputs: Mapping[str, Any],
    *,
    closure: Closure,
    side: str = "left",
    up: Sequence[float] = UP,
    right: Sequence[float] = RIGHT,
    stop: float = 0.2,
    samples: int = 5,
    tolerance: float = 1e-9,
    effects: tuple[str, ...] = EFFECTS,
) -> Scene:
    """A scene from plain data, checked like a file."""
    return Scene.from_mapping(
        {
            "title": "random scene",
            "effects": list(effects),
            "tolerance": tolerance,
            "mechanism": {
                "type": "macpherson",
                "closure": closure,
                "side": side,
                "up": list(up),
                "right": list(right),
                "points": {name: list(point) for name, point in points.items()},
            },
            "inputs": dict(inputs),
            "time": {"start": 0.0, "stop": stop, "samples": samples},
        }
    )
