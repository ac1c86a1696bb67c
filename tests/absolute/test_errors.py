"""The error estimated of each component: never below the true one, and never far above it."""

from collections.abc import Callable, Iterator
from typing import Any

import jets
import numpy as np
import pytest
from dead_points import ENDS
from flat import built_in
from kinds import KINDS, Car, Kind
from mpmath import mp, mpf
from numpy.typing import NDArray
from strut_motion import drawn_inputs

import absolute
from absolute.initial_assembly import assemble
from absolute.mechanism import Mechanism
from absolute.refine import refine
from absolute.rounding import pose_doubt
from absolute.tracking import Found

Array = NDArray[np.float64]
Held = Callable[[float, float], dict[str, Array]]
EPS = float(np.finfo(float).eps)
PARTS = {"position": "x", "velocity": "v", "acceleration": "a"}
MOVED = ("tie_rod_outer", "wheel_centre")
SPINS = {"angular_velocity": 0, "angular_acceleration": 1}


def shares(exact: Any, motion: absolute.Solution) -> Iterator[tuple[str, str, Array, Array]]:
    """(quantity, name, error, estimate) of everything that a closed form knows, at the only instant."""
    for quantity, part in PARTS.items():
        for name, place in exact.points.items():
            error = jets.errors_of([getattr(x, part) for x in place], getattr(motion, quantity)[name][0])
            yield quantity, name, error, getattr(motion, f"{quantity}_error")[name][0]
    for quantity, order in SPINS.items():
        for name, spin in exact.spins.items():
            error = jets.errors_of(spin[order], getattr(motion, quantity)[name][0])
            yield quantity, name, error, getattr(motion, f"{quantity}_error")[name][0]


def at(angle: float, rack: float, rates: Array) -> dict[str, Array]:
    return {
        "arm_angle": np.array([[angle, *rates[:2]]]),
        "rack": np.array([[rack, *(200.0 * rates[2:])]]),
    }


def car_of(kind: Kind, seed: int) -> Car:
    return kind.random_car(seed, seed % 2 == 0 or kind is KINDS["collinear strut"])


def test_errors_of_random_cars_are_below_their_estimates_and_not_far_below(kind: Kind) -> None:
    largest = dict.fromkeys((*PARTS, *SPINS), 0.0)
    relative: dict[str, list[float]] = {quantity: [] for quantity in largest}
    solved = 0
    for seed in range(200):
        car = car_of(kind, seed)
        random = np.random.default_rng(seed)
        angle, rack = drawn_inputs(car)
        goal = angle + random.uniform(-0.4, 0.4), rack + random.uniform(-50.0, 50.0)
        inputs = at(*goal, random.uniform(-1.0, 1.0, 4))
        exact = kind.exact(car, *(series[0] for series in inputs.values()))
        try:
            motion = absolute.solve(kind.build(car), inputs, errors=True)
        except absolute.PoseError:
            continue
        solved += 1
        for quantity, name, error, estimate in shares(exact, motion):
            assert (error <= estimate).all(), (seed, quantity, name)
            told = estimate > 0
            largest[quantity] = max(largest[quantity], *(error[told] / estimate[told]), 0.0)
            value = np.linalg.norm(getattr(motion, quantity)[name][0])
            if value > 0:
                relative[quantity].append(float(estimate.max() / value))
    assert solved > 165
    for quantity, share in largest.items():
        # Roundings are counted one by one: of thousands, some come near a tenth of the worst.
        assert share > 0.05, quantity
        # A fault of 1e-11 of a quantity stands out a hundred times.
        assert np.median(relative[quantity]) < 1e-13, quantity


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("before", [1e-14, 1e-13, 1e-12, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3])
def test_errors_near_dead_points_are_below_their_estimates(end: Any, before: float) -> None:
    random = np.random.default_rng(int(-np.log10(before)))
    model = end.kind.build(end.car)
    for share in random.uniform(1.0, 10.0, 4):
        goal = [inside - share * before * out for inside, out in zip(end.inside, end.out, strict=True)]
        inputs = at(*goal, random.uniform(-1.0, 1.0, 4))
        exact = end.kind.exact(end.car, *(series[0] for series in inputs.values()))
        assert exact is not None
        motion = absolute.solve(model, inputs, errors=True)
        for quantity, name, error, estimate in shares(exact, motion):
            assert (error <= estimate).all(), (quantity, name)
            # Only within some hundred roundings of the end may rates be anything.
            assert np.isfinite(estimate).all() or (quantity != "position" and before <= 1e-13)


