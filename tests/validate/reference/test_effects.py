"""Laws that every effect obeys."""

from __future__ import annotations

from dataclasses import replace

import pytest
from closed_forms import rational_turn, turned
from mpmath import mpf
from reference_cars import ReferenceCar

from validate.reference import Instant
from validate.reference.effects.registry import EFFECTS

FRAME = {"up": (0, 0, 1), "right": (0, 1, 0)}


def same(one: Instant, other: Instant) -> bool:
    bound = one.error_bound["effects"] + other.error_bound["effects"] + mpf("1e-60")
    assert set(one.effects) == set(other.effects) == set(EFFECTS)
    return all(abs(one.effects[name] - other.effects[name]) <= bound for name in EFFECTS)


def test_the_registry_calls_every_effect_by_its_own_name() -> None:
    assert all(
        effect.name == name and effect.unit == "rad" and effect.positive for name, effect in EFFECTS.items()
    )


def test_effects_are_those_of_the_mirrored_car_on_the_other_side(car: ReferenceCar) -> None:
    points = {name: (x, -y, z) for name, (x, y, z) in car.points.items()}
    mirrored = replace(car, points=points, side="left" if car.side == "right" else "right")
    inputs = {**car.inputs, "rack": tuple(-x for x in car.inputs["rack"])}
    assert same(car.solve(car.inputs), mirrored.solve(inputs))


def test_the_side_of_a_wheel_is_seen_by_effects_only(car: ReferenceCar) -> None:
    one, other = (replace(car, side=side).solve(car.inputs) for side in ("left", "right"))
    assert one.position == other.position
    assert not same(one, other)


@pytest.mark.parametrize("quaternion", [(3, 1, -2, 5), (1, 1, 1, 1), (-7, 2, 0, 1)])
def test_effects_turn_with_the_car(car: ReferenceCar, quaternion: tuple[int, int, int, int]) -> None:
    turn = rational_turn(quaternion)
    points = {name: turned(turn, p) for name, p in car.points.items()}
    there = replace(car, points=points, frame={name: turned(turn, v) for name, v in FRAME.items()})
    assert same(car.solve(car.inputs), there.solve(car.inputs))


def test_effects_do_not_see_heave_size_or_motion(car: ReferenceCar) -> None:
    plain = car.solve(car.inputs)
    assert same(plain, car.solve({**car.still, "heave": (1000, 0, 0)}))
    twice = replace(car, points={name: tuple(2 * x for x in p) for name, p in car.points.items()})
    assert same(plain, twice.solve({**car.still, "rack": (2 * car.inputs["rack"][0], 0, 0)}))
