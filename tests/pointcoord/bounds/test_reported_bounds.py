"""A bound for every number that a motion reports: rates, body rates and angles as well as positions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from pointcoord.bounds.proof import Numbers, unit_of_time
from pointcoord.results.motion import Motion

Array = NDArray[np.float64]
SCENES = ("bounce-and-steer", "bounce-on-a-heaving-chassis", "off-axis-strut", "double-wishbone")


def short(name: str, **changes: object) -> Scene:
    scene = Scene.load(name)
    time = scene.time.model_copy(update={"samples": 30})
    return scene.model_copy(update={"time": time, **changes})


def named(bounds: Numbers) -> dict[tuple[str, str], Array]:
    return {(quantity, name): array for quantity, part in bounds.items() for name, array in part.items()}


@pytest.mark.parametrize("name", SCENES)
def test_two_methods_differ_by_no_more_than_both_prove_and_prove_no_more_than_they_expect(name: str) -> None:
    series, newton = (simulate(short(name), method) for method in ("series", "newton"))
    one, other = series.proof(rates=True), newton.proof(rates=True)
    for (quantity, part), bound in named(one.proven).items():
        gap = np.abs(getattr(series, quantity)[part] - getattr(newton, quantity)[part])
        assert (gap <= bound + other.proven[quantity][part]).all(), (quantity, part)
        largest = max(float(np.abs(array).max()) for array in getattr(series, quantity).values())
        assert (bound <= 1e-13 * largest).all(), (quantity, part)
    for motion, proof in ((series, one), (newton, other)):
        expected = named(proof.expected)
        for (quantity, part), bound in named(proof.proven).items():
            largest = max(float(np.abs(array).max()) for array in getattr(motion, quantity).values())
            # A number that is exact is proven to be so up to the rounding of the proof, some u^2.
            assert (bound <= expected[quantity, part] + 1e-27 * largest).all(), (quantity, part)


def test_a_proof_by_blocks_is_the_proof_of_each_instant(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = simulate(short("bounce-on-a-heaving-chassis"))
    whole = motion.proof(rates=True)
    monkeypatch.setattr("pointcoord.bounds.proof.BLOCK", 7)
    parts = motion.proof(rates=True)
    for bounds in ("proven", "expected"):
        one, other = named(getattr(whole, bounds)), named(getattr(parts, bounds))
        assert one.keys() == other.keys()
        for key, bound in one.items():
            # A product of matrices may be summed in another order: two roundings of a rounding.
            assert other[key] == pytest.approx(bound, rel=1e-3, abs=1e-28), key


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


def test_in_its_unit_of_time_the_fastest_of_a_motion_is_between_a_half_and_one() -> None:
    """Rates, and roots of accelerations, of whatever size and sign."""
    rng = np.random.default_rng(2)
    count, size = 400, 6
    speed, root = 10.0 ** rng.uniform(-100.0, 100.0, (2, count, 1))
    shares = rng.uniform(-0.9, 0.9, (2, count, size))
    shares[:, np.arange(count), rng.integers(size, size=count)] = rng.choice([-1.0, 1.0], (2, count))
    rate, acceleration = speed * shares[0], root**2 * shares[1]
    unit = unit_of_time([rng.normal(size=(count, size)), rate, acceleration])
    assert (np.frexp(unit)[0] == 0.5).all()  # a power of two
    fastest = np.maximum(speed, root)[:, 0] * unit
    assert ((fastest > 0.5 - 1e-12) & (fastest < 1.0 + 1e-12)).all()


@pytest.mark.parametrize("rate", [0.0, np.inf, np.nan, 5e-324, 1e308])
def test_every_motion_has_a_unit_of_time_whose_square_is_a_number(rate: float) -> None:
    (unit,) = unit_of_time([np.ones((1, 3)), np.full((1, 3), rate)])
    assert np.frexp(unit)[0] == 0.5
    assert 0.0 < unit**2 < np.inf
    assert 0.0 < unit**-2 < np.inf
