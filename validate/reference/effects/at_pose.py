"""A pose as a car of its effects, and the driven inputs that it can be differentiated by."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from fractions import Fraction

from flint import arb, arb_mat

from validate.reference.car_data import LENGTHS
from validate.reference.chassis import ChassisMotion
from validate.reference.design import Design, Known
from validate.reference.dual import Dual, value_of
from validate.reference.effects.car import KNUCKLE, LINES, RADIUS, Car, DrawnCar, Frame, lines_of
from validate.reference.effects.effect import RACK, TRAVEL
from validate.reference.effects.registry import available
from validate.reference.exact import as_ball
from validate.reference.kinematics import unknown_rates
from validate.reference.vectors import Scalar, Vector, times


def drawn_car(design: Design, number: Callable[[Fraction], Scalar]) -> DrawnCar:
    """The car as drawn, local.

    Args:
        number: a fraction in the kind of number of the poses.
    """
    radius = design.wheel_radius
    return DrawnCar.of(
        roles=design.plain["roles"],
        points=design.table,
        up=design.up,
        right=design.right,
        side=design.outboard,
        wheel_radius=None if radius is None else radius / design.unit,
        origin=times(design.origin, -1 / design.unit),
        data={key: one / design.unit if key in LENGTHS else one for key, one in design.car.items()},
        number=number,
    )


def drivers(design: Design) -> dict[str, str]:
    """The driven input that `TRAVEL` and `RACK` go along, where there is exactly one."""
    inputs = design.plain["inputs"]
    of_kind = {
        TRAVEL: [name for name in design.mechanism.drives if "travel" not in inputs[name]],
        RACK: [name for name in design.mechanism.drives if "travel" in inputs[name]],
    }
    return {along: names[0] for along, names in of_kind.items() if len(names) == 1}


def provided(design: Design) -> frozenset[str]:
    """What effects may need and the car has, of `effect.NEEDS`."""
    has = {role for role in LINES if design.role(role) is not None} | set(drivers(design))
    has |= set(design.car)
    if design.wheel_radius is not None:
        has.add(RADIUS)
    if design.role(KNUCKLE) in design.mechanism.frames:
        has.add(KNUCKLE)
    return frozenset(has)


def car_at(
    drawn: DrawnCar, chassis: ChassisMotion, places: Mapping[str, Vector], knuckle: Frame | None = None
) -> Car:
    """The car at a pose, local.

    Args:
        chassis: how it is moved, without rates.
        places: of the lines' points, relative to the chassis.
        knuckle: two vectors fixed in the wheel's carrier, relative to the chassis.
    """
    turning = chassis.without_displacement()
    return Car(
        drawn=drawn,
        lines=lines_of(drawn.ends, {name: turning.moved(place) for name, place in places.items()}),
        on_chassis=lines_of(drawn.ends, places),
        knuckle=None if knuckle is None else (turning.turned(knuckle[0]), turning.turned(knuckle[1])),
    )


def effects_at(
    design: Design, known: Known, enclosure: Sequence[arb], inverse: arb_mat, names: Iterable[str]
) -> dict[str, arb]:
    """Those of some effects that the car can have, in balls, rad, mm and %.

    Gradients are those of the pose y(q): C(y, w(q)) = 0 differentiated by one driven input q, which is the
    velocity of a motion that drives it at unit rate.

    Args:
        known: as jets; their rates are not looked at.
        inverse: of the Jacobian over the enclosure.
    Raises:
        BadInputError: there is no such effect.
    """
    has, unit = provided(design), as_ball(design.unit)
    wanted = available(names, has)
    drawn, chassis, inputs = drawn_car(design, as_ball), known.chassis.still(), drivers(design)

    def car(along: str | None) -> Car:
        pose: Sequence[Scalar] = enclosure
        if along is not None:
            # A slide is driven in the design's own lengths, in which the car's are.
            driven = known.driven_at(inputs[along], unit if along == RACK else arb(1))
            rates = unknown_rates(enclosure, driven, inverse)
            pose = [Dual(y, slope) for y, slope in zip(enclosure, rates, strict=True)]
        equations, turns = known.equations, along is not None and KNUCKLE in has
        frame = equations.frame_of(pose, design.role(KNUCKLE)) if turns else None
        return car_at(drawn, chassis, equations.points_of(pose, drawn.points), frame)

    cars = {along: car(along) for along in {effect.along for effect in wanted.values()}}
    return {
        name: arb(value_of(effect.evaluate(cars[effect.along]))) * unit**effect.power
        for name, effect in wanted.items()
    }
