"""A bound for every number that a motion reports, by blocks and groups as alone, and its pieces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest
from changed_scenes import scene_with
from every_number import OF_A_WHEEL, asked
from scipy.ndimage import maximum_filter1d
from within_bounds import beyond_claims, differing

from pointcoord import Motion, Scene, simulate
from pointcoord.bounds import certified_poses
from pointcoord.bounds.certified_poses import SHARED
from pointcoord.bounds.summed import Summed
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.rounding import EPS
from pointcoord.results.by_series import ByChain
from pointcoord.results.proof import Numbers, Proof


def named(bounds: Numbers) -> dict[tuple[str, str], Array]:
    return {(quantity, name): array for quantity, part in bounds.items() for name, array in part.items()}


def test_only_what_is_asked_for_is_bounded() -> None:
    motion = simulate(scene_with("bounce-and-steer", samples=30, effects=["wheel_angles"]))
    assert not named(motion.proof().proven)
    assert {quantity for quantity, _ in named(motion.proof(rates=True).proven)} == {"position", "wheel"}


@cache
def with_every_number() -> Motion:
    """Of a car that has them all, of one side."""
    scene = asked("pushrod")
    assert {*OF_A_WHEEL, "loads"} <= {*scene.effects}
    return simulate(scene)


def test_a_wrong_number_is_proven_to_be_off_and_is_not_expected_to_be() -> None:
    motion = with_every_number()
    spoilt = {
        quantity: channel.with_arrays({name: array * (1.0 + 1e-9) for name, array in channel.items()})
        for quantity, channel in motion.numbers.items()
        if quantity != "position"
    }
    right = motion.proof(rates=True)
    wrong = replace(motion, numbers={**motion.numbers, **spoilt}).proof(rates=True)
    for (quantity, name), proven in named(wrong.proven).items():
        if quantity != "position":
            off, before = 1e-9 * np.abs(motion.numbers[quantity][name]), right.proven[quantity][name]
            assert (proven >= (1.0 - 1e-6) * off - before).all()
            assert (proven <= (1.0 + 1e-5) * off + 1.1 * before).all()
            expected = wrong.expected[quantity][name]
            assert expected == pytest.approx(right.expected[quantity][name], rel=1e-6, abs=1e-300)


def test_numbers_of_an_axle_that_turns_to_either_side_are_as_well_proven_as_expected() -> None:
    """Also near where the divisor of some is 0, where each instant is bounded alone."""
    effects = ["steer_angle", "ackermann", "axle"]
    motion = simulate(scene_with("axle-steer", samples=2000, effects=effects))  # 16 of them share an inverse
    turn = motion.wheel["left.steer_angle"]
    assert turn.min() < -0.1 < 0.1 < turn.max()
    proof = motion.proof(rates=True)
    assert beyond_claims(proof) == []
    for quantity, name in (("dimension", "turning_radius"), ("ackermann", "ackermann")):
        numbers = motion.numbers[quantity][name]
        assert np.isfinite(proof.proven[quantity][name][np.isfinite(numbers)]).all(), name


SINE = {"sine": {"amplitude": 0.3, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}
HEAVE = {"sine": {"amplitude": 40.0, "angular_frequency": 3.1, "phase": -0.2}}


def test_a_proof_in_blocks_is_the_proof_in_one(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    # Newton's states are looked up, so that a block changes no bit of them: every array must be the same.
    motion = simulate(make_scene(SINE, [0.0, 5.0], car="double-wishbone", heave=HEAVE, samples=30), "newton")
    whole = motion.proof(rates=True)
    monkeypatch.setattr("pointcoord.results.proof.BLOCK", 7)
    parts = motion.proof(rates=True)
    for field in fields(Proof):
        one, many = getattr(whole, field.name), getattr(parts, field.name)
        assert np.array_equal(one, many) if isinstance(one, np.ndarray) else differing(one, many) == []
    assert all(whole.proven[quantity] for quantity in ("position", "velocity", "wheel", "dimension"))
    # Every instant is another pose, so that no block may stand for another one.
    assert len(np.unique(whole.condition)) == 30
    assert np.isfinite(whole.carried_bound).all()


def test_neighbours_that_share_an_inverse_are_as_well_proven_as_each_alone_in_any_order(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    effects = ("acceleration", "knuckle_rates", "wheel_angles", "wheel_travel")
    motion = simulate(make_scene(SINE, [0.0, 5.0], car="off-axis-strut", heave=HEAVE, effects=effects))
    instants = np.linspace(motion.times[0], motion.times[-1], 3000)
    mixed = np.random.default_rng(1).permutation(3000)
    together, other = (motion.proof_of(motion.at(each), True) for each in (instants, instants[mixed]))
    with monkeypatch.context() as each:
        each.setattr(certified_poses, "LARGEST", 1)
        alone = motion.proof_of(motion.at(instants), True)
    assert not np.array_equal(together.pose_bound, alone.pose_bound)  # they were proven together
    # Sharing may cost this part of the pose's error, of the step and of what it leaves, the largest of all
    # that share, for they have one radius; a carried point is off by that times its gain.
    largest = maximum_filter1d(alone.pose_bound, 2 * certified_poses.LARGEST + 1)
    cost = 2.0 * SHARED * largest * alone.carried_gain + 2.0 * EPS
    for name in ("pose_bound", "bound", "carried_bound"):
        found, plain = getattr(together, name), getattr(alone, name)
        assert np.array_equal(found[mixed], getattr(other, name)), name
        assert (np.abs(found - plain) <= cost).all(), name
    assert beyond_claims(together) == []
    for (quantity, name), bound in named(together.proven).items():
        assert np.array_equal(bound[mixed], other.proven[quantity][name]), (quantity, name)


def test_a_gradient_at_a_coarsely_solved_pose_is_expected_to_be_off_with_the_pose() -> None:
    """Solved for at the pose, it has no series whose last terms say what is left out of it."""
    laws = {"rack": {"sine": {"amplitude": 8.0, "angular_frequency": 80.0, "phase": 1e6}}}
    time = {"start": 0.0, "stop": 1.0, "samples": 9}
    scene = scene_with(
        "bounce", {"wheel_radius": 300.0}, laws=laws, time=time, effects=["steering_axis_by_rack"]
    )
    right = simulate(scene, "newton").numbers["dimension_gradient"]
    motion = simulate(scene.model_copy(update={"tolerance": 1e-2}), "map")
    expected = motion.proof(rates=True).expected["dimension_gradient"]
    for name, gradient in motion.numbers["dimension_gradient"].items():
        off = np.abs(gradient - right[name])
        assert (off <= expected[name]).all(), off / expected[name]


def test_a_coefficient_that_is_far_off_is_in_the_bounds_with_what_curvature_makes_of_it() -> None:
    """Of every number: what points are off by the square of the coefficient is in what is made of them."""
    relative, motion = 1e-4, with_every_number()
    solved = motion.solved
    assert isinstance(solved, ByChain)
    segments = list(solved.chain.segments)
    coefficients = segments[0].coefficients.copy()
    layout = solved.readout.mechanism.layout
    for name, sign in (("lower_ball_joint", 1.0), ("tie_rod_outer", -1.0)):
        coefficients[1, layout.vector(name)[1]] += sign * relative
    segments[0] = replace(segments[0], coefficients=coefficients)
    wrong = replace(motion, solved=replace(solved, chain=replace(solved.chain, segments=tuple(segments))))
    # Not where the coefficient, times the time, is next to nothing: neighbours share what they may be off.
    instants = np.linspace(motion.times[0], segments[0].stop, 60)[6:-1]
    right, samples = motion.at(instants), wrong.at(instants)
    names = solved.readout.mechanism.topology.moving
    error = np.max([np.abs(samples.position[n] - right.position[n]).max(axis=-1) for n in names], axis=0)
    proof, before = wrong.proof_of(samples, True), motion.proof_of(right, True)
    assert (proof.bound >= error - before.bound).all()
    assert (proof.pose_bound >= error - before.bound).all()
    assert (proof.bound <= 1.1 * (error + before.bound)).all()
    for (quantity, name), bound in named(proof.proven).items():
        off = np.abs(samples.numbers[quantity][name] - right.numbers[quantity][name])
        assert (off <= bound + before.proven[quantity][name]).all(), (quantity, name)


def test_terms_that_cancel_are_rounded_with_the_condition_number() -> None:
    terms, value = np.array([[3.0, 1.0], [3.0, 1.0]]), np.array([[1.0, 1.0], [-3.0, 1.0]])
    summed = Summed(np.zeros((2, 2)), np.zeros((2, 2)), terms)
    found = summed.expected(value, np.array([100.0, 100.0]), np.ones(2))
    # Of the first pose 3 - 1 of the first coordinate has cancelled, of the second nothing.
    np.testing.assert_allclose(found, EPS * np.array([[203.0, 201.0], [3.0, 1.0]]), rtol=1e-12)
