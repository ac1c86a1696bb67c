"""Bounds of a car that stands askew in its axes and rolls: directions are rounded, and turns keep lengths."""

from fractions import Fraction

import numpy as np
import pytest

from pointcoord import Scene, simulate
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.car import any_rotation


def askew(name: str, seed: int) -> Scene:
    """A shipped scene whose car is turned anyhow, its axes with it, at three instants."""
    content = Scene.load(name).model_dump(exclude_none=True)
    turn, mechanism = any_rotation(seed), content["mechanism"]
    mechanism["points"] = {n: (turn @ np.array(p)).tolist() for n, p in mechanism["points"].items()}
    mechanism |= {axis: (turn @ np.array(mechanism[axis])).tolist() for axis in ("up", "right")}
    content["effects"] = ["velocity", "acceleration", "knuckle_rates"]
    content["time"]["samples"] = 3
    return Scene.from_mapping(content)


@pytest.mark.parametrize("seed", [1, 2, 5])
@pytest.mark.parametrize("name", ["axle-roll", "bounce-on-a-heaving-chassis"])
def test_every_number_is_within_its_proven_bound_of_the_reference(name: str, seed: int) -> None:
    scene = askew(name, seed)
    motion = simulate(scene)
    proven = motion.proof(rates=True).proven
    checked = 0
    for k, instant in enumerate(motion.times.tolist()):
        exact = reference_instant(scene, inputs_at(scene, instant))
        for quantity in ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration"):
            for one, numbers in motion.numbers[quantity].items():
                pairs = zip(numbers[k], getattr(exact, quantity)[one], strict=True)
                off = [abs(Fraction(float(number)) - true) for number, true in pairs]
                bounds = proven[quantity][one][k].tolist()
                assert all(error <= Fraction(bound) for error, bound in zip(off, bounds, strict=True)), one
                checked += 1
    assert checked > 60
