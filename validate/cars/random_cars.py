"""Random cars of every mechanism, with points moved, mirrored, turned, scaled, displaced; poses near a lock.

A car is accepted if pointcoord solves it as drawn, and if closing the drawing moves no point far, as in a
drawing by an engineer. Otherwise its moves are halved. If equations of a mechanism are redundant as drawn, as
in a planar mechanism, its points are not moved singly, since these equations might then contradict each
other.

Points on a slide are put back onto its line, unless the closure is not `drawn`: then the closure places them,
and they may be drawn anywhere.

A near pose drives one input of a random car to the end of its range (see `input_ends`) and steps back by a
random share of the range.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pointcoord import PointcoordError, simulate
from validate.arrays import Array
from validate.cars.base_cars import Variant, variants
from validate.cars.car import Car, any_rotation
from validate.cars.input_ends import Inputs, at, drawn_inputs, end

SHARE = 0.2  # largest move of a point in each coordinate, as a share of the car's size
SLID, SLID_SHARE = 5.0, 0.15  # largest slide: mm along a direction, or a share of the line between points
LEFT_OVER = 0.05  # largest distance of a drawn point from its line, mm: half of the limit of the warning
HALVED = 8  # number of halvings of the moves; after that nothing is moved
FIRST = 0.7  # share of the cars with the first closure, for a mechanism with several closures
# Largest movement of a point as the drawing closes, as a share of the car's size: 0.022 for the paper's
# strut. A strut drawn much worse may be nearer to another assembly than to the intended one.
CLOSED_BY = 0.05
OWN = 0.5  # share of the cars with the inputs of their base car's scene
NEAREST = 1e-12  # least distance from an end, as a share of the input's range: its rounding is 1e-4 of that
# Largest offsets of other inputs from the drawing, and of the chassis: rad, and shares of the car's size.
ASIDE, LIFTED = (0.3, 0.06), (0.1, 0.1)


@dataclass(frozen=True)
class Moves:
    """How a car differs from its base car.

    Attributes:
        points: the move of each point, (3,), mm; not for points on slides.
        slid: the move of each point on a slide along its line, -1 to 1.
        beside: the offset of points on slides from their lines, (3,), mm.
        without: points that are left out, so that others take their place.
        whole: whether moves are whole millimetres, on slides whole millimetres or eighths of a line.
    """

    points: Mapping[str, Array] = field(default_factory=dict)
    slid: Mapping[str, float] = field(default_factory=dict)
    beside: Mapping[str, Array] = field(default_factory=dict)
    without: frozenset[str] = frozenset()
    whole: bool = False

    def part(self, share: float) -> Moves:
        """These moves times a share."""
        points = {
            n: np.trunc(share * move) if self.whole else share * move for n, move in self.points.items()
        }
        return replace(self, points=points, slid={name: share * slid for name, slid in self.slid.items()})

    def of(self, base: Car) -> Car:
        """The base car with its points moved."""
        drawn = {name: place for name, place in base.array.items() if name not in self.without}
        places = {name: place + self.points.get(name, 0.0) for name, place in drawn.items()}
        # Slides of one input, such as both ends of a rack, travel as far as the first one.
        together = (one.named("slide") for one in base.structure.inputs.values())
        first = {slide: slides[0] for slides in together if len(slides) > 1 for slide in slides}
        travels: dict[str, float] = {}
        for title, slide in base.structure.slides.items() if base.closure == "drawn" else ():
            if slide.through not in drawn:
                continue  # the sliding point stands in for this point, so it is on the line
            by_point = slide.along in drawn
            before, now = (
                p[slide.along] - p[slide.through] if by_point else base.direction(slide.along)
                for p in (drawn, places)
            )
            for name in {*slide.points} - {slide.along, slide.through}:
                travel = float((drawn[name] - drawn[slide.through]) @ before) / float(before @ before)
                travel += self.slid.get(name, 0.0) * (SLID_SHARE if by_point else SLID)
                if self.whole:
                    travel = round(8.0 * travel) / 8.0 if by_point else float(round(travel))
                travel = travels.setdefault(first.get(title, name), travel)
                places[name] = places[slide.through] + travel * now
        return base.drawn_as({name: place + self.beside.get(name, 0.0) for name, place in places.items()})


def with_every_point(base: Car) -> Car:
    """The base car with every optional point, at the place of the point that would stand in for it."""
    left_out = {new: base.points[old] for new, old in base.structure.stand_ins.items() if old in base.points}
    return replace(base, points={**left_out, **base.points})


def sliding(base: Car) -> tuple[str, ...]:
    """The points that must be drawn on the line of a slide, without those that define the line."""
    slides = base.structure.slides.values() if base.closure == "drawn" else ()
    return tuple(n for slide in slides for n in slide.points if n not in (slide.along, slide.through))


def is_accepted(car: Car, inputs: Collection[str]) -> bool:
    """Whether pointcoord solves the car at its drawn inputs, and closing the drawing moves no point far."""
    try:
        # Coincident points give NaN, which is refused.
        with np.errstate(all="ignore"):
            solved = simulate(at(car, drawn_inputs(car, inputs)))
            closes = solved.closing.largest <= CLOSED_BY * solved.closing.size
            return closes and float(solved.proof().condition.max()) < np.inf
    except (PointcoordError, ValueError, ArithmeticError):
        return False


def drawn_back(base: Car, moves: Moves, put: Callable[[Car], Car], inputs: Collection[str]) -> Car:
    """The base car with moves, which are halved until the placed car is accepted.

    Raises:
        AssertionError: the base car is not accepted.
    """
    for halved in range(HALVED + 1):
        car = put(moves.part(0.5**halved if halved < HALVED else 0.0).of(base))
        if is_accepted(car, inputs):
            return car
    raise AssertionError(f"the base car of {base.suspension!r} is refused")


@dataclass(frozen=True)
class RandomCar:
    """A random car with the inputs that drive it.

    Attributes:
        inputs: names of the driven inputs, without motions of the chassis.
        scale: factor by which the whole car is scaled.
    """

    variant: Variant
    car: Car
    inputs: tuple[str, ...]
    scale: float


def random_car(rng: np.random.Generator) -> RandomCar:
    """A random car. All mechanisms are equally likely; the first closure of a mechanism is preferred."""
    names = tuple(dict.fromkeys(variant.suspension for variant in variants()))
    name = names[int(rng.integers(len(names)))]
    first, *rest = (variant for variant in variants() if variant.suspension == name)
    variant = rest[int(rng.integers(len(rest)))] if rest and rng.random() >= FIRST else first
    own, *others = variant.input_sets
    inputs = own if not others or rng.random() < OWN else others[int(rng.integers(len(others)))]
    base = with_every_point(variant.base)
    moves, (scale, put) = _moves(rng, base), _placing(rng, variant)
    car = drawn_back(base, Moves() if variant.holds_its_shape else moves, put, inputs)
    return RandomCar(variant, car, inputs, scale)


def _moves(rng: np.random.Generator, base: Car) -> Moves:
    """Random moves of all points up to a share of the car's size; some are off their line or left out."""
    reach = SHARE * base.size * 10.0 ** rng.uniform(-1.0, 0.0)
    on_lines = sliding(base)
    return Moves(
        points={name: rng.uniform(-reach, reach, 3) for name in base.points},
        slid={name: rng.uniform(-1.0, 1.0) for name in on_lines},
        beside={n: rng.uniform(-LEFT_OVER, LEFT_OVER, 3) for n in on_lines if rng.random() < 0.3},
        without=frozenset(name for name in base.structure.stand_ins if rng.random() < 0.3),
    )


