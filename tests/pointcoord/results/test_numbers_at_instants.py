"""Numbers at instants, one or many, close together or not: those of the plain formulas."""

import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from every_number import every_effect
from within_bounds import among, beyond_claims, differing

from pointcoord import Motion, NotComputed, OutsideMotion, Scene, simulate
from pointcoord.effects.numbers import CAR_NUMBERS
from pointcoord.effects.registry import ANGLES, plan_effects
from pointcoord.results.by_series import ByChain
from pointcoord.results.cells import fill_cells

EPS = float(np.finfo(float).eps)
EVERY = ("velocity", "acceleration", "knuckle_rates", "wheel_angles", "toe", "caster", "damper")
RATES = ("velocity", "acceleration")
AT_REST = {"constant": 1.5}


def solved(name: str, effects: tuple[str, ...] | None = None, **changes: object) -> Motion:
    scene = every_effect(name)
    if effects is not None:
        changes["effects"] = tuple(effect for effect in effects if effect in scene.mechanism.effects)
    return simulate(scene.model_copy(update=changes))


def share_in_cells(motion: Motion, instants: np.ndarray) -> float:
    assert isinstance(motion.solved, ByChain)
    starts = np.array([segment.start for segment in motion.solved.chain.segments])
    filled = fill_cells(motion.solved, starts, instants, np.empty((motion.height, len(instants))))
    return float(filled.mean())


def test_a_motion_that_begins_from_rest_keeps_the_digits_of_its_first_rates() -> None:
    laws = {"arm_angle": [1.5, 0.0, 0.0, 0.05, -0.02], "rack": [0.0, 0.0, 0.0, 3.0, 1.0]}
    time = {"start": 0.0, "stop": 1.0, "samples": 11}
    motion = solved("bounce", inputs={n: {"polynomial": law} for n, law in laws.items()}, time=time)
    instants = np.linspace(0.0, 1.0, 400_000)
    assert share_in_cells(motion, instants) > 0.9
    which = np.unique(np.geomspace(1, 399_999, 600).astype(int))
    quick = among(motion.at(instants), which)
    slow = motion.at(instants[which])
    for quantity in ("velocity", "acceleration"):
        for name, array in quick.numbers[quantity].items():
            size = np.abs(slow.numbers[quantity][name]).max(axis=-1, keepdims=True)
            # Rates of t^3 are up to (17/15)^2 times as large elsewhere in a cell; some dozens of roundings.
            assert (np.abs(array - slow.numbers[quantity][name]) <= 100 * EPS * size).all()
    assert beyond_claims(motion.proof_of(quick, rates=True)) == []


def test_instants_far_from_time_zero_lose_nothing_to_the_rounding_of_time() -> None:
    inputs = {"arm_angle": AT_REST, "rack": {"sine": {"amplitude": 20.0, "angular_frequency": 5.0}}}
    late = solved("steer", inputs=inputs, time={"start": 3000.0, "stop": 3000.4, "samples": 11})
    instants = np.linspace(3000.0, 3000.4, 60_000)
    assert share_in_cells(late, instants) > 0.8
    which = np.arange(0, 60_000, 301)
    quick, slow = among(late.at(instants), which), late.at(instants[which])
    assert beyond_claims(late.proof_of(quick, rates=True)) == []
    # Of a point that moves with 100 mm/s, the rounding of 3000 s is 5e-11 mm.
    for name, array in quick.position.items():
        assert np.abs(array - slow.position[name]).max() < 2e-12


def test_close_instants_are_not_summed_over_where_a_table_of_the_chassis_jumps() -> None:
    """In its third derivative."""
    values = {"times": [0.0, 0.5, 0.61, 0.8, 1.3, 2.6], "values": [0.0, 9.0, -7.0, 12.0, 3.0, -5.0]}
    scene = Scene.load("bounce-on-a-heaving-chassis")
    motion = solved("bounce-on-a-heaving-chassis", RATES, inputs={**scene.inputs, "heave": {"table": values}})
    instants = np.linspace(0.0, 2.6, 50_000)
    assert share_in_cells(motion, instants) > 0.3
    which = np.unique([*range(0, 50_000, 1009), *range(9_600, 9_660), *range(11_700, 11_760)])
    assert beyond_claims(motion.proof_of(among(motion.at(instants), which), rates=True)) == []


def test_an_angle_that_jumps_is_read_on_its_own_side() -> None:
    toe = replace(CAR_NUMBERS["toe"], numbers=(replace(ANGLES["toe"], cosine="inboard"),))
    motion = solved("steer", inputs={"arm_angle": AT_REST, "rack": {"polynomial": [-40.0, 150.0]}})
    readout = replace(motion.solved.readout, plan=plan_effects(["toe"], {"toe": toe}))
    turned = replace(motion, solved=replace(motion.solved, readout=readout))
    instants = np.linspace(0.0, 0.4, 50_000)
    which = np.arange(0, 50_000, 17)
    quick, slow = turned.at(instants).wheel["toe"][which], turned.at(instants[which]).wheel["toe"]
    assert slow.min() < -3.0 < 3.0 < slow.max()
    assert 0.2 < share_in_cells(turned, instants) < 1.0
    aside = np.abs(slow) < np.pi - 1e-13
    assert np.abs(quick - slow)[aside].max() < 40 * EPS * 600 / 90


