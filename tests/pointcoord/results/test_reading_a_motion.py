"""A solved scene read by name and by time."""

from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import Motion, NotComputed, OutsideMotion, Scene, UnknownName, simulate
from pointcoord.method import NEWTON, SERIES, Method
from validate.paper.printed import PRINTED

EPS = np.finfo(float).eps
CHANNELS = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration", "wheel")


@pytest.fixture(scope="module")
def motion(make_scene: Callable[..., Scene]) -> Motion:
    return simulate(
        make_scene(rack=(0.0, 20.0), heave={"sine": {"amplitude": 5.0, "angular_frequency": 2.0}})
    )


@pytest.mark.parametrize("method", [SERIES, NEWTON, PRINTED], ids=str)
def test_arrays_of_a_motion_cannot_be_written(make_scene: Callable[..., Scene], method: Method) -> None:
    motion = simulate(make_scene(), method)
    for samples in (motion, motion.at([0.5, 1.0])) if method.by_series else (motion,):
        for name in CHANNELS:
            for array in getattr(samples, name).values():
                with pytest.raises(ValueError, match="read-only"):
                    array[0] = 0.0


def test_times_of_a_motion_cannot_be_written(make_scene: Callable[..., Scene]) -> None:
    motion = simulate(make_scene(samples=2))
    with pytest.raises(ValueError, match="read-only"):
        motion.times[0] = 1.0


def test_shapes_follow_the_instants(motion: Motion) -> None:
    for asked, shape in (
        (0.3, ()),
        (np.float64(0.3), ()),
        ([0.3], (1,)),
        (np.linspace(0, 2, 5), (5,)),
        ([], (0,)),
    ):
        samples = motion.at(asked)
        assert samples.times.shape == shape
        for name in CHANNELS:
            for array in getattr(samples, name).values():
                assert array.shape == (shape if name == "wheel" else (*shape, 3))


def test_instants_of_more_dimensions_keep_their_shape(motion: Motion) -> None:
    asked = np.array([[0.1, 0.2, 1.5], [0.3, 0.4, 0.0]])
    samples = motion.at(asked)
    assert np.array_equal(samples.times, asked)
    for name in CHANNELS:
        for key, array in getattr(samples, name).items():
            assert array.shape == (asked.shape if name == "wheel" else (*asked.shape, 3))
            for place in np.ndindex(asked.shape):
                alone = getattr(motion.at(asked[place]), name)[key]
                # One instant or many: a product of matrices may sum its 21 terms in another order.
                assert np.abs(array[place] - alone).max() <= 1e3 * EPS * max(1.0, np.abs(array).max())


def test_at_the_instants_of_the_scene_it_is_the_scene(motion: Motion) -> None:
    again = motion.at(motion.times)
    single = [motion.at(t) for t in motion.times]
    for name in CHANNELS:
        for key, array in getattr(motion, name).items():
            assert np.array_equal(getattr(again, name)[key], array)
            alone = np.stack([getattr(s, name)[key] for s in single])
            # One instant or many: a product of matrices may sum its 21 terms in another order.
            assert np.abs(alone - array).max() <= 1e3 * EPS * max(1.0, np.abs(array).max())


def test_instants_may_come_in_any_order(motion: Motion) -> None:
    instants = np.array([1.7, 0.2, 1.9, 0.2, 0.0, 2.0])
    mixed = motion.at(instants)
    sorted_back = motion.at(np.sort(instants))
    order = np.argsort(instants, kind="stable")
    for name in CHANNELS:
        for key, array in getattr(mixed, name).items():
            ordered = getattr(sorted_back, name)[key]
            assert np.abs(array[order] - ordered).max() <= 1e3 * EPS * max(1.0, np.abs(ordered).max())


@pytest.mark.parametrize("bad", [-1e-9, 2.0 + 1e-9, np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("many", [False, True])
def test_instant_outside_the_motion_is_refused(motion: Motion, bad: float, many: bool) -> None:
    with pytest.raises(OutsideMotion, match="allowed: 0 to 2 s") as caught:
        motion.at([0.5, bad] if many else bad)
    assert caught.value.instant == bad or np.isnan(bad)
    assert (caught.value.start, caught.value.stop) == (0.0, 2.0)


def test_newton_knows_no_instants_between(make_scene: Callable[..., Scene]) -> None:
    with pytest.raises(NotComputed, match="method 'series'"):
        simulate(make_scene(), "newton").at(0.5)


def test_names_are_those_of_the_car(motion: Motion, table: dict[str, tuple[float, ...]]) -> None:
    for name in ("position", "velocity", "acceleration"):
        assert set(getattr(motion, name)) == set(table)
        assert len(getattr(motion, name)) == len(table)
    assert set(motion.angular_velocity) == set(motion.angular_acceleration) == {"knuckle"}
    assert set(motion.wheel) >= {"camber", "kingpin"}
    assert "wheel_centre" in motion.position
    assert "wheel_center" not in motion.position


@pytest.mark.parametrize("name", CHANNELS)
def test_unknown_name_is_refused_with_the_names_that_exist(motion: Motion, name: str) -> None:
    channel = getattr(motion, name)
    with pytest.raises(UnknownName) as caught:
        channel["wheel_center"]
    assert set(caught.value.valid) == set(channel)


def test_chassis_points_move_with_the_heave_and_nothing_else(
    motion: Motion, table: dict[str, tuple[float, ...]]
) -> None:
    heave = 5.0 * np.sin(2.0 * motion.times)
    rate, second = 10.0 * np.cos(2.0 * motion.times), -20.0 * np.sin(2.0 * motion.times)
    for name in ("lower_arm_front", "lower_arm_rear", "rack_centre", "strut_top"):
        for quantity, up in (("position", heave), ("velocity", rate), ("acceleration", second)):
            place = np.array(table[name]) if quantity == "position" else np.zeros(3)
            expected = place + up[:, None] * [0.0, 0.0, 1.0]
            # A sine, a product and a sum, of numbers up to 600.
            assert np.abs(getattr(motion, quantity)[name] - expected).max() <= 8 * EPS * 600


@pytest.mark.parametrize("rates", [False, True])
def test_a_proof_prints_in_one_line(motion: Motion, rates: bool) -> None:
    proof = motion.proof(rates=rates)
    assert f"solved points within {proof.bound.max():.2g} mm" in repr(proof)
    assert f"of {len(motion.times)} instants" in repr(proof)
    assert len(repr(proof)) < 120
