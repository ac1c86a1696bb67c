"""Rates and effects of neighbours are bounded together; each must be as well bounded as by itself."""

import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene, simulate
from pointcoord.bounds.proof import Proof
from pointcoord.bounds.reported_bounds import Numbers
from pointcoord.effects.registry import EFFECTS
from pointcoord.results.motion import Motion
from pointcoord.results.samples import Samples
from pointcoord.results.states import StatesOfChain

Array = NDArray[np.float64]
SCENES = (
    "bounce",
    "steer",
    "bounce-and-steer",
    "bounce-on-a-heaving-chassis",
    "off-axis-strut",
    "double-wishbone",
)
# What a group may cost a rate is ROUNDED_RATES of what is expected of the coordinates, before ROUNDINGS; a
# point that is carried by three, and a turn that is told from differences of them, lose some times as much.
COSTS = 0.15
# Of what is expected of a number at another instant of its group.
LESS = 0.6


def of_all_effects(name: str) -> Motion:
    return simulate(Scene.load(name).model_copy(update={"effects": tuple(EFFECTS)}))


def dense(motion: Motion, count: int) -> Samples:
    return motion.at(np.linspace(motion.times[0], motion.times[-1], count))


def alone(motion: Motion, samples: Samples, monkeypatch: pytest.MonkeyPatch) -> Proof:
    """The proof in which every pose has its own inverse."""
    with monkeypatch.context() as patch:
        patch.setattr("pointcoord.bounds.proven_groups.TOGETHER", ())
        return motion.proof_of(samples, rates=True)


def named(bounds: Numbers) -> Iterator[tuple[str, str, Array]]:
    for quantity, part in bounds.items():
        for name, array in part.items():
            yield quantity, name, array


def held_to_the_plain_proof(motion: Motion, samples: Samples, monkeypatch: pytest.MonkeyPatch) -> None:
    together, plain = motion.proof_of(samples, rates=True), alone(motion, samples, monkeypatch)
    shared = False
    for quantity, name, bound in named(together.proven):
        own, expected = plain.proven[quantity][name], plain.expected[quantity][name]
        scale = expected.max()
        # The plain one is the error itself, to twice the working precision.
        assert (bound >= (1.0 - 1e-6) * own - 1e-10 * scale).all(), (quantity, name)
        assert (bound <= own + COSTS * scale + 1e-300).all(), (quantity, name)
        shared |= not np.array_equal(bound, own)
        ours = together.expected[quantity][name]
        assert (ours >= LESS * expected).all(), (quantity, name, (ours / expected).min())
        assert ours.max() <= 1.5 * scale, (quantity, name)
        assert (bound <= ours + 1e-27 * scale).all(), (quantity, name)
    assert shared
    for field in ("pose_bound", "bound", "carried_bound"):
        assert getattr(together, field).max() <= 1.1 * getattr(plain, field).max()


