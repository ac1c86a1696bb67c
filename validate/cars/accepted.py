"""Random cars, motions and near-singular poses for everybody's tests: pointcoord solves every one of them.

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
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pointcoord import PointcoordError, Scene, simulate
from pointcoord.method import AUTO
from validate.cars.car import Car, other_side, rotation, turned
from validate.cars.closed_form import INNER, RACK
from validate.cars.input_limits import DRIVEN, Linkage
from validate.cars.macpherson import LOWER, ROD_END, TOP
from validate.cars.near_singular import NearPose, approach
from validate.cars.registry import SUSPENSIONS, VARIANTS, Variant
from validate.cars.scene_content import car_of, scene_content
from validate.extras import MissingPackage
from validate.formulations.point_coordinates import PointCoordinates
from validate.formulations.protocol import FormulationError

try:
    from hypothesis import strategies as st
except ModuleNotFoundError as error:
    raise MissingPackage("validate.strategies", error, "strategies") from None

REACH = 100  # mm, of a point from the base car's in every coordinate
SLID = 5  # mm, of the rack in its drawing
EIGHTHS = (3, 2, 4)  # of the way from the top to strut_lower, where the rod ends: exact in whole mm
HALVED = 8  # times: a move of REACH is none then
STEP = 0.01  # rad
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
    reach: int = REACH,
    turns: bool = True,
) -> dict[str, Any]:
    """Random cars as the `mechanism` of a scene's content: type, closure, side, axes and points, mm.

    Args:
        suspension: such as "double_wishbone"; any of them if not given.
        closure: such as "drawn"; any that the suspension has if not given.
        reach: how far points lie from the base car's in each coordinate, mm.
        turns: whether x, y and z may be other directions of the car than rearward, right and up, as `up` and
            `right` then say.
    """
    return dict(scene_content(draw(_cars(suspension, closure, reach, turns)))["mechanism"])


@st.composite
def inputs(draw: st.DrawFn, mechanism: Mechanism, stop: float = 0.5) -> dict[str, Any]:
    """Random laws for the inputs of a car, as the `inputs` of a scene's content; rad, mm and s.

    The arm turns and the rack slides by polynomials or sines about the drawing's own values, and the chassis
    may heave. The car can follow from time 0 to `stop`.

    Args:
        mechanism: of a scene's content, such as `mechanisms` draws.
    """
    resting = {"arm_angle": {"constant": 1.0}, "rack": {"constant": 0.0}}
    time = {"start": 0.0, "stop": 0.0, "samples": 1}
    car = car_of(Scene.from_mapping({"mechanism": mechanism, "inputs": resting, "time": time}))
    return draw(_laws(car, stop))


@st.composite
def scenes(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int = REACH,
    turns: bool = True,
    samples: int = 5,
) -> Scene:
    """Random cars with random inputs about their own drawing, from time 0 on.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        samples: instants.
    """
    car = draw(_cars(suspension, closure, reach, turns))
    stop = draw(st.sampled_from([0.5, 0.25, 0.0625]))
    laws = draw(_laws(car, stop))
    return Scene.from_mapping(scene_content(car, **laws, stop=stop, samples=samples))


@st.composite
def near_singular(
    draw: st.DrawFn,
    suspension: str | None = None,
    closure: str | None = None,
    reach: int = REACH,
    turns: bool = True,
    nearest: float = 1e-6,
    farthest: float = 0.1,
) -> Scene:
    """One instant of a random car, close to where one of its inputs has an end and the mechanism locks.

    Arm, tie rod or the knuckle's upper end locks there, and the way from the drawing is open. All inputs
    move. The nearer, the harder: rates grow as the inverse root of the distance.

    Args:
        suspension, closure, reach, turns: see `mechanisms`.
        nearest, farthest: limits of the distance from the end, in parts of the input's range; 1e-12 < nearest
            <= farthest <= 0.1.
    """
    car = draw(_cars(suspension, closure, reach, turns))
    first = draw(st.sampled_from(DRIVEN)), draw(st.booleans())
    aside = draw(st.integers(-4, 4)) / 4.0
    decades = draw(st.integers(0, 16)) / 16.0 * math.log10(farthest / nearest)
    rates = {"arm_angle": draw(st.integers(-50, 50)) * STEP, "rack": float(draw(st.integers(-50, 50)))}
    distance = farthest * 10.0**-decades
    for pose in _near(car, first, aside, distance):
        laws: dict[str, Any] = {name: [pose.inputs[name], rates[name]] for name in DRIVEN}
        scene = Scene.from_mapping(scene_content(pose.car, **laws))
        if _is_solved(scene):
            return scene
    raise AssertionError("the base car has no open way to an end of the rack")  # it has, see the tests


def _variants(suspension: str | None, closure: str | None) -> list[Variant]:
    """Those that are asked for.

    Raises:
        ValueError: there is none.
    """
    found = [v for v in VARIANTS if suspension in (None, v.suspension) and closure in (None, v.closure)]
    if not found:
        there = "; ".join(f"{s.name}: {', '.join(s.closures)}" for s in SUSPENSIONS.values())
        raise ValueError(f"no car has suspension={suspension!r} and closure={closure!r}; there are: {there}")
    return found


@st.composite
def _cars(draw: st.DrawFn, suspension: str | None, closure: str | None, reach: int, turns: bool) -> Car:
    base = draw(st.sampled_from(_variants(suspension, closure))).base
    whole = st.integers(-reach, reach)
    moves = {name: np.array(draw(st.tuples(whole, whole, whole)), dtype=float) for name in base.points}
    rod = draw(st.sampled_from(EIGHTHS)) / 8.0
    slid = float(draw(st.integers(-SLID, SLID)))
    turn = rotation(*map(int, draw(st.sampled_from(TURNS)))) if turns else np.eye(3)
    mirror = draw(st.booleans())
    for halved in range(HALVED + 1):
        moved = {n: np.trunc(move / 2**halved) for n, move in moves.items()} if halved < HALVED else {}
        car = _moved(base, moved, rod, slid)
        car = turned(other_side(car) if mirror else car, turn)
        if is_accepted(car):
            return car
    raise AssertionError("pointcoord refuses a base car")  # it solves them, see the tests


def _moved(base: Car, moves: Mapping[str, np.ndarray], rod: float, slid: float) -> Car:
    """The base car with its points moved; what belongs on a line is put there."""
    points = {name: place + moves.get(name, 0.0) for name, place in base.array.items()}
    if ROD_END in points and base.closure == "drawn":
        points[ROD_END] = points[TOP] + rod * (points[LOWER] - points[TOP])
    if RACK in points:
        points[INNER] = points[RACK] + slid * np.array(base.right)
    return base.drawn_as(points)


def is_accepted(car: Car) -> bool:
    """Whether the car is sound, and pointcoord reads it and solves it at its own drawing."""
    try:
        # Points that coincide make no number, which is not sound.
        with np.errstate(all="ignore"):
            linkage = Linkage.of(car)
            if not linkage.sound:
                return False
        home = linkage.home
        simulate(Scene.from_mapping(scene_content(car, home["arm_angle"], home["rack"])))
    except (PointcoordError, ValueError, ArithmeticError):
        return False
    return True


def _is_solved(scene: Scene) -> bool:
    try:
        PointCoordinates("pointcoord", AUTO).solve(scene)
    except FormulationError:
        return False
    return True


@st.composite
def _laws(draw: st.DrawFn, car: Car, stop: float) -> dict[str, Any]:
    home = Linkage.of(car).home
    drawn = {
        "arm_angle": draw(_shapes(25, 60)),
        "rack": draw(_shapes(20, 60)),
    }
    heave = draw(st.none() | _shapes(30, 200))
    for halved in range(HALVED + 1):
        share = 0.5**halved if halved < HALVED else 0.0
        # The least digits that can be read, but for the drawing itself.
        angle = round(home["arm_angle"], 6) if share else home["arm_angle"]
        laws: dict[str, Any] = {
            "arm_angle": _law(drawn["arm_angle"], angle, STEP * share),
            "rack": _law(drawn["rack"], home["rack"], share),
        }
        if heave is not None:
            laws["heave"] = _law(heave, 0.0, 1.0)
        if _is_solved(Scene.from_mapping(scene_content(car, **laws, stop=stop, samples=5))):
            return laws
    raise AssertionError("an accepted car cannot rest at its drawing")  # it is accepted because it can


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


def _near(car: Car, first: tuple[str, bool], aside: float, distance: float) -> Iterator[NearPose]:
    """The pose near the end that is asked for, then near others of the car, then of its base car."""
    base = Variant.of(car).base
    base = other_side(base) if base.side != car.side else base
    others = ((driven, ahead) for driven in reversed(DRIVEN) for ahead in (False, True))
    ends = dict.fromkeys((first, *others))
    for there in (car, base):
        for driven, ahead in ends:
            for beside in dict.fromkeys((aside, 0.0)):
                for share in (distance, 0.1):
                    pose = approach(there, driven=driven, forward=ahead, aside=beside, distance=share)
                    if pose is not None:
                        yield pose