@pytest.mark.parametrize("turns", [1.0, 1e3])
def test_errors_of_another_linkage_are_below_their_estimates(turns: float) -> None:
    # A slider crank: x = 50 cos a + sqrt(l^2 - y^2), y the pin's height, the crank turning evenly.
    z, x = (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)
    pin, piston = (50.0 * np.cos(1.1), 50.0 * np.sin(1.1), 0.0), (147.0, 0.0, 0.0)
    axis, ends_of = absolute.Axis, absolute.Joint
    model = absolute.Model(
        {"pivot": (0.0, 0.0, 0.0), "pin": pin, "piston": piston},
        "ground",
        {"ground": ("pivot",), "crank": ("pivot", "pin"), "slider": ("piston",)},
        {
            "crank_pivot": ends_of("revolute", "ground", "crank", axis("pivot", z), axis("pivot", z)),
            "rod": ends_of("distance", "crank", "slider", axis("pin"), axis("piston")),
            "bore": ends_of("prismatic", "ground", "slider", axis("pivot", x), axis("piston", x)),
        },
        {"angle": absolute.Input("ground", axis("pivot", x), "crank", "pin", "cosine", 50.0)},
        absolute.Corner((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0)),
    )
    angles = np.linspace(0.3, 2.8, 60)
    series = np.stack([angles, np.full(60, turns), np.zeros(60)], -1)
    motion = absolute.solve(model, {"angle": series}, errors=True)
    share = dict.fromkeys(PARTS, 0.0)
    with mp.workdps(jets.DIGITS):
        crank, rod = (jets.fixed(line) for line in (pin, np.subtract(piston, pin)))
        for k, row in enumerate(series):
            along = jets.number(50.0) * jets.Jet(*map(mpf, row)).cosine()
            height = jets.dot(crank, crank) - along * along
            place = along + (jets.dot(rod, rod) - height).root()
            for quantity, part in PARTS.items():
                found, told = (getattr(motion, quantity + e)["piston"][k] for e in ("", "_error"))
                error = jets.errors_of([getattr(place, part)], found[:1])[0]
                assert error <= told[0], (quantity, k)
                share[quantity] = max(share[quantity], error / told[0])
    assert min(share.values()) > 0.02, share


def test_rows_close_to_what_they_are_rounded_from(kind: Kind) -> None:
    # At a pose that corrections have settled, what is left of a row is rounding, and not much less.
    largest: dict[str, float] = {}
    for seed in range(40):
        mechanism = Mechanism(kind.build(car_of(kind, seed)))
        try:
            pose, _ = assemble(mechanism)
        except absolute.PoseError:
            continue
        inputs = mechanism.drawn_inputs[None, None] * np.array([1.0, 0.0, 0.0])[:, None]
        targets = mechanism.target_series(inputs)
        # Corrections stop where they are expected to leave eps; refined, what is left is rounding.
        found = Found(pose.q[None], np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.bool_), pose.signs)
        refined = refine(mechanism, found, targets, False)
        poses, target = mechanism.stack.place(refined.rotation, refined.origin), targets[0]
        doubt = pose_doubt(mechanism, poses, target)
        known = np.abs(target - poses.values)
        for owner, left, rounded in zip(mechanism.stack.owners, known[0], doubt[0], strict=True):
            largest[owner] = max(largest.get(owner, 0.0), left / rounded)
    assert max(largest.values()) < 1.0, largest
    # The rack slides along an axis of coordinates, and nothing is rounded there.
    assert np.median(list(largest.values())) > 0.02, largest


