"""Effects by their meaning, of axes turned by hand, and the laws that all of them obey."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from exact_vectors import rational_turn, turned
from flint import arb
from mpmath import mpf
from reference_cars import Inputs, ReferenceCar

from validate.reference import Instant
from validate.reference.car_data import LENGTHS
from validate.reference.dual import Dual, angle
from validate.reference.effects.car import DAMPER, STEERING, WHEEL, Car, DrawnCar, Line
from validate.reference.effects.effect import PAIR, TIME
from validate.reference.effects.registry import EFFECTS
from validate.reference.vectors import Vector, plus

FRAME = {"up": (0, 0, 1), "right": (0, 1, 0)}


# These cars have no damper, and one wheel.
NAMES = tuple(n for n, one in EFFECTS.items() if {DAMPER, PAIR}.isdisjoint(one.needs))


def solved(car: ReferenceCar, inputs: Inputs) -> Instant:
    return car.solve(inputs, effects=NAMES)


OF_POSES = tuple(n for n in NAMES if EFFECTS[n].along != TIME)


def same(
    one: Instant, other: Instant, scale: int = 1, mirrored: bool = False, names: Sequence[str] = NAMES
) -> bool:
    """Whether all numbers are the same, of a car that is `scale` times as large.

    Where it is mirrored its slides are not, and go the other way.
    """
    bound = one.error_bound["effects"] + other.error_bound["effects"] + mpf("1e-60")
    assert set(one.effects) == set(other.effects) == set(NAMES)
    factors = {n: mpf(scale) ** -EFFECTS[n].power for n in NAMES}
    turned = {n for n in NAMES if mirrored and n.endswith("_by_rack") != n.startswith("steer_angle")}
    turned |= {"screw_pitch"} if mirrored else set()
    factors |= {n: -factors[n] for n in turned}
    return all(abs(one.effects[n] - other.effects[n] * factors[n]) <= scale * bound for n in names)


def test_effects_are_those_of_the_mirrored_car_on_the_other_side(car: ReferenceCar) -> None:
    points = {name: (x, -y, z) for name, (x, y, z) in car.points.items()}
    mirrored = replace(car, points=points, side="left" if car.side == "right" else "right")
    inputs = {**car.inputs, "rack": tuple(-x for x in car.inputs["rack"])}
    assert same(solved(car, car.inputs), solved(mirrored, inputs), mirrored=True)


def test_the_side_of_a_wheel_is_seen_by_effects_only(car: ReferenceCar) -> None:
    one, other = (solved(replace(car, side=side), car.inputs) for side in ("left", "right"))
    assert one.position == other.position
    assert not same(one, other)


@pytest.mark.parametrize("quaternion", [(3, 1, -2, 5), (1, 1, 1, 1), (-7, 2, 0, 1)])
def test_effects_turn_with_the_car(car: ReferenceCar, quaternion: tuple[int, int, int, int]) -> None:
    turn = rational_turn(quaternion)
    points = {name: turned(turn, p) for name, p in car.points.items()}
    there = replace(car, points=points, frame={name: turned(turn, v) for name, v in FRAME.items()})
    assert same(solved(car, car.inputs), solved(there, car.inputs))


def test_effects_do_not_see_heave_or_motion_and_lengths_grow_with_the_car(car: ReferenceCar) -> None:
    plain = solved(car, car.inputs)
    assert same(plain, solved(car, {**car.still, "heave": (1000, 0, 0)}), names=OF_POSES)
    assert same(plain, solved(car, {**car.inputs, "heave": (1000, 30, 5)}))
    points = {name: tuple(3 * x for x in p) for name, p in car.points.items()}
    data = {**car.car, **{name: 3 * car.car[name] for name in LENGTHS}}
    thrice = replace(car, points=points, wheel_radius=3 * car.wheel_radius, car=data)
    inputs = {**car.inputs, "rack": tuple(3 * x for x in car.inputs["rack"])}
    assert same(plain, solved(thrice, inputs), scale=3)


def test_effects_do_not_see_where_the_origin_lies_but_for_the_middle_plane(car: ReferenceCar) -> None:
    def moved(by: Vector) -> Instant:
        return solved(replace(car, points={name: plus(p, by) for name, p in car.points.items()}), car.inputs)

    plain, aside = moved((0, 0, 0)), moved((0, 100, 0))
    assert same(plain, moved((-3000, 0, 70)))
    assert not same(plain, aside)
    heights = {name: aside.effect(name) for name in ("roll_centre_height", "arm_roll_centre_height")}
    assert same(replace(plain, effects={**plain.effects, **heights}), aside)


UP, RIGHT, FORWARD = (0, 0, 1), (0, 1, 0), (-1, 0, 0)  # x rearward, y right, z up


def car_with(wheel: tuple[float, ...], steering: tuple[float, ...], out: int) -> Car:
    """A car whose axes start at the origin."""

    def balls(vector: tuple[float, ...]) -> Vector:
        return arb(vector[0]), arb(vector[1]), arb(vector[2])

    start = balls((0, 0, 0))
    lines = {
        n: Line(start, balls(along), balls(along)) for n, along in ((WHEEL, wheel), (STEERING, steering))
    }
    drawn = DrawnCar({}, lines, balls(UP), balls(FORWARD), balls((0, out, 0)), None, start, {})
    return Car(drawn, lines, lines)


@pytest.mark.parametrize("out", [-1, 1])
@pytest.mark.parametrize("lean", [-2.5, -0.2, 0.3, 1.9])
def test_angles_are_those_by_which_axes_are_turned_by_hand(lean: float, out: int) -> None:
    sine, cosine = float(np.sin(lean)), float(np.cos(lean))
    # The spin axis of a wheel that leans out points down on its way out; the steering axis leads in on its
    # way up. Neither angle sees what is along the car.
    leaning = car_with((7.0, out * cosine, -sine), (-3.0, -out * sine, cosine), out)
    # The spin axis of a wheel that toes in points forward, -x; a steering axis with caster leads rearward.
    toeing = car_with((-sine, out * cosine, 7.0), (sine, -3.0, cosine), out)
    for name, car in {"camber": leaning, "kingpin": leaning, "toe": toeing, "caster": toeing}.items():
        assert float(EFFECTS[name].evaluate(car)) == pytest.approx(lean, abs=1e-15)
    assert float(EFFECTS["steer_angle"].evaluate(toeing)) == pytest.approx(out * lean, abs=1e-15)


@pytest.mark.parametrize(
    ("y", "x", "slope"),
    [
        # d atan2(y, x) = (x dy - y dx) / (x^2 + y^2)
        (Dual(arb(3), arb(2)), Dual(arb(4), arb(-5)), Fraction(4 * 2 + 3 * 5, 25)),
        (Dual(arb(3), arb(2)), arb(4), Fraction(8, 25)),
        (arb(3), Dual(arb(4), arb(-5)), Fraction(15, 25)),
        (Dual(arb(-1), arb(7)), Dual(arb(-2), arb(1)), Fraction(-14 + 1, 5)),
    ],
)
def test_an_angle_turns_with_both_of_its_components(y: Dual | arb, x: Dual | arb, slope: Fraction) -> None:
    found = angle(y, x)
    assert isinstance(found, Dual)
    assert found.slope.overlaps(arb(slope.numerator) / slope.denominator)
    values = [float(part.value) if isinstance(part, Dual) else float(part) for part in (y, x)]
    assert float(found.value) == pytest.approx(np.arctan2(*values), abs=1e-15)