def _placing(rng: np.random.Generator, variant: Variant) -> tuple[float, Callable[[Car], Car]]:
    """A random scale, 1e-3 to 1e3, and a function that mirrors, turns, scales and moves a car, each with
    probability one half.
    """
    mirrored = bool(rng.random() < 0.5) and not variant.of_parts
    scale = 10.0 ** rng.uniform(-3.0, 3.0) if rng.random() < 0.5 else 1.0
    turn = any_rotation(rng) if rng.random() < 0.5 else np.eye(3)
    away = np.zeros(3)
    if rng.random() < 0.5:
        away = rng.normal(size=3)
        away *= scale * 10.0 ** rng.uniform(0.0, 7.0) / np.linalg.norm(away)
    return scale, lambda car: (car.mirrored() if mirrored else car).turned(turn).scaled(scale).moved(away)


@dataclass(frozen=True)
class NearPose:
    """A car with inputs, one of them close to an end.

    Attributes:
        home: the drawn inputs; from there to `inputs` nothing blocks the path.
        inputs: values of all driven inputs and chassis motions, rad and mm.
        driven: the input that is near its end.
        reach: range of this input, rad or mm.
        distance: distance from the end, as a share of the range.
    """

    variant: Variant
    car: Car
    home: Inputs
    inputs: Inputs
    driven: str
    reach: float
    distance: float


def near_pose(number: int, seed: int = 0, nearest: float = NEAREST, farthest: float = 0.1) -> NearPose:
    """A random pose near an end, reproducible from its number and seed.

    Args:
        nearest, farthest: limits of the log-uniform distance, as shares of the input's range.
    """
    rng = np.random.default_rng([seed, number])
    while True:
        drawn = random_car(rng)
        found = approach(
            drawn.car,
            drawn.variant,
            drawn.inputs,
            driven=drawn.inputs[int(rng.integers(len(drawn.inputs)))],
            forward=bool(rng.integers(2)),
            aside=rng.uniform(-1.0, 1.0),
            distance=float(np.exp(rng.uniform(math.log(nearest), math.log(farthest)))),
            lifted=rng.uniform(-1.0, 1.0) if rng.random() < 0.3 else 0.0,
        )
        if found is not None:
            return found


def approach(
    car: Car,
    variant: Variant,
    inputs: Sequence[str],
    *,
    driven: str,
    forward: bool,
    aside: float,
    distance: float,
    lifted: float = 0.0,
) -> NearPose | None:
    """Drive one input of a car to its end and step back; None if no end can be reached.

    Args:
        inputs: all driven inputs, without motions of the chassis.
        driven: the input that is driven to its end.
        forward: whether to the upper end; otherwise to the lower one.
        aside: offset of the other inputs from the drawing, -1 to 1.
        distance: distance from the end, as a share of the range between both ends.
        lifted: displacement of the chassis, -1 to 1.
    """
    chassis = {name: lifted * car.room(name, LIFTED) for name in variant.chassis_motions}
    try:
        home = drawn_inputs(car, inputs)
        held = {n: value + (aside * car.room(n, ASIDE) if n != driven else 0.0) for n, value in home.items()}
        last = end(car, held, driven, forward)
    except PointcoordError:
        return None
    if last is None:
        return None
    there = held | {driven: last.value + (-1.0 if forward else 1.0) * distance * last.reach} | chassis
    return NearPose(variant, car, home | dict.fromkeys(chassis, 0.0), there, driven, last.reach, distance)
