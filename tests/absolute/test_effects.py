"""Effects: their values, signs and claims, whatever the suspension; and how they are asked for."""

import dataclasses

import numpy as np
import pytest
import strut_motion
from exact_angles import ANGLES, exact_angles
from flat import built_in
from jets import DIGITS
from kinds import KINDS, Car, Kind, inputs_at, mirrored
from mpmath import mp, mpf
from reach_of_accuracy import off

import absolute

EPS = float(np.finfo(float).eps)
every_kind = pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
both_sides = pytest.mark.parametrize(("side", "out"), [("left", -1), ("right", 1)])


def drawn_pose(kind: Kind, car: Car) -> dict[str, np.ndarray]:
    return inputs_at(*((value, 0.0, 0.0) for value in strut_motion.drawn_inputs(car)))


@every_kind
@both_sides
def test_angles_are_those_of_the_exact_points(kind: Kind, side: str, out: int) -> None:
    reached = 0
    for seed in range(60):
        car = kind.random_car(seed, True)
        if side == "right":
            car = mirrored(car)
        random = np.random.default_rng(seed)
        angle, rack = strut_motion.drawn_inputs(car)
        goal = (angle + random.uniform(-0.3, 0.3), 0, 0), (rack + random.uniform(-40.0, 40.0), 0, 0)
        exact = kind.exact(car, *goal)
        model = kind.build(car, side=side)
        try:
            motion = absolute.solve(
                model, inputs_at(*goal), rates=False, conditions=True, effects=tuple(ANGLES)
            )
        except absolute.PoseError:
            continue
        assert exact is not None
        reached += 1
        for name, wanted in exact_angles(kind, car, exact, out).items():
            with mp.workdps(DIGITS):
                error = float(abs(wanted - mpf(float(motion.effects[name][0]))))
            # The shortest line is 50 mm long; both ends are off.
            assert error <= 2.0 * off(motion)[0] / 50.0, (seed, name)
    assert reached > 40


@every_kind
def test_a_mirrored_car_has_the_same_angles_on_its_other_side(kind: Kind) -> None:
    names = tuple(ANGLES)
    for seed in range(8):
        left, inputs = kind.random_car(seed, True), drawn_pose(kind, kind.random_car(seed, True))
        rack = float(left["rack_centre"][1] - left["tie_rod_inner"][1])
        inputs["rack"][0, 0] = -rack
        right = absolute.solve(
            kind.build(mirrored(left), side="right"), inputs, conditions=True, effects=names
        )
        inputs["rack"][0, 0] = rack
        plain = absolute.solve(kind.build(left), inputs, conditions=True, effects=names)
        for name in names:
            claim = 2.0 * (off(right) + off(plain)) / 50.0
            assert (np.abs(right.effects[name] - plain.effects[name]) <= claim).all(), (seed, name)


@every_kind
def test_angles_turn_with_the_car(kind: Kind) -> None:
    # A car whose frame is turned has the same angles where its directions are given.
    names = tuple(ANGLES)
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    for seed in range(8):
        car = kind.random_car(seed, True)
        inputs = drawn_pose(kind, car)
        plain = absolute.solve(kind.build(car), inputs, effects=names)
        turned = absolute.solve(
            kind.build({name: turn @ point for name, point in car.items()}, up=turn[:, 2], right=turn[:, 1]),
            inputs,
            effects=names,
        )
        for name in names:
            # The turned drawing is rounded: eps of 500 mm over axes of more than 50 mm, at a condition of 60.
            assert np.abs(turned.effects[name] - plain.effects[name]).max() < 10 * 60 * EPS, (seed, name)


@every_kind
def test_a_spin_axis_far_from_the_origin_keeps_its_digits(kind: Kind) -> None:
    car = kind.random_car(2, True)
    # On a grid of 2^-13 mm the shift is exact.
    car = {name: np.round(point * 8192.0) / 8192.0 for name, point in car.items()}
    far = {name: point + 2.0**30 for name, point in car.items()}
    inputs = drawn_pose(kind, car)
    near, away = (
        absolute.solve(kind.build(points), inputs, conditions=True, effects=("camber",))
        for points in (car, far)
    )
    claim = 2.0 * (off(near) + off(away)) / 50.0
    assert (np.abs(near.effects["camber"] - away.effects["camber"]) <= claim).all()


@every_kind
@pytest.mark.parametrize("length", [1.0, 1e-3])
def test_a_short_spin_axis_turns_as_well_as_a_long_one(kind: Kind, length: float) -> None:
    # Its ends are places hundreds of mm away, whose difference would have lost that many digits.
    for seed in range(4):
        car = kind.random_car(seed, True)
        car["wheel_axis_inner"] = car["wheel_centre"] + np.array([0.1, 1.0, 0.2]) * length
        angle, rack = strut_motion.drawn_inputs(car)
        goal = (angle + 0.1, 0, 0), (rack + 5.0, 0, 0)
        exact = kind.exact(car, *goal)
        assert exact is not None
        motion = absolute.solve(kind.build(car), inputs_at(*goal), effects=["camber"])
        wanted = exact_angles(kind, car, exact, -1)["camber"]
        with mp.workdps(DIGITS):
            error = float(abs(wanted - mpf(float(motion.effects["camber"][0]))))
        assert error < 1e-14


