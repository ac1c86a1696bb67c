"""Bounds of mechanisms that stand askew in their axes: directions are rounded, and so are points."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.car import any_rotation
from validate.cars.random_scenes import random_scene


def askew(name: str, seed: int) -> Scene:
    """A shipped scene whose car is turned anyhow, its axes with it, at three instants."""
    content = Scene.load(name).model_dump(exclude_none=True)
    turn, mechanism = any_rotation(seed), content["mechanism"]
    mechanism["points"] = {n: (turn @ np.array(p)).tolist() for n, p in mechanism["points"].items()}
    mechanism |= {axis: (turn @ np.array(mechanism[axis])).tolist() for axis in ("up", "right")}
    content["effects"] = ["velocity", "acceleration", "knuckle_rates"]
    content["time"]["samples"] = 3
    return Scene.from_mapping(content)


def check(scene: Scene, instants: int) -> None:
    """Every number is within its proven bound of the reference, at the first instants."""
    motion = simulate(scene)
    proven = motion.proof(rates=True).proven
    checked = 0
    for k, instant in enumerate(motion.times[:instants].tolist()):
        exact = reference_instant(scene, inputs_at(scene, instant))
        for quantity in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
            for one, numbers in motion.numbers[quantity].items():
                pairs = zip(numbers[k], getattr(exact, quantity)[one], strict=True)
                off = [abs(Fraction(float(number)) - true) for number, true in pairs]
                bounds = proven[quantity][one][k].tolist()
                assert all(error <= Fraction(bound) for error, bound in zip(off, bounds, strict=True)), one
                checked += 1
    assert checked >= 20 * instants


@pytest.mark.parametrize("seed", [1, 2, 5])
@pytest.mark.parametrize("name", ["axle-roll", "bounce-on-a-heaving-chassis"])
def test_bounds_hold_of_a_car_that_stands_askew(name: str, seed: int) -> None:
    check(askew(name, seed), 3)


@pytest.mark.parametrize("number", [238, 478, 2490])
def test_bounds_hold_whichever_rows_of_a_redundant_mechanism_are_left_out(number: int) -> None:
    """Bricard's ring drawn askew: the reference leaves out other rows, which differ in the last digits.

    Once it has moved, the reference proves nothing of it.
    """
    scene = random_scene(number).scene
    assert scene.mechanism.type == "bricard"
    check(scene, 1)
