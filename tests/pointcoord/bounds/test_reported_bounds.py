"""A bound for every number that a motion reports: rates, body rates and angles as well as positions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from pointcoord.bounds.proof import Numbers
from pointcoord.results.motion import Motion

Array = NDArray[np.float64]


def short(name: str, **changes: object) -> Scene:
    scene = Scene.load(name)
    time = scene.time.model_copy(update={"samples": 30})
    return scene.model_copy(update={"time": time, **changes})


def named(bounds: Numbers) -> dict[tuple[str, str], Array]:
    return {(quantity, name): array for quantity, part in bounds.items() for name, array in part.items()}


def test_only_what_is_asked_for_is_bounded() -> None:
    motion = simulate(short("bounce-and-steer", effects=("wheel_angles",)))
    assert not named(motion.proof().proven)
    assert {quantity for quantity, _ in named(motion.proof(rates=True).proven)} == {"position", "wheel"}


@pytest.mark.parametrize("quantity", ["velocity", "acceleration", "angular_velocity", "wheel"])
def test_a_wrong_number_is_proven_to_be_off_and_is_not_expected_to_be(quantity: str) -> None:
    motion = simulate(short("bounce-and-steer"))

    def spoilt(wrong: Motion) -> Motion:
        channel = wrong.numbers[quantity]
        arrays = {name: array * (1.0 + 1e-9) for name, array in channel.items()}
        return replace(wrong, numbers={**wrong.numbers, quantity: channel.with_arrays(arrays)})

    right, wrong = motion.proof(rates=True), spoilt(motion).proof(rates=True)
    for name, numbers in getattr(motion, quantity).items():
        off = 1e-9 * np.abs(numbers)
        proven = wrong.proven[quantity][name]
        before = right.proven[quantity][name]
        assert (proven >= (1.0 - 1e-6) * off - before).all()
        assert (proven <= (1.0 + 1e-5) * off + 1.1 * before).all()
        expected = wrong.expected[quantity][name]
        assert expected == pytest.approx(right.expected[quantity][name], rel=1e-6, abs=1e-300)


def test_rates_too_slow_and_too_fast_to_be_squared_are_bounded_as_others_are() -> None:
    """Time counts in units of its own, so a motion that takes 1e-100 of the time has the same bounds."""

    def proven(speed: float) -> dict[tuple[str, str], Array]:
        scene = Scene.load("bounce").model_dump(mode="json", exclude_none=True)
        scene["inputs"] = {"arm_angle": {"polynomial": [1.2, 0.3 * speed]}, "rack": {"constant": 5.0}}
        scene["time"] = {"start": 0.0, "stop": 0.0, "samples": 1}
        return named(simulate(Scene.from_mapping(scene), "newton").proof(rates=True).proven)

    plain, slow, fast = proven(1.0), proven(2.0**-300), proven(2.0**300)
    for (quantity, name), bound in plain.items():
        power = {"velocity": 1, "angular_velocity": 1, "acceleration": 2, "angular_acceleration": 2}
        factor = 2.0 ** (300 * power.get(quantity, 0))
        for other, scale in ((slow, 1.0 / factor), (fast, factor)):
            assert other[quantity, name] == pytest.approx(scale * bound, rel=1e-3, abs=scale * 1e-25)