@pytest.mark.parametrize(("bad", "count"), [(-1e-9, 0), (2.6 + 1e-9, 1), (np.nan, 5000)])
def test_an_instant_outside_the_motion_is_refused_among_others_too(bad: float, count: int) -> None:
    motion = solved("bounce", ())
    asked = np.insert(np.linspace(0.0, 2.6, count), count // 2, bad)
    with pytest.raises(OutsideMotion, match=r"allowed: 0 to 2.6 s") as caught:
        motion.at(asked)
    assert caught.value.instant == bad or np.isnan(bad)
    assert motion.at(np.full(5000, 1.0)).position["wheel_centre"].shape == (5000, 3)


def test_nan_is_an_instant_outside_the_motion_also_where_gradients_are_computed() -> None:
    """Gradients need the inputs at the instants first."""
    motion = simulate(Scene.load("five-link").model_copy(update={"effects": ("toe_by_travel",)}))
    with pytest.raises(OutsideMotion, match="t = nan s is outside the motion"):
        motion.at(np.nan)


def test_results_are_written_where_they_are_wanted_and_nowhere_else() -> None:
    motion = solved("bounce", EVERY)
    instants = np.linspace(0.0, 2.6, 1000)
    out = np.full((motion.height, 1000), np.nan)
    samples = motion.at(instants, out=out)
    assert not np.isnan(out).any()
    assert differing(samples.numbers, motion.at(instants).numbers) == []
    assert all(np.shares_memory(array, out) for of in samples.numbers.values() for array in of.values())
    for wrong in (np.empty((3, 4)), np.empty((motion.height, 5)), np.empty((motion.height, 4), np.float32)):
        with pytest.raises(ValueError, match="allowed: a writeable array"):
            motion.at(np.zeros(4), out=wrong)


@pytest.mark.parametrize(("method", "size"), [("series", 7), ("newton", 1000)])
def test_blocks_of_a_motion_are_its_parts_in_order(method: str, size: int) -> None:
    motion = simulate(Scene.load("bounce"), method)
    blocks = list(motion.blocks(size=size))
    assert all(len(block.times) == size for block in blocks[:-1])
    np.testing.assert_array_equal(np.concatenate([block.times for block in blocks]), motion.times)
    joined = {
        quantity: {name: np.concatenate([block.numbers[quantity][name] for block in blocks]) for name in of}
        for quantity, of in motion.numbers.items()
    }
    assert differing(joined, motion.numbers) == []


@pytest.mark.parametrize("count", [1, 131, 20001])
def test_any_number_of_instants_comes_in_blocks_as_a_scene_has_them(count: int) -> None:
    motion, scene = solved("steer", ("velocity",)), Scene.load("steer")
    blocks = list(motion.blocks(count, size=4096))
    time = {"start": motion.times[0], "stop": motion.times[-1], "samples": max(count, 2)}
    instants = scene.model_copy(update={"time": time}).instants[:count]
    np.testing.assert_array_equal(np.concatenate([block.times for block in blocks]), instants)
    whole = motion.at(instants).position["wheel_centre"]
    given = [block.position["wheel_centre"] for block in motion.blocks(instants[::-1], 1000)]
    for found in (np.concatenate([b.position["wheel_centre"] for b in blocks]), np.concatenate(given)[::-1]):
        np.testing.assert_allclose(found, whole, rtol=0.0, atol=21 * 50 * EPS * 600)


def test_blocks_that_make_no_sense_are_refused() -> None:
    motion, newton = solved("steer", ()), simulate(Scene.load("steer"), "newton")
    asked: list[tuple[Callable[[], object], type[Exception], str]] = [
        (lambda: motion.blocks(10, size=0), ValueError, "a block of 0 instants"),
        (lambda: motion.blocks(0), ValueError, "0 instants; allowed"),
        (lambda: motion.blocks(np.zeros((2, 2))), ValueError, "shape"),
        (lambda: list(motion.blocks([0.0, 1e9])), OutsideMotion, "allowed"),
        (lambda: newton.blocks(10), NotComputed, "method 'series'"),
        (lambda: newton.at(0.1), NotComputed, "method 'series'"),
    ]
    for work, kind, words in asked:
        with pytest.raises(kind, match=words):
            work()


def peak(work: Callable[[], object]) -> int:
    """The most memory that was taken at once while something ran, bytes; numpy's arrays among it."""
    work()
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_many_instants_take_no_more_memory_than_their_results_and_some_blocks() -> None:
    motion = solved("bounce-on-a-heaving-chassis", EVERY)
    # Two blocks live at once: the one that was given out, and the next.
    block = 8 * 16384 * (motion.height + 1)
    many, few = (peak(lambda n=n: [None for _ in motion.blocks(n)]) for n in (120_000, 40_000))
    assert many < 1.01 * few < 2.01 * block + 8e6
    for order in (1, -1):
        instants = np.linspace(0.0, 2.6, 100_000)[::order]
        results = 8 * len(instants) * (motion.height + 1)
        assert peak(lambda asked=instants: motion.at(asked)) - results < 50 * len(instants) + 8e6
