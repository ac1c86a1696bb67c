"""Random cars, motions and near-singular poses for property-based tests; the extra `strategies` brings them.

    from hypothesis import given, settings
    from my_solver import solve
    from validate.strategies import scenes

    @settings(deadline=None)  # the comparison itself takes some tenths of a second
    @given(scene=scenes(suspension="double_wishbone"))
    def test_my_solver_is_right(scene, plain_scene, assert_agrees):
        assert_agrees(solve(plain_scene(scene)), scene, accuracy=1e-6)

| strategy | what is drawn |
|---|---|
| `mechanisms()` | a car, as the `mechanism` of a scene's content |
| `inputs(mechanism)` | laws of its inputs that it can follow, as the `inputs` of a scene's content |
| `scenes()` | a scene of a car with such inputs |
| `near_singular()` | one instant of a car close to where it locks |

`suspension`, `closure` and `turns` restrict the cars to those that a solver can handle.

Numbers are whole where possible: positions in mm, steps of the inputs in hundredths of a radian or in mm.
A car is a base car with its points moved. The simplest example is the base car at rest at its drawing;
hypothesis shrinks a failing example to as few and as small moves as possible.

No example is rejected. If pointcoord refuses one, its moves are halved until pointcoord accepts it: moves of
a car's points towards the base car, a motion towards rest at the drawing. If an end of an input cannot be
approached, another end is taken, and finally an end of the base car. So every draw gives an example, and
equal draws give equal examples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from pointcoord import Scene
from pointcoord.method import AUTO
from validate.cars.base_cars import Variant, input_sets, variants_of
from validate.cars.car import Car, content_of, rotation
from validate.cars.input_ends import drawn_inputs
from validate.cars.random_cars import (
    HALVED,
    SHARE,
    Moves,
    approach,
    drawn_back,
    is_accepted,
    sliding,
    with_every_point,
)
from validate.extras import needing
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError

with needing("validate.strategies"):
    from hypothesis import strategies as st

__all__ = ["inputs", "mechanisms", "near_singular", "scenes"]

STEP = 0.01  # rad
# Limits of the whole coefficients of laws by unit, in steps: offset, rates; of the mechanism and the chassis.
WITHIN = {"rad": (25, 60), "mm": (20, 60)}
CHASSIS = {"rad": (10, 40), "mm": (30, 200)}
# Rotations that permute the axes and keep whole numbers: none, then half and quarter turns about each axis.
TURNS: tuple[tuple[int, int, int], ...] = (
    (0, 1, 0),
    *((axis, cosine, sine) for axis in range(3) for cosine, sine in ((-1, 0), (0, 1), (0, -1))),
)
Mechanism = Mapping[str, Any]


@st.composite
def mechanisms(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int | None = None,
    turns: bool = True,
) -> dict[str, Any]:
    """Random cars as the `mechanism` of a scene's content: type, closure, side, axes and points, mm.

    Args:
        suspension: such as "double_wishbone", or the path of a scene file (.toml) whose car is the base car;
            any shipped mechanism if not given.
        closure: such as "drawn"; any closure of the mechanism if not given.
        reach: largest move of a point from the base car in each coordinate, mm; a fifth of the car's size if
            not given.
        turns: whether the axes may be turned, so that x, y and z are not rearward, right and up; `up` and
            `right` of the content then give the directions.
    """
    return draw(cars(suspension, closure, reach, turns))[0].mechanism


@st.composite
def inputs(draw: st.DrawFn, mechanism: Mechanism, stop: float = 0.5) -> dict[str, Any]:
    """Random laws for inputs of a car, as the `inputs` of a scene's content; rad, mm and s.

    Any set of inputs that can drive the car is used, with polynomials or sines about the drawn values. The
    chassis may move too. The car can follow the laws from time 0 to `stop`.

    Args:
        mechanism: the `mechanism` of a scene's content, such as `mechanisms` draws.
    """
    car = Car.of(mechanism)
    return draw(_laws(car, draw(_driven(car, input_sets(car))), stop))


@st.composite
def scenes(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int | None = None,
    turns: bool = True,
    samples: int = 5,
) -> Scene:
    """Random cars with random motions of the inputs about their drawn values, from time 0 on.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        samples: number of instants.
    """
    car, variant = draw(cars(suspension, closure, reach, turns))
    stop = draw(st.sampled_from([0.5, 0.25, 0.0625]))
    laws = draw(_laws(car, draw(_driven(car, variant.input_sets)), stop))
    return Scene.from_mapping(content_of(car, laws, stop=stop, samples=samples))


@st.composite
def near_singular(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int | None = None,
    turns: bool = True,
    nearest: float = 1e-6,
    farthest: float = 0.1,
) -> Scene:
    """One instant of a random car, close to the end of an input's range, where the mechanism locks.

    The pose can be reached from the drawing. All inputs move. The case gets harder towards the end: rates
    grow as the inverse square root of the distance from it.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        nearest, farthest: limits of the distance from the end, as a fraction of the input's range; 1e-12 <
            nearest <= farthest <= 0.1.
    """
    known = variants_of(suspension, closure)
    first_of = draw(st.integers(0, len(known) - 1))
    chosen = next((one for one in known[first_of:] + known[:first_of] if one.ending_sets), None)
    if chosen is None:
        raise ValueError(f"no input of suspension={suspension!r} has an end")
    car, variant = draw(_cars_of(chosen, reach, turns))
    names = draw(st.sampled_from(variant.ending_sets))
    first = draw(st.sampled_from(names)), draw(st.booleans())
    aside = draw(st.integers(-4, 4)) / 4.0
    decades = draw(st.integers(0, 16)) / 16.0 * math.log10(farthest / nearest)
    steps = {name: draw(st.integers(-50, 50)) for name in names}
    distance = farthest * 10.0**-decades
    others = ((driven, ahead) for driven in reversed(names) for ahead in (False, True))
    # Try the requested end first, then other ends of the car, then the ends of its base car.
    ways = product((car, variant.base), dict.fromkeys((first, *others)), dict.fromkeys((aside, 0.0)))
    for there, (driven, ahead), beside in ways:
        for share in (distance, 0.1):
            pose = approach(there, variant, names, driven=driven, forward=ahead, aside=beside, distance=share)
            if pose is None:
                break  # this end does not exist, so another distance does not help
            laws = {n: [pose.inputs[n], steps[n] * _step(there, n)] for n in pose.home if n in names}
            scene = Scene.from_mapping(content_of(there, laws))
            if _is_solved(scene):
                return scene
    raise AssertionError("no end of an input of the base car can be reached")  # the tests show that one can


@st.composite
def cars(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int | None = None,
    turns: bool = True,
) -> tuple[Car, Variant]:
    """Random cars, see `mechanisms`, each with the variant of its base car."""
    return draw(_cars_of(draw(st.sampled_from(variants_of(suspension, closure))), reach, turns))


@st.composite
def _cars_of(draw: st.DrawFn, variant: Variant, reach: int | None, turns: bool) -> tuple[Car, Variant]:
    base = with_every_point(variant.base)
    own = with_every_point(base).points.keys() - variant.base.points.keys()
    far = round(SHARE * base.size) if reach is None else reach
    whole = st.integers(-far, far)
    moves = Moves()
    if not variant.holds_its_shape:
        places = {name: np.array(draw(st.tuples(whole, whole, whole)), dtype=float) for name in base.points}
        slid = {name: draw(st.integers(-5, 5)) / 5.0 for name in sliding(base)}
        without = frozenset(name for name in sorted(own) if not draw(st.booleans()))
        moves = Moves(points=places, slid=slid, without=without, whole=True)
    turn = rotation(*map(int, draw(st.sampled_from(TURNS)))) if turns else np.eye(3)
    mirror = draw(st.booleans()) and not variant.of_parts

    def put(car: Car) -> Car:
        return (car.mirrored() if mirror else car).turned(turn)

    return drawn_back(base, moves, put, variant.input_sets[0]), variant


def _is_solved(scene: Scene) -> bool:
    try:
        PointCoordinates("pointcoord", AUTO).solve(scene)
    except FormulationError:
        return False
    return True


@st.composite
def _driven(draw: st.DrawFn, car: Car, sets: Sequence[Sequence[str]]) -> Sequence[str]:
    """A random set of inputs; if the car locks with it as drawn, the first set, with which it is accepted."""
    names = draw(st.sampled_from(sets))
    return names if is_accepted(car, names) else sets[0]


@st.composite
def _laws(draw: st.DrawFn, car: Car, names: Sequence[str], stop: float) -> dict[str, Any]:
    home, known = drawn_inputs(car, names), car.structure.inputs
    shapes = {name: draw(_shapes(*WITHIN[known[name].unit])) for name in names}
    for name, one in known.items():
        # The chassis may move farther than a wheel on the ground can follow, so its motion may be left out.
        if one.moves_the_chassis and (shape := draw(st.none() | _shapes(*CHASSIS[one.unit]))) is not None:
            shapes[name], home[name] = shape, 0.0
    for halved in range(HALVED + 1):
        share = 0.5**halved if halved < HALVED else 0.0
        # Few digits, so that an example is easy to read; but the exact values for rest at the drawing.
        at = {name: round(value, 6) if share else value for name, value in home.items()}
        laws = {n: _law(shape, at[n], share * _step(car, n)) for n, shape in shapes.items()}
        if _is_solved(Scene.from_mapping(content_of(car, laws, stop=stop, samples=5))):
            return laws
    raise AssertionError("an accepted car cannot rest at its drawing")  # the car was accepted because it can


def _step(car: Car, name: str) -> float:
    return STEP if car.structure.inputs[name].unit == "rad" else 1.0


@st.composite
def _shapes(draw: st.DrawFn, reach: int, rate: int) -> tuple[Sequence[int], int]:
    """Three whole numbers and a frequency: polynomial coefficients from t^0 up if the frequency is 0.

    For a sine the three numbers are its offset, its amplitude times the frequency, and its phase.
    """
    offset, first, second = (draw(st.integers(-size, size)) for size in (reach, rate, rate))
    return (offset, first, second), draw(st.integers(0, 8))


def _law(shape: tuple[Sequence[int], int], middle: float, unit: float) -> dict[str, Any]:
    """The law of a shape about `middle`, in multiples of `unit`: at frequency 0 a polynomial, else a sine."""
    (offset, first, second), frequency = shape
    if not frequency:
        return {"polynomial": [middle + unit * offset, unit * first, unit * second]}
    wave = {"amplitude": unit * first / frequency, "angular_frequency": float(frequency)}
    return {"sine": {**wave, "phase": second * STEP, "offset": middle + unit * offset}}