def test_a_point_does_not_take_the_sensitivity_of_another() -> None:
    end = next(end for end in ENDS if end.limit == "rack")
    goal = [inside - 1e-10 * out for inside, out in zip(end.inside, end.out, strict=True)]
    motion = absolute.solve(built_in("macpherson", end.car), at(*goal, np.full(4, 0.5)), errors=True)
    # The rack's own end moves with the rack, however near the tie rod is to its dead point.
    assert motion.position_error["tie_rod_outer"].max() > 1e-9
    assert motion.position_error["tie_rod_inner"].max() < 1e-11
    # What is left of its velocity equation comes from a factorisation together with the fast bodies.
    fast, slow = (motion.velocity_error[f"tie_rod_{end}"].max() for end in ("outer", "inner"))
    assert slow < 1e-4 * fast


def test_what_is_added_for_the_chassis_is_rounded_once_more(strut: absolute.Model, held: Held) -> None:
    far = np.zeros((1, 3, 3))
    far[0, 0] = 1e9, 0.0, 0.0
    near, away = (
        absolute.solve(strut, held(1.5, 3.0), chassis=chassis, errors=True) for chassis in (None, far)
    )
    for name, error in away.position_error.items():
        assert np.allclose(
            error - near.position_error[name], [0.5 * EPS * 1e9, 0, 0], rtol=1e-5, atol=0.5 * EPS * 1e3
        ), name


def test_errors_are_told_only_when_asked_for(strut: absolute.Model, held: Held) -> None:
    bare = absolute.solve(strut, held(1.5, 3.0))
    poses = absolute.solve(strut, held(1.5, 3.0), rates=False, errors=True)
    told = absolute.solve(strut, held(1.5, 3.0), errors=True)
    for quantity in (*PARTS, *SPINS, "rotation"):
        assert not getattr(bare, f"{quantity}_error")
        assert getattr(told, f"{quantity}_error")
        assert bool(getattr(poses, f"{quantity}_error")) == (quantity in ("position", "rotation"))
    for name in strut.points:
        assert (told.position[name] == bare.position[name]).all()
        assert (told.acceleration[name] == bare.acceleration[name]).all()
        # Positions alone leave out nothing that positions need.
        assert (poses.position_error[name] == told.position_error[name]).all()
        with pytest.raises(ValueError, match="read-only"):
            told.position_error[name][0] = 0.0
    assert list(told.position_error) == list(told.position)


def test_a_long_motion_has_the_errors_of_each_of_its_instants(
    strut: absolute.Model, both: Callable[[Array], dict[str, Array]]
) -> None:
    inputs = both(np.linspace(0.0, 2.6, 40))
    whole = absolute.solve(strut, inputs, errors=True)
    tail = absolute.solve(strut, {name: series[30:] for name, series in inputs.items()}, errors=True)
    for name in strut.points:
        assert whole.velocity_error[name].shape == (40, 3)
        # The same pose to rounding: a handful of the numbers that are left of an equation differ.
        assert np.allclose(whole.velocity_error[name][30:], tail.velocity_error[name], rtol=0.5)
    racks = np.array([0.0, 40.0, 80.0, 500.0])
    with pytest.raises(absolute.UnreachableError) as caught:
        absolute.solve(
            strut,
            {
                "arm_angle": np.tile([np.pi / 2, 0.0, 0.0], (4, 1)),
                "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
            },
            errors=True,
        )
    assert caught.value.partial is not None
    assert caught.value.partial.position_error["wheel_centre"].shape == (3, 3)
    none = absolute.solve(strut, {name: series[:0] for name, series in inputs.items()}, errors=True)
    assert none.position_error["wheel_centre"].shape == (0, 3)
