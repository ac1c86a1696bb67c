"""Random cars of every mechanism: points moved, mirrored, turned, scaled, displaced; and poses near a lock.

A car is one that pointcoord reads and solves at its own drawing, and that somebody would draw: where a
closure puts points in place it moves none far. Any other drawing is drawn back towards the base car. A
mechanism some of whose rows follow from others in the drawing, as those of a planar one do, is only mirrored,
turned, scaled and displaced: nothing else is sure to keep them true.

What slides is put back onto its line, which the mechanism's own tables name. A closure other than `drawn`
puts points in place by itself, so there they may lie anywhere.

With its rods and bodies given, an input can go only so far (see `input_ends`). A near pose has one driven to
such an end of a random car and steps back by a drawn share of its whole range.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from pointcoord import PointcoordError, simulate
from validate.cars.base_cars import Variant, variants
from validate.cars.car import Array, Car, any_rotation
from validate.cars.input_ends import Inputs, at, drawn_inputs, end

SHARE = 0.2  # of the car's size: how far points are moved in every coordinate
SLID, SLID_SHARE = 5.0, 0.15  # mm along a direction, parts of the way between two points
LEFT_OVER = 0.05  # mm, by which a drawn point may miss its line: half of what is warned of
HALVED = 8  # times: after that nothing is moved
FIRST = 0.7  # of the cars of a mechanism with several closures are of the first one
# Of the car's size: the most that closing a drawing moves a point. The paper's own strut moves by 0.022;
# drawn much worse, a strut may be nearer to another assembly than to the one that its maker meant.
CLOSED_BY = 0.05
OWN = 0.5  # of the cars have the inputs of their base car's scene
NEAREST = 1e-12  # of an input's range: its own rounding is 1e-4 of that
# How far other inputs are held from the drawing, and the chassis is moved: rad, and parts of the car's size.
ASIDE, LIFTED = (0.3, 0.06), (0.1, 0.1)


@dataclass(frozen=True)
class Moves:
    """How a car differs from its base car.

    Attributes:
        points: how far each is moved, (3,), mm; not of what slides.
        slid: how far what slides is slid along its line, -1 to 1.
        beside: by how much it misses its line, (3,), mm.
        without: points that are left out, as others stand in for them.
        whole: whether moves are whole millimetres and slides whole millimetres or eighths of a line.
    """

    points: Mapping[str, Array] = field(default_factory=dict)
    slid: Mapping[str, float] = field(default_factory=dict)
    beside: Mapping[str, Array] = field(default_factory=dict)
    without: frozenset[str] = frozenset()
    whole: bool = False

    def part(self, share: float) -> Moves:
        """A part of them."""
        points = {
            n: np.trunc(share * move) if self.whole else share * move for n, move in self.points.items()
        }
        return replace(self, points=points, slid={name: share * slid for name, slid in self.slid.items()})

    def of(self, base: Car) -> Car:
        """The base car with its points moved."""
        drawn = {name: place for name, place in base.array.items() if name not in self.without}
        places = {name: place + self.points.get(name, 0.0) for name, place in drawn.items()}
        # Slides of one input, as both ends of a rack, travel as far as the first of them.
        together = (one.named("slide") for one in base.structure.inputs.values())
        first = {slide: slides[0] for slides in together if len(slides) > 1 for slide in slides}
        travels: dict[str, float] = {}
        for title, slide in base.structure.slides.items() if base.closure == "drawn" else ():
            if slide.through not in drawn:
                continue  # the sliding point stands in for it, and so is on its own line
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
    """The base car with every point that its mechanism may have, where the one that stands in for it is."""
    left_out = {new: base.points[old] for new, old in base.structure.stand_ins.items() if old in base.points}
    return replace(base, points={**left_out, **base.points})


def sliding(base: Car) -> tuple[str, ...]:
    """The points that a drawing has to put on lines, which others make."""
    slides = base.structure.slides.values() if base.closure == "drawn" else ()
    return tuple(n for slide in slides for n in slide.points if n not in (slide.along, slide.through))


def is_accepted(car: Car, inputs: Collection[str]) -> bool:
    """Whether pointcoord reads the car and solves it near its own drawing."""
    try:
        # Points that coincide make no number, which is no car.
        with np.errstate(all="ignore"):
            solved = simulate(at(car, drawn_inputs(car, inputs)))
            closes = solved.closing.largest <= CLOSED_BY * solved.closing.size
            return closes and float(solved.proof().condition.max()) < np.inf
    except (PointcoordError, ValueError, ArithmeticError):
        return False


def drawn_back(base: Car, moves: Moves, put: Callable[[Car], Car], inputs: Collection[str]) -> Car:
    """The base car moved, by halves drawn back towards itself until what is put in place is accepted.

    Raises:
        AssertionError: the base car itself is not.
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
        inputs: names; the chassis' own motions are not among them.
        scale: by which the whole car is multiplied.
    """

    variant: Variant
    car: Car
    inputs: tuple[str, ...]
    scale: float


def random_car(rng: np.random.Generator) -> RandomCar:
    """A random car, of each mechanism as often as of any other, and mostly of its first closure."""
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
    """Most points moved by up to a share of the car's size; now and then a point off its line or left out."""
    reach = SHARE * base.size * 10.0 ** rng.uniform(-1.0, 0.0)
    on_lines = sliding(base)
    return Moves(
        points={name: rng.uniform(-reach, reach, 3) for name in base.points},
        slid={name: rng.uniform(-1.0, 1.0) for name in on_lines},
        beside={n: rng.uniform(-LEFT_OVER, LEFT_OVER, 3) for n in on_lines if rng.random() < 0.3},
        without=frozenset(name for name in base.structure.stand_ins if rng.random() < 0.3),
    )


def _placing(rng: np.random.Generator, variant: Variant) -> tuple[float, Callable[[Car], Car]]:
    """By how much a car is scaled, up to a thousand, and what puts it on the other side, turns and moves it.

    Each in one of two.
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
    """A car and inputs close to the end of one of them.

    Attributes:
        home: the inputs at which the car is drawn; the way from there to `inputs` is open.
        inputs: of all that is driven, the chassis too, rad and mm.
        driven: the input that is near its last reachable value.
        reach: range of that input, rad or mm.
        distance: from the last reachable value, in parts of the range.
    """

    variant: Variant
    car: Car
    home: Inputs
    inputs: Inputs
    driven: str
    reach: float
    distance: float


def near_pose(number: int, seed: int = 0, nearest: float = NEAREST, farthest: float = 0.1) -> NearPose:
    """The pose of a number, the same again for the same seed: of a car whose inputs have an open end.

    Args:
        nearest, farthest: limits of the distance, drawn log-uniformly, in parts of the input's range.
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
    """Drive one input of a car to its end and step back; None if it has no end that is open to reach.

    Args:
        inputs: all that are driven but the chassis' own motions.
        driven: one of them.
        forward: to the upper end of the input, else to the lower one.
        aside: where the other inputs are held, -1 to 1.
        distance: from the end, in parts of the range between both ends.
        lifted: how far the chassis is moved, -1 to 1.
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