@pytest.mark.parametrize("name", SCENES)
def test_bounds_of_neighbours_are_as_sharp_as_those_of_instants_alone(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = of_all_effects(name)
    held_to_the_plain_proof(motion, dense(motion, 12_000), monkeypatch)


def test_bounds_of_neighbours_are_as_sharp_where_the_car_is_about_to_lock(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    # The arm ends at 152.0129 deg; the last instants are 1e-5 rad and less from it.
    end = float(np.deg2rad(152.012))
    motion = simulate(make_scene([1.5, end - 1.5], [0.0], start=0.0, stop=1.0))
    samples = motion.at(1.0 - np.geomspace(1e-2, 1e-9, 4000))
    held_to_the_plain_proof(motion, samples, monkeypatch)


def test_few_instants_far_apart_are_proven_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    motion = of_all_effects("bounce-and-steer")
    samples = dense(motion, 30)
    together, plain = motion.proof_of(samples, rates=True), alone(motion, samples, monkeypatch)
    for quantity, name, bound in named(together.proven):
        assert np.array_equal(bound, plain.proven[quantity][name]), (quantity, name)


def test_instants_in_any_order_are_bounded_as_in_order() -> None:
    motion = of_all_effects("double-wishbone")
    instants = np.linspace(0.5, 0.7, 3000)
    mixed = np.random.default_rng(1).permutation(len(instants))
    ordered, other = (motion.proof_of(motion.at(each), rates=True) for each in (instants, instants[mixed]))
    for bounds in ("proven", "expected"):
        for quantity, name, bound in named(getattr(ordered, bounds)):
            assert np.array_equal(bound[mixed], getattr(other, bounds)[quantity][name]), (quantity, name)
    assert np.array_equal(ordered.bound[mixed], other.bound)


@pytest.mark.parametrize("derivative", [1, 2])
def test_a_coefficient_that_is_off_is_in_the_bounds_of_the_rates(derivative: int) -> None:
    motion = of_all_effects("bounce-and-steer")
    states = motion.solved.states
    assert isinstance(states, StatesOfChain)
    segments = list(states.chain.segments)
    coefficients = segments[0].coefficients.copy()
    place = states.readout.mechanism.layout.vector("lower_ball_joint")[0]
    coefficients[derivative, place] *= 1.0 + 1e-10
    segments[0] = replace(segments[0], coefficients=coefficients)
    wrong_states = replace(states, chain=replace(states.chain, segments=tuple(segments)))
    wrong = replace(motion, solved=replace(motion.solved, states=wrong_states))
    instants = np.linspace(motion.times[0], segments[0].stop, 4000)[:-1]
    right, samples = motion.at(instants), wrong.at(instants)
    before, proof = motion.proof_of(right, rates=True), wrong.proof_of(samples, rates=True)
    for quantity in ("velocity", "acceleration")[: 3 - derivative][:derivative]:
        error = np.abs(
            samples.numbers[quantity]["lower_ball_joint"] - right.numbers[quantity]["lower_ball_joint"]
        )
        own = before.proven[quantity]["lower_ball_joint"]
        found = proof.proven[quantity]["lower_ball_joint"]
        assert error.max() > 20.0 * own.max()
        assert (found >= error - own).all()
        assert (found <= error + 0.1 * error.max()).all()


@pytest.mark.parametrize("quantity", ["velocity", "acceleration", "angular_velocity", "wheel"])
@pytest.mark.parametrize("spoilt", [np.nan, np.inf, 1e9])
def test_one_number_that_is_none_does_not_spoil_its_neighbours(
    quantity: str, spoilt: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = of_all_effects("bounce-and-steer")
    samples = motion.at(np.linspace(0.1, 0.11, 600))
    before = motion.proof_of(samples, rates=True)
    channel = samples.numbers[quantity]
    name = next(iter(channel))
    values = channel[name].copy()
    values[300] = spoilt
    wrong = replace(samples, numbers={**samples.numbers, quantity: {**channel, name: values}})
    found, plain = motion.proof_of(wrong, rates=True), alone(motion, wrong, monkeypatch)
    for other, part, bound in named(found.proven):
        # A product of matrices may be summed in another order: two roundings of a rounding.
        own = plain.proven[other][part][300]
        assert bound[300] == pytest.approx(own, rel=1e-3, abs=1e-28), (other, part)
        kept, was = (np.delete(each, 300, axis=0) for each in (bound, before.proven[other][part]))
        assert (kept <= was + COSTS * before.expected[other][part].max()).all(), (other, part)


def test_bounds_need_no_more_memory_than_their_numbers_and_a_block() -> None:
    motion = of_all_effects("bounce-on-a-heaving-chassis")
    samples = dense(motion, 40_000)
    motion.proof_of(samples.part(0, 5000), rates=True)
    tracemalloc.start()
    try:
        proof = motion.proof_of(samples, rates=True)
        numbers = sum(
            array.nbytes for bounds in (proof.proven, proof.expected) for *_, array in named(bounds)
        )
        own = sum(
            np.asarray(getattr(proof, f.name)).nbytes
            for f in fields(Proof)
            if isinstance(getattr(proof, f.name), np.ndarray)
        )
        assert tracemalloc.get_traced_memory()[1] <= numbers + own + 150e6
    finally:
        tracemalloc.stop()
