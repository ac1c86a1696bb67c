"""Bounds of mechanisms that stand askew in their axes: directions are rounded, and so are points."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import PointcoordError, Scene, simulate
from validate.cars.car import any_rotation
from validate.cars.random_scenes import random_scene
from validate.formulations.reference_solution import inputs_at, reference_instant
from validate.reference import NoReferenceError


def askew(name: str, seed: int) -> Scene:
    """A shipped scene whose car is turned anyhow, its axes with it, at three instants."""
    content = Scene.load(name).model_dump(exclude_none=True)
    turn, mechanism = any_rotation(seed), content["mechanism"]
    mechanism["points"] = {n: (turn @ np.array(p)).tolist() for n, p in mechanism["points"].items()}
    mechanism |= {axis: (turn @ np.array(mechanism[axis])).tolist() for axis in ("up", "right")}
    content["effects"] = ["velocity", "acceleration", "knuckle_rates"]
    content["time"]["samples"] = 3
    return Scene.from_mapping(content)


def check(scene: Scene, instants: int) -> int:
    """How many numbers there are at the first instants; each is within its proven bound of the reference."""
    motion = simulate(scene)
    proven = motion.proof(rates=True).proven
    checked = 0
    for k, instant in enumerate(motion.times[:instants].tolist()):
        exact = reference_instant(scene, inputs_at(scene, instant))
        for quantity, channel in motion.numbers.items():
            for name, numbers in channel.items():
                of_points = getattr(exact, quantity, {})
                true = of_points[name] if name in of_points else (exact.effects[name],)
                found, bounds = np.ravel(numbers[k]).tolist(), np.ravel(proven[quantity][name][k]).tolist()
                for number, value, bound in zip(found, true, bounds, strict=True):
                    assert abs(Fraction(number) - value) <= Fraction(bound), (quantity, name, instant)
                    checked += 1
    return checked


@pytest.mark.parametrize(("name", "seed"), [("axle-roll", 1), ("bounce-on-a-heaving-chassis", 5)])
def test_bounds_hold_of_a_car_that_stands_askew(name: str, seed: int) -> None:
    assert check(askew(name, seed), 3) > 200


@pytest.mark.parametrize("number", [238, 2490])
def test_bounds_hold_whichever_rows_of_a_redundant_mechanism_are_left_out(number: int) -> None:
    """Bricard's ring drawn askew: the reference leaves out other rows, which differ in the last digits.

    Once it has moved, the reference proves nothing of it.
    """
    scene = random_scene(number).scene
    assert scene.mechanism.type == "bricard"
    assert check(scene, 1) == 108


@pytest.mark.parametrize("first", range(0, 20, 5))
def test_bounds_hold_of_random_cars(first: int) -> None:
    """Of every mechanism, turned anyhow, moved and scaled, as far as both sides answer."""
    checked = 0
    for number in range(first, first + 5):
        try:
            checked += check(random_scene(number).scene, 2)
        except (PointcoordError, NoReferenceError):
            continue
    assert checked > 200
