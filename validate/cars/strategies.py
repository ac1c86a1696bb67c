"""Random cars and motions for property-based tests, built so that most of them can be assembled.

Others find them as `validate.strategies`. Examples get simpler as hypothesis looks for the least one that
fails, and a near-singular pose goes away from its lock.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import Scene
from pointcoord.method import AUTO
from validate.cars.car import Car, as_tuples, other_side
from validate.cars.input_limits import DRIVEN, Linkage
from validate.cars.near_singular import approach, car_with_ends
from validate.cars.registry import SUSPENSIONS, VARIANTS, Variant
from validate.cars.scene_content import car_of, scene_content
from validate.cars.suspension import LEFT_OVER, REACH
from validate.extras import MissingPackage
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError

try:
    from hypothesis import assume
    from hypothesis import strategies as st
except ModuleNotFoundError as error:
    raise MissingPackage("validate.strategies", error, "strategies") from None


def _between(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_subnormal=False)


def _floats(reach: float) -> st.SearchStrategy[float]:
    return _between(-reach, reach)


@st.composite
def cars(
    draw: st.DrawFn,
    variants: Sequence[Variant] = VARIANTS,
    reach: float = REACH,
    left_over: float = LEFT_OVER,
) -> Car:
    """A random car on either side, of one of these suspensions; see `suspension.RandomDrawing`."""
    variant = draw(st.sampled_from(variants))
    drawing = SUSPENSIONS[variant.suspension].drawing
    drawn = drawing(lambda low, high: draw(_between(low, high)), variant.closure, reach, left_over)
    left = Car(as_tuples(drawn), "left", closure=variant.closure, suspension=variant.suspension)
    return other_side(left) if draw(st.booleans()) else left


def mechanisms(
    variants: Sequence[Variant] = VARIANTS, reach: float = REACH
) -> st.SearchStrategy[dict[str, Any]]:
    """Random cars as the `mechanism` of a scene's content: type, closure, side, axes and points, mm."""
    return cars(variants, reach).map(lambda car: dict(scene_content(car)["mechanism"]))


@st.composite
def inputs(draw: st.DrawFn, mechanism: Car | Mapping[str, Any]) -> dict[str, Any]:
    """Random laws for the inputs of a car, as the `inputs` of a scene's content; rad, mm and s.

    The arm turns and the rack slides by polynomials or sines about the drawing's own values, and the chassis
    may heave.

    Args:
        mechanism: a car, or the `mechanism` of a scene's content.
    """
    car = mechanism if isinstance(mechanism, Car) else _car(mechanism)
    laws: dict[str, Any] = {
        "arm_angle": draw(_law(Linkage.of(car).drawn_angle, 0.25, 0.6)),
        "rack": draw(_law(0.0, 20.0, 60.0)),
    }
    if draw(st.booleans()):
        laws["heave"] = draw(_law(0.0, 30.0, 200.0))
    return laws


def _car(mechanism: Mapping[str, Any]) -> Car:
    """The car of a scene's content, which is read as any scene is."""
    resting = {"arm_angle": {"constant": 1.0}, "rack": {"constant": 0.0}}
    time = {"start": 0.0, "stop": 0.0, "samples": 1}
    return car_of(Scene.from_mapping({"mechanism": mechanism, "inputs": resting, "time": time}))


def scenes(
    variants: Sequence[Variant] = VARIANTS, reach: float = REACH, samples: int = 5, solvable: bool = False
) -> st.SearchStrategy[Scene]:
    """A random car with random inputs and rates about its own drawing.

    Args:
        samples: instants.
        solvable: whether only scenes are drawn that pointcoord solves, with proven bounds; else it is not
            known beforehand whether the mechanism can follow.
    """
    every = _scenes(variants, reach, samples)
    return every.filter(_is_solved) if solvable else every


@st.composite
def _scenes(draw: st.DrawFn, variants: Sequence[Variant], reach: float, samples: int) -> Scene:
    car = draw(cars(variants, reach))
    laws = draw(inputs(car))
    stop = draw(st.sampled_from([0.05, 0.2, 0.5]))
    return Scene.from_mapping(scene_content(car, **laws, stop=stop, samples=samples))


def near_singular(nearest: float = 1e-6, farthest: float = 0.1) -> st.SearchStrategy[Scene]:
    """One instant of a random car, close to where one of its inputs has an end and the mechanism locks.

    Arm, tie rod or the knuckle's upper end locks there; the way from the drawing is open, and pointcoord
    solves it. All inputs move.

    Args:
        nearest, farthest: limits of the distance from the end, in parts of the input's range; rates grow as
            its inverse root.
    """
    return _near_scenes(nearest, farthest).filter(_is_solved)


@st.composite
def _near_scenes(draw: st.DrawFn, nearest: float, farthest: float) -> Scene:
    near = math.log10(farthest / nearest)
    pose = approach(
        car_with_ends(np.random.default_rng(draw(st.integers(0, 2**32 - 1)))),
        driven=draw(st.sampled_from(DRIVEN)),
        forward=draw(st.booleans()),
        aside=draw(_floats(1.0)),
        distance=farthest * 10.0 ** -draw(_between(0.0, near)),
    )
    assume(pose is not None)
    assert pose is not None
    turning, sliding = draw(_floats(0.6)), draw(_floats(60.0))
    laws: dict[str, Any] = {
        "arm_angle": [pose.inputs["arm_angle"], turning],
        "rack": [pose.inputs["rack"], sliding],
    }
    return Scene.from_mapping(scene_content(pose.car, **laws))


def _is_solved(scene: Scene) -> bool:
    try:
        PointCoordinates("pointcoord", AUTO).solve(scene)
    except FormulationError:
        return False
    return True


@st.composite
def _law(draw: st.DrawFn, middle: float, reach: float, rate: float) -> dict[str, Any]:
    offset = middle + draw(_floats(reach))
    if draw(st.booleans()):
        return {"polynomial": [offset, draw(_floats(rate)), draw(_floats(rate))]}
    speed = draw(st.floats(0.5, 8.0))
    wave = {"amplitude": draw(_floats(rate)) / speed, "angular_frequency": speed}
    return {"sine": {**wave, "phase": draw(_floats(3.0)), "offset": offset}}
