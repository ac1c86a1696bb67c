"""Which effects a car has, the driven inputs by which they are differentiated, and their values at a pose."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from flint import arb

from validate.reference.car_data import KNUCKLE, LINES, PAIR, RACK, ROLL, TIME, TRAVEL
from validate.reference.design import Design, Known
from validate.reference.drives import travel_per_radian
from validate.reference.effects.car import Car, Effect
from validate.reference.effects.registry import EFFECTS
from validate.reference.errors import NoReferenceError
from validate.reference.exact import as_ball
from validate.reference.jet import value_of
from validate.reference.kinematics import Solved, with_rates
from validate.reference.vectors import Exact, Scalar


@dataclass(frozen=True)
class Number:
    """An effect of a car.

    Attributes:
        name: its name in results, for example `left.camber`.
        corners: the prefixes of the parts whose cars `effect.evaluate` takes, in this order.
    """

    name: str
    effect: Effect
    corners: tuple[str, ...]

    def value(self, car: Callable[[str, str | None], Car], unit: Scalar) -> Scalar:
        """The number in rad, mm, N and %.

        Args:
            car: gives the car of a part, moving along a variable of `Effect.along`.
            unit: the cars' unit of length, mm.
        """
        found = self.effect.evaluate(*(car(prefix, self.effect.along) for prefix in self.corners))
        return found * unit**self.effect.power


def numbers_of(design: Design, names: Iterable[str]) -> tuple[Number, ...]:
    """The numbers of these names that the car can have; a wheel's number without prefix means all parts.

    Raises:
        NoReferenceError: there is no such effect.
    """
    for name in (names := [*names]):
        if name.rpartition(".")[2] not in EFFECTS:
            raise NoReferenceError("effect", f"is {name!r}", "a name of `effects.registry`")
    return numbers_with(design.corners, {part: provided(design, part) for part in design.corners}, names)


def numbers_with(
    corners: Mapping[str, int], has: Mapping[str, Collection[str]], names: Iterable[str]
) -> tuple[Number, ...]:
    """The numbers of these names for which parts, by prefix, have what is needed (see `Effect.needs`)."""
    left_right = tuple(sorted(corners, key=lambda prefix: corners[prefix]))
    pairs = [left_right] if [corners[prefix] for prefix in left_right] == [-1, 1] else []
    found = []
    for name in names:
        part, dot, base = name.rpartition(".")
        effect = EFFECTS[base]
        single = [(prefix,) for prefix in ([part + dot] if dot else corners)]
        for prefixes in pairs if PAIR in effect.needs else single:
            if all({*effect.needs} <= {*has[prefix], PAIR} for prefix in prefixes):
                found.append(Number(base if len(prefixes) > 1 else prefixes[0] + base, effect, prefixes))
    return tuple({number.name: number for number in found}.values())


def drawn_car(design: Design, number: Exact, prefix: str = "") -> Car:
    """The corner of a part as drawn, local; `number` converts a fraction to the poses' kind of number."""
    return Car.of(design.plain, prefix, design.table, design.origin, design.unit, number)


def drivers(design: Design, prefix: str = "") -> dict[str, str]:
    """The driven input of `TRAVEL`, `RACK` and `ROLL` in a part, for each kind with exactly one."""
    inputs = design.plain["inputs"]
    others = tuple(other for other in design.corners if other != prefix)
    own = [name for name in design.mechanism.drives if not name.startswith(others)]
    racks = [name for name in own if not inputs[name].keys().isdisjoint(("travel", "steers"))]
    turns = {name: spec for name, spec in inputs.items() if "turns" in spec}
    rolls = [name for name, spec in turns.items() if spec["along"] in ("forward", "rearward")]
    of_kind = {TRAVEL: [name for name in own if name not in racks], RACK: racks, ROLL: rolls}
    return {along: names[0] for along, names in of_kind.items() if len(names) == 1}


def provided(design: Design, prefix: str = "") -> frozenset[str]:
    """What a part of the car has, as in `Effect.needs`."""
    lines = (role for role in LINES if design.role(prefix + role) is not None)
    knuckle = [KNUCKLE] if design.role(prefix + KNUCKLE) in design.mechanism.frames else []
    return frozenset({*lines, *drivers(design, prefix), *design.car, *knuckle})


def driven_along(design: Design, known: Known, prefix: str, along: str) -> Known:
    """The motion, as jets, by which a number of a part is differentiated, see `Effect.along`."""
    if along == TIME:
        return known
    # A slide is driven in the design's unit of length, which is also the car's.
    driver, exact = drivers(design, prefix)[along], known.equations.number
    rate = exact(design.unit if along == RACK else Fraction(1))
    if "steers" in design.plain["inputs"][driver]:
        rate /= travel_per_radian(design.plain, exact)
    return known.driven_at(driver, rate)


def effects_at(
    design: Design, known: Known, enclosure: Sequence[arb], solver: Solved, numbers: Iterable[Number]
) -> dict[str, arb]:
    """Numbers in balls, rad, mm and %.

    The derivative of a pose by a driven input is the velocity of a motion that drives it at unit rate.

    Args:
        known: as jets; only derivatives by time use their rates.
        solver: solves for the rates over the enclosure.
    """
    equations = known.equations

    @cache
    def car(prefix: str, along: str | None) -> Car:
        drawn, body = drawn_car(design, as_ball, prefix), design.role(prefix + KNUCKLE)
        if along is None:
            return drawn.at(known.chassis.still(), equations.points_of(enclosure, drawn.points))
        driven = driven_along(design, known, prefix, along)
        pose = with_rates(enclosure, driven, solver)
        frame = equations.frame_of(pose, body) if body in equations.frames else None
        return drawn.at(driven.chassis, equations.points_of(pose, drawn.points), frame)

    return {number.name: arb(value_of(number.value(car, as_ball(design.unit)))) for number in numbers}
