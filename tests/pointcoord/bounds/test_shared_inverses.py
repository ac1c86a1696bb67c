"""Neighbouring poses are proven by one inverse; each must be as well proven as by its own."""

import tracemalloc
from collections.abc import Callable
from dataclasses import fields, replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import SampleCar, by_car

from pointcoord import Scene, simulate
from pointcoord.bounds.certified_poses import Certifier
from pointcoord.bounds.proof import Proof
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.double_double import doubled_residual
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.neighbours import SHARED, Terms
from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from pointcoord.results.motion import Motion
from pointcoord.results.states import StatesOfChain
from pointcoord.solve.assembly import assemble

Array = NDArray[np.float64]
SINE = {"sine": {"amplitude": 0.3, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}
HEAVE = {"sine": {"amplitude": 40.0, "angular_frequency": 3.1, "phase": -0.2}}
# A group costs SHARED of the error and a tenth of u, where bounds are several u; the rest is rounding.
LOOSER = 1.0 + 2.0 * SHARED + 0.1


def dense(motion: Motion, count: int) -> Array:
    return np.linspace(motion.times[0], motion.times[-1], count)


def alone(motion: Motion, instants: Array, monkeypatch: pytest.MonkeyPatch) -> Proof:
    """The proof in which every pose has its own inverse."""
    with monkeypatch.context() as patch:
        patch.setattr("pointcoord.bounds.certified_poses.TOGETHER", ())
        return motion.proof_of(motion.at(instants))


def held_to_the_plain_proof(motion: Motion, instants: Array, monkeypatch: pytest.MonkeyPatch) -> None:
    together, plain = motion.proof_of(motion.at(instants)), alone(motion, instants, monkeypatch)
    assert not np.array_equal(together.bound, plain.bound)  # some were proven together
    for name in ("pose_bound", "bound", "carried_bound"):
        ratio = getattr(together, name) / getattr(plain, name)
        assert (ratio <= LOOSER).all(), (name, ratio.max())
        assert (ratio >= 1.0 - 1e-3).all(), (name, ratio.min())
    assert together.carried_gain == pytest.approx(plain.carried_gain, rel=1e-6)
    # Both see C(y), one in twice the working precision and one about a neighbour.
    assert together.residual == pytest.approx(plain.residual, abs=8.0 * UNIT_ROUNDOFF)
    # A row's scale is a power of two, so that the condition number may jump by it; elsewhere it is smooth.
    off = np.abs(np.log2(together.condition / plain.condition))
    assert np.median(off) < 1e-3
    assert off.max() < 1.0


@by_car
def test_bounds_of_neighbours_are_as_sharp_as_those_of_poses_alone(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch, car: SampleCar
) -> None:
    motion = simulate(make_scene(SINE, [0.0, 5.0], car=car, heave=HEAVE))
    held_to_the_plain_proof(motion, dense(motion, 6000), monkeypatch)


def test_bounds_of_neighbours_are_as_sharp_where_the_car_is_about_to_lock(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    # The arm ends at 152.0129 deg; the last instants are 1e-5 rad and less from it.
    end = float(np.deg2rad(152.012))
    motion = simulate(make_scene([1.5, end - 1.5], [0.0], start=0.0, stop=1.0))
    late = 1.0 - np.geomspace(1e-2, 1e-9, 6000)
    proof = motion.proof_of(motion.at(late))
    assert proof.condition[-1] > 10 * proof.condition[0] > 2e3
    held_to_the_plain_proof(motion, late, monkeypatch)


def test_instants_in_any_order_are_proven_as_in_order(make_scene: Callable[..., Scene]) -> None:
    motion = simulate(make_scene(SINE, [0.0, 5.0], heave=HEAVE))
    instants = dense(motion, 5000)
    mixed = np.random.default_rng(1).permutation(5000)
    ordered, other = (motion.proof_of(motion.at(each)) for each in (instants, instants[mixed]))
    for field in fields(Proof):
        one, many = getattr(ordered, field.name), getattr(other, field.name)
        if isinstance(one, np.ndarray):
            assert np.array_equal(one[mixed], many), field.name


@pytest.mark.parametrize("relative", [1e-11, 1e-9])
def test_a_coefficient_that_is_off_is_in_every_bound(
    make_scene: Callable[..., Scene], relative: float
) -> None:
    motion = simulate(make_scene(SINE, [0.0, 5.0]))
    states = motion.solved.states
    assert isinstance(states, StatesOfChain)
    segments = list(states.chain.segments)
    coefficients = segments[0].coefficients.copy()
    place = states.readout.mechanism.layout.vector("lower_ball_joint")[0]
    coefficients[1, place] *= 1.0 + relative
    segments[0] = replace(segments[0], coefficients=coefficients)
    wrong_states = replace(states, chain=replace(states.chain, segments=tuple(segments)))
    wrong = replace(motion, solved=replace(motion.solved, states=wrong_states))
    instants = np.linspace(motion.times[0], segments[0].stop, 5000)[:-1]
    right, samples = motion.at(instants), wrong.at(instants)
    proof = wrong.proof_of(samples)
    error = np.abs(samples.position["lower_ball_joint"] - right.position["lower_ball_joint"]).max(axis=-1)
    before = motion.proof_of(right).bound
    assert error.max() > 5.0 * before.max()
    assert (proof.bound >= error - before).all()
    # And no more than it: whole bodies turn with a ball joint that is off, by less than ten times as much.
    assert (proof.bound <= 10.0 * error + 2.0 * before).all()
    # A proof of what is right does not cover a number that is not.
    assert (motion.proof_of(samples).bound >= error - before).all()


def test_one_pose_that_is_none_does_not_spoil_its_neighbours(make_scene: Callable[..., Scene]) -> None:
    motion = simulate(make_scene(SINE, [0.0, 5.0]))
    instants = np.linspace(1.0, 1.01, 1024)
    y = motion.solved.states.coordinates(instants, 0)[0].T.copy()
    y[3, 500] = np.nan
    y[4, 600] += 0.5
    exact = {name: np.zeros(1024) for name in ("arm_angle", "rack")}
    found = Certifier(motion.solved.readout.mechanism).certify(instants, y, exact)
    assert np.flatnonzero(~np.isfinite(found.tail)).tolist() == [500, 600]
    assert np.flatnonzero(~np.isfinite(found.radius)).tolist() == [500, 600]
    assert np.delete(found.tail, [500, 600]).max() < 1e-15


def test_what_is_left_of_a_neighbour_is_seen_to_a_part_of_the_rounding_unit(strut: Mechanism) -> None:
    """C(a + d) about a, against rational numbers, and the assembly in the ball of every neighbour."""
    system, n = strut.map, strut.map.unknowns
    # Assembled, so that what is left is rounding and nothing hides that of looking at it.
    racks = -15.0 + 5.0 * np.linspace(0.0, 1.0, 8)
    y = assemble(strut, {"arm_angle": np.linspace(1.2, 1.21, 8), "rack": racks}).y
    rng = np.random.default_rng(5)
    rack = strut.layout.scalar("rack travel")
    rise = next(strut.layout.scalar(drive.coordinate) for drive in strut.topology.drives)
    moving = np.array([*range(n), rise, rack])
    lacks = np.zeros_like(y)
    lacks[:, rack] = 1e-17 * rng.uniform(-1.0, 1.0, size=8)
    change = np.zeros((n + 3, 1, 8))
    change[:-1, 0] = (y - y[0]).T[moving] + (lacks - lacks[0]).T[moving]
    lost = 2.0 * UNIT_ROUNDOFF * np.abs(change).max(axis=-1)
    lost[-2] += UNIT_ROUNDOFF * 4e-17
    data = np.zeros((1, system.size))
    found = Terms.of(system, moving).certify(y[:1], lacks[:1], data, change, lost.T)
    inverse = factorise(system.jacobian(y[0])).preconditioner
    for i in range(8):
        meant = [Fraction(a) + Fraction(b) for a, b in zip(y[i].tolist(), lacks[i].tolist(), strict=True)]
        exact = [
            sum(
                Fraction(p.coefficient)
                * (meant[p.left[0]] - meant[p.left[1]])
                * (meant[p.right[0]] - meant[p.right[1]])
                for p in row
            )
            for row in system.rows
        ]
        for k in range(n):
            step = sum(Fraction(x) * c for x, c in zip(inverse[k].tolist(), exact, strict=True))
            assert abs(Fraction(float(found.step[k, 0, i])) - step) <= Fraction(float(found.spread[k, 0, 0]))
        plain, _ = doubled_residual(system, y[i], lacks[i], np.zeros(system.size))
        assert found.residual[:, 0, i] == pytest.approx(plain, abs=0.1 * UNIT_ROUNDOFF)
    # Of poses a hundredth apart that part of u is rounded, times |X|, some twenty, and sums.
    assert found.spread.max() < 1e3 * 1e-2 * UNIT_ROUNDOFF


def test_an_inverse_that_belongs_to_a_neighbour_leaves_no_more_than_the_tail(strut: Mechanism) -> None:
    system, n = strut.map, strut.map.unknowns
    rack = strut.layout.scalar("rack travel")
    racks = -15.0 + 0.1 * np.linspace(-1.0, 1.0, 9)
    exact = assemble(strut, {"arm_angle": np.full(9, 1.2), "rack": racks}).y
    y = exact.copy()
    y[:, :n] += 1e-7 * np.random.default_rng(3).uniform(-1.0, 1.0, size=(9, n))
    moving = np.array([*range(n), rack])
    change = np.zeros((n + 2, 1, 9))
    change[:-1, 0] = (y - y[4]).T[moving]
    nothing = np.zeros((1, system.size))
    found = Terms.of(system, moving).certify(y[4:5], nothing, nothing, change, np.zeros((1, n + 2)))
    assert found.sound.all()
    left = np.abs((y - exact)[:, :n].T - found.step[:, 0])
    allowed = found.spread[:, 0] + found.tail[:, 0]
    assert (left <= allowed).all()
    # It is the neighbour's inverse that leaves it: of the pose that has its own, C's curvature only.
    assert left.max() > 0.05 * allowed.max() > 20.0 * left[:, 4].max()


def test_a_proof_needs_no_more_memory_than_its_result_and_a_block() -> None:
    motion = simulate(Scene.load("bounce-on-a-heaving-chassis"))
    samples = motion.at(dense(motion, 100_000))
    motion.proof_of(samples.part(0, 5000))
    tracemalloc.start()
    try:
        proof = motion.proof_of(samples)
        own = sum(np.asarray(getattr(proof, f.name)).nbytes for f in fields(Proof) if f.name != "times")
        assert tracemalloc.get_traced_memory()[1] <= own + 50e6
    finally:
        tracemalloc.stop()
