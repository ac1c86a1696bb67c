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

`suspension`, `closure` and `turns` say which cars a solver can be asked.

Numbers are whole where they can be: places in mm, steps of the inputs in hundredths of a radian and in mm. A
car is a base car with its points moved; the least example is the base car at rest at its drawing, and a
failing one is made of as few and as small moves as hypothesis finds.

Nothing is drawn and thrown away. What pointcoord refuses is drawn back instead, by halves, towards what it
accepts: the moves of a car's points towards the base car, a motion towards the drawing at rest, a way to an
end of an input towards another end, and at last that of the base car. So every draw is an example, and the
same draws are the same example.
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
from validate.extras import not_there
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError

try:
    from hypothesis import strategies as st
except ModuleNotFoundError as error:
    raise not_there("validate.strategies", error, "strategies") from None

__all__ = ["inputs", "mechanisms", "near_singular", "scenes"]

STEP = 0.01  # rad
# Whole coefficients of laws by unit, in steps: offset, and rates; of the mechanism and of the chassis.
WITHIN = {"rad": (25, 60), "mm": (20, 60)}
CHASSIS = {"rad": (10, 40), "mm": (30, 200)}
# Turns that permute axes and so keep whole numbers: none, then half and quarter turns about each axis.
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
        suspension: such as "double_wishbone", or the path of a scene file (.toml) whose car others are made
            from; any shipped mechanism if not given.
        closure: such as "drawn"; any that the mechanism has if not given.
        reach: how far points lie from the base car's in each coordinate, mm; a fifth of its size if none.
        turns: whether x, y and z may be other directions of the car than rearward, right and up, as `up` and
            `right` then say.
    """
    return draw(cars(suspension, closure, reach, turns))[0].mechanism


@st.composite
def inputs(draw: st.DrawFn, mechanism: Mechanism, stop: float = 0.5) -> dict[str, Any]:
    """Random laws for inputs of a car, as the `inputs` of a scene's content; rad, mm and s.

    Any inputs that can drive the car do so, by polynomials or sines about the drawing's own values, and the
    chassis may move. The car can follow from time 0 to `stop`.

    Args:
        mechanism: of a scene's content, such as `mechanisms` draws.
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
    """Random cars with random inputs about their own drawing, from time 0 on.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        samples: instants.
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
    """One instant of a random car, close to where one of its inputs has an end and the mechanism locks.

    The way from the drawing is open. All inputs move. The nearer, the harder: rates grow as the inverse root
    of the distance.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        nearest, farthest: limits of the distance from the end, in parts of the input's range; 1e-12 < nearest
            <= farthest <= 0.1.
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
    # Near the end that is asked for, then near others of the car, then of its base car.
    ways = product((car, variant.base), dict.fromkeys((first, *others)), dict.fromkeys((aside, 0.0)))
    for there, (driven, ahead), beside in ways:
        for share in (distance, 0.1):
            pose = approach(there, variant, names, driven=driven, forward=ahead, aside=beside, distance=share)
            if pose is None:
                break  # there is no such end, at whatever distance
            laws = {n: [pose.inputs[n], steps[n] * _step(there, n)] for n in pose.home if n in names}
            scene = Scene.from_mapping(content_of(there, laws))
            if _is_solved(scene):
                return scene
    raise AssertionError("the base car has no open way to an end of an input")  # it has, see the tests


@st.composite
def cars(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int | None = None,
    turns: bool = True,
) -> tuple[Car, Variant]:
    """Random cars, see `mechanisms`, each with its variant."""
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
    """One of the sets of inputs; the first, which the car is accepted by, where that one locks as drawn."""
    names = draw(st.sampled_from(sets))
    return names if is_accepted(car, names) else sets[0]


@st.composite
def _laws(draw: st.DrawFn, car: Car, names: Sequence[str], stop: float) -> dict[str, Any]:
    home, known = drawn_inputs(car, names), car.structure.inputs
    shapes = {name: draw(_shapes(*WITHIN[known[name].unit])) for name in names}
    for name, one in known.items():
        # A wheel on the ground may not reach as far as the chassis goes.
        if one.moves_the_chassis and (shape := draw(st.none() | _shapes(*CHASSIS[one.unit]))) is not None:
            shapes[name], home[name] = shape, 0.0
    for halved in range(HALVED + 1):
        share = 0.5**halved if halved < HALVED else 0.0
        # The least digits that can be read, but for the drawing itself.
        at = {name: round(value, 6) if share else value for name, value in home.items()}
        laws = {n: _law(shape, at[n], share * _step(car, n)) for n, shape in shapes.items()}
        if _is_solved(Scene.from_mapping(content_of(car, laws, stop=stop, samples=5))):
            return laws
    raise AssertionError("an accepted car cannot rest at its drawing")  # it is accepted because it can


def _step(car: Car, name: str) -> float:
    return STEP if car.structure.inputs[name].unit == "rad" else 1.0


@st.composite
def _shapes(draw: st.DrawFn, reach: int, rate: int) -> tuple[Sequence[int], int]:
    """Whole coefficients of a polynomial from t^0 up, or amplitude, phase and offset; and the frequency."""
    offset, first, second = (draw(st.integers(-size, size)) for size in (reach, rate, rate))
    return (offset, first, second), draw(st.integers(0, 8))


def _law(shape: tuple[Sequence[int], int], middle: float, unit: float) -> dict[str, Any]:
    """The law of a shape in multiples of a unit, about a value; without a frequency a polynomial."""
    (offset, first, second), frequency = shape
    if not frequency:
        return {"polynomial": [middle + unit * offset, unit * first, unit * second]}
    wave = {"amplitude": unit * first / frequency, "angular_frequency": float(frequency)}
    return {"sine": {**wave, "phase": second * STEP, "offset": middle + unit * offset}}