@pytest.mark.parametrize("lean", [-2.5, -0.4, 0.0, 0.2, 1.5, 3.0])
@both_sides
def test_a_wheel_that_is_leant_out_by_hand_has_that_camber(lean: float, side: str, out: int) -> None:
    car = KINDS["strut"].random_car(1, True)
    car = mirrored(car) if side == "right" else car
    outboard, up, forward = np.array([0.0, out, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([-1.0, 0.0, 0.0])
    # The way from the wheel's centre to its top leans out; the axis is at a right angle to it and to the
    # horizontal radius, and leads outboard while the wheel stands upright.
    top = np.cos(lean) * up + np.sin(lean) * outboard
    axis = -out * np.cross(top, forward)
    assert lean != 0.0 or axis @ outboard == 1.0
    car["wheel_axis_inner"] = car["wheel_centre"] - 60.0 * axis
    motion = absolute.solve(
        KINDS["strut"].build(car, side=side), drawn_pose(KINDS["strut"], car), effects=["camber"]
    )
    # The drawn axis is rounded as 500 mm over 60 mm, and comes back to the rounding of a pose.
    assert abs(motion.effects["camber"][0] - lean) < 10 * 60 * EPS


@pytest.mark.parametrize("lean", [-0.3, 0.0, 0.2])
@both_sides
def test_a_top_mount_moved_inboard_by_hand_is_kingpin(lean: float, side: str, out: int) -> None:
    car = KINDS["strut"].random_car(1, True)
    car = mirrored(car) if side == "right" else car
    inboard = np.array([0.0, -out, 0.0])
    top = car["lower_ball_joint"] + 500.0 * (
        np.cos(lean) * np.array([0.1, 0.0, 1.0]) + np.sin(lean) * inboard
    )
    car["strut_rod_end"] = top - 0.3 * (top - car["strut_lower"])
    car["strut_top"] = top
    motion = absolute.solve(
        KINDS["strut"].build(car, side=side), drawn_pose(KINDS["strut"], car), effects=["kingpin"]
    )
    assert abs(motion.effects["kingpin"][0] - lean) < 10 * 60 * EPS


def test_effects_are_told_only_when_asked_for(strut: absolute.Model) -> None:
    inputs = inputs_at((1.5, 0, 0), (3.0, 0, 0))
    bare = absolute.solve(strut, inputs)
    assert not bare.effects
    plain = absolute.solve(strut, inputs, effects=["kingpin"])
    assert list(plain.effects) == ["kingpin"]
    assert plain.effects["kingpin"].shape == (1,)
    with pytest.raises(ValueError, match="read-only"):
        plain.effects["kingpin"][0] = 0.0


def test_an_unknown_effect_is_refused_with_those_there_are(strut: absolute.Model) -> None:
    with pytest.raises(absolute.InputError, match=r"no effect 'lean'.*'camber', 'camber_by") as caught:
        absolute.solve(strut, inputs_at((1.5, 0, 0), (3.0, 0, 0)), effects=["camber", "lean"])
    assert caught.value.name == "lean"


def test_a_linkage_without_a_wheel_has_no_effects(strut: absolute.Model) -> None:
    bare = dataclasses.replace(strut, corner=dataclasses.replace(strut.corner, roles={}))
    with pytest.raises(absolute.DescriptionError, match="'camber' needs the role 'wheel_axis'"):
        absolute.solve(bare, inputs_at((1.5, 0, 0), (3.0, 0, 0)), effects=["camber"])
    assert absolute.solve(bare, inputs_at((1.5, 0, 0), (3.0, 0, 0))).position


def test_a_refused_motion_keeps_the_effects_before_it(strut: absolute.Model) -> None:
    racks = np.array([0.0, 40.0, 500.0])
    inputs = {
        "arm_angle": np.tile([1.6, 0.0, 0.0], (3, 1)),
        "rack": np.stack([racks, 0 * racks, 0 * racks], -1),
    }
    with pytest.raises(absolute.UnreachableError) as caught:
        absolute.solve(strut, inputs, effects=["camber"])
    assert caught.value.partial is not None
    assert caught.value.partial.effects["camber"].shape == (2,)


@pytest.mark.parametrize("side", ["Left", "", "both"])
def test_a_side_is_left_or_right(table: dict[str, tuple[float, float, float]], side: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=r"'left', 'right'"):
        built_in("macpherson", table, side=side)
