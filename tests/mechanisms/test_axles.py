"""What two wheels make, by all three mechanics: closed forms in many digits, and where there is no number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
from mpmath import acot, asin, atan, cos, cot, mpf, pi, sin
from three_mechanics import assert_exact, assert_none, by_each, over_time, scene_of, solved_by
from within_bounds import outside

from pointcoord import Scene, SceneError

RADIUS, WHEELBASE, HALF_TRACK = 300.0, 2500.0, 760.0
SIDES = {"left": -1, "right": 1}
# A wheel on a hinge that is fixed in the car: upright it steers, lengthwise it travels.
CORNER = {
    "bodies": {"chassis": ["a", "b"], "knuckle": ["a", "b", "inner", "centre"]},
    "inputs": {"turn": {"angle": "knuckle", "from": "drawing"}},
    "roles": {"knuckle": "knuckle", "wheel_axis": ["inner", "centre"]},
}
UPRIGHT = {"a": (0.0, HALF_TRACK, 100.0), "b": (0.0, HALF_TRACK, 500.0)}
WHEEL = {"inner": (0.0, 660.0, 300.0), "centre": (0.0, HALF_TRACK, 300.0)}
STEERING = ("turning_radius", "ackermann", "ackermann_error")
ROLL_CENTRE = ("axle_roll_centre_offset", "axle_roll_centre_height")


def lengthwise(y: float, z: float) -> dict[str, Any]:
    return {"a": (-100.0, y, z), "b": (100.0, y, z)}


def axle(
    right: Mapping[str, Any],
    effects: list[str],
    turns: Mapping[str, Any],
    left: Mapping[str, Any] | None = None,
    **inputs: Any,
) -> Scene:
    """Two such wheels by the hinge of the right one; the left one's is mirrored unless given."""
    parts = {side: {"mechanism": CORNER, "side": side, "mirrored": side == "left"} for side in SIDES}
    own = {f"left.{name}": place for name, place in (left or {}).items()}
    mechanism = {
        "parts": parts,
        "points": {**right, **WHEEL, **own},
        "wheel_radius": RADIUS,
        "car": {"wheelbase": WHEELBASE},
    }
    if inputs:
        roll = {"turns": "chassis", "about": "right.a", "along": "forward"}
        mechanism["inputs"] = {"roll": roll}
    return scene_of(mechanism, effects, **{f"{side}.turn": turns[side] for side in SIDES}, **inputs)


def at(turn: list[float], time: mpf) -> mpf:
    return mpf(turn[0]) + mpf(turn[1]) * time


@by_each
@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("inner", "outer"),
    [
        # The outer wheel by more or less than it has to, as much as the inner one, beyond a right angle; in
        # binary, so that no angle is rounded.
        ([0.1875, 0.3125], [0.171875, 0.34375]),
        ([0.25, 0.0], [0.25, 0.0]),
        ([1.25, 0.125], [0.625, 0.125]),
        ([1.75, 0.0], [1.75, 0.0]),
    ],
)
def test_steered_wheels_are_what_the_formulas_make_of_their_angles(
    who: str, sign: float, inner: list[float], outer: list[float]
) -> None:
    """Wheels that turn about upright hinges by their inputs; a turn to the left about up is positive."""
    turned = {"left": inner, "right": outer} if sign > 0 else {"left": outer, "right": inner}
    turns = {side: [sign * c for c in turn] for side, turn in turned.items()}
    effects = ["steer_angle", "ackermann", "toe", "toe_change_by_arcsine"]
    track, base = 2 * mpf(HALF_TRACK), mpf(WHEELBASE)

    def formula(time: mpf) -> dict[str, mpf]:
        left, right = (at(turns[side], time) for side in SIDES)
        one, other = (left, right) if sign > 0 else (-right, -left)
        radius = base * (cot(one) + cot(other)) / 2
        ideal = atan(base / (radius - track / 2)) - atan(base / (radius + track / 2))
        # The line of a wheel that is turned by more than a right angle meets the rear axle's behind it.
        goal = acot(cot(one) + track / base)
        return {
            "left.steer_angle": left,
            "right.steer_angle": right,
            "left.toe": -left,
            "right.toe": right,
            # Drawn straight ahead; an arcsine goes no farther than a right angle.
            "left.toe_change_by_arcsine": asin(sin(-left)),
            "right.toe_change_by_arcsine": asin(sin(right)),
            "turning_radius": abs(radius),
            "ackermann_error": other - (goal if goal >= 0 else goal + pi),
            **({"ackermann": 100 * (one - other) / ideal} if radius > track / 2 else {}),
        }

    assert_exact(solved_by(who, axle(UPRIGHT, effects, turns)), over_time(formula))


@by_each
@pytest.mark.parametrize(("left", "right"), [(0.0, 0.0), (0.1, -0.05), (0.0, 0.1)])
def test_wheels_that_are_not_steered_to_the_same_side_turn_about_nothing(
    who: str, left: float, right: float
) -> None:
    solution = solved_by(who, axle(UPRIGHT, ["ackermann", "axle"], {"left": left, "right": right}))
    assert_none(solution, STEERING)
    assert "track" in solution.numbers["dimension"]


# Different on both sides, and with a car that rolls about the right hinge.
@by_each
@pytest.mark.parametrize("roll", [0.0, 0.0625])
@pytest.mark.parametrize("left", [(-150.0, 420.0), (-200.0, 200.0)])
def test_swing_axles_roll_about_where_the_lines_through_their_hinges_meet(
    who: str, left: tuple[float, float], roll: float
) -> None:
    turns = {"left": [0.0625, 0.125], "right": [0.015625, 0.03125]}
    rolls = {"roll": roll} if roll else {}
    scene = axle(lengthwise(150.0, 420.0), ["axle"], turns, lengthwise(*left), **rolls)
    hinges = {"left": left, "right": (150.0, 420.0)}

    def formula(time: mpf) -> dict[str, mpf]:
        c, s = cos(mpf(roll)), sin(mpf(roll))

        def rolled(y: mpf, z: mpf) -> tuple[mpf, mpf]:
            """About forward, which is -x: z goes to y."""
            y, z = y - 150, z - 420
            return 150 + y * c + z * s, 420 + z * c - y * s

        contacts, slopes = {}, {}
        for side, sign in SIDES.items():
            turn, (p, q) = at(turns[side], time), hinges[side]
            # About rearward, as the hinge leads: y to z.
            y, z = sign * mpf(HALF_TRACK) - p, mpf(300) - q
            wheel = rolled(p + y * cos(turn) - z * sin(turn), q + y * sin(turn) + z * cos(turn))
            # The spin axis turns along, and the disc's lowest point lies square to it.
            tilt = turn - mpf(roll)
            y, z = contacts[side] = wheel[0] + RADIUS * sin(tilt), wheel[1] - RADIUS * cos(tilt)
            pivot = rolled(mpf(p), mpf(q))
            slopes[side] = (pivot[1] - z) / (pivot[0] - y)
        (y1, z1), (y2, z2) = contacts["left"], contacts["right"]
        one, other = slopes["left"], slopes["right"]
        across = (z2 - z1 + one * y1 - other * y2) / (one - other)
        ground = z1 + (z2 - z1) * (across - y1) / (y2 - y1)
        return {
            "track": y2 - y1,
            "axle_roll_centre_offset": across,
            "axle_roll_centre_height": z1 + one * (across - y1) - ground,
        }

    solution, exact = solved_by(who, scene), over_time(formula)
    assert_exact(solution, exact)
    # What is a nanometre off is seen.
    with pytest.raises(AssertionError):
        assert_exact(solution, {"track": [value + mpf("1e-6") for value in exact["track"]]})


@by_each
@pytest.mark.parametrize("left", [(-200.0, 0.0), (-HALF_TRACK, 0.0)])
def test_parallel_lines_and_a_wheel_that_stands_have_no_roll_centre(
    who: str, left: tuple[float, float]
) -> None:
    """A hinge as high as the contact point makes its line level; one in the contact point makes none."""
    right = lengthwise(250.0, 0.0 if left[0] > -HALF_TRACK else 180.0)
    scene = axle(right, ["axle"], {"left": 0.0, "right": 0.0}, lengthwise(*left))
    solution = solved_by(who, scene)
    assert_none(solution, ROLL_CENTRE)
    assert solution.numbers["dimension"]["track"] == pytest.approx(2.0 * HALF_TRACK, abs=1e-12)


LAWS = {"left.wheel_travel": [-15.0, 40.0], "right.wheel_travel": [25.0, -10.0], "rack": [6.0, 15.0]}
CAR = {
    "axle": "front",
    "wheelbase": 1600.0,
    "centre_of_gravity_height": 510.0,
    "brake_share": 0.375,
    "drive_share": 0.25,
}


@by_each
def test_each_wheel_of_an_axle_has_the_numbers_of_the_wheel_alone(who: str) -> None:
    points = Scene.load("axle-steer").mechanism.points
    given = {"wheel_radius": RADIUS, "car": CAR}
    wheels = {}
    for side in SIDES:
        own = {n.partition(".")[2]: p for n, p in points.items() if n.startswith(f"{side}.")}
        alone = {"type": "double_wishbone", "side": side, "points": own, **given}
        laws = {"wheel_travel": LAWS[f"{side}.wheel_travel"], "rack": LAWS["rack"]}
        effects = scene_of(alone, [], **laws).mechanism.effects
        wheels[side] = solved_by(who, scene_of(alone, effects, **laws))
    both = solved_by(who, scene_of({"type": "axle", "points": points, **given}, effects, **LAWS))
    for side, single in wheels.items():
        found, claims = (
            {q: {n: of[q][f"{side}.{n}"] for n in numbers} for q, numbers in single.numbers.items()}
            for of in (both.numbers, both.accuracy.claims)
        )
        assert outside(found, single.numbers, single.accuracy.claims, claims) == []


def beam(effects: list[str], **changes: Any) -> dict[str, Any]:
    """A beam that carries two wheels and turns about a hinge along the car at half height."""
    mechanism = {
        "parts": {side: {"side": side, "mirrored": side == "left"} for side in SIDES},
        "bodies": {
            "chassis": ["a", "b"],
            "beam": ["a", "b", *(f"{side}.{end}" for side in SIDES for end in ("inner", "centre"))],
        },
        "roles": {
            **{f"{side}.knuckle": "beam" for side in SIDES},
            **{f"{side}.wheel_axis": [f"{side}.inner", f"{side}.centre"] for side in SIDES},
        },
        "inputs": {"turn": {"angle": "beam", "from": "drawing"}},
        "points": {**lengthwise(0.0, 300.0), **WHEEL},
        "wheel_radius": RADIUS,
    }
    inputs = {"turn": {"polynomial": [0.0625, 0.125]}}
    time = {"start": 0.0, "stop": 1.0, "samples": 3}
    return {"effects": effects, "mechanism": mechanism | changes, "inputs": inputs, "time": time}


@by_each
def test_both_wheels_of_a_beam_have_numbers(who: str) -> None:
    solution = solved_by(who, Scene.from_mapping(beam(["camber", "wheel_travel"])))

    def formula(time: mpf) -> dict[str, mpf]:
        turn, half = at([0.0625, 0.125], time), mpf(HALF_TRACK)  # about rearward: the right wheel rises
        found = {}
        for side, sign in SIDES.items():
            found[f"{side}.camber"] = -sign * turn
            found[f"{side}.travel"] = sign * half * sin(turn)
            # The contact point lies square to the beam.
            found[f"{side}.half_track_change"] = half * (cos(turn) - 1) + sign * mpf(RADIUS) * sin(turn)
        return found

    assert_exact(solution, over_time(formula))


@pytest.mark.parametrize(
    ("effects", "changes", "words"),
    [
        (["roll_centre"], {}, "effects: 'roll_centre' needs each wheel on a body of its own"),
        (["axle"], {}, "effects: 'axle' needs each wheel on a body of its own"),
        ([], {"parts": {"right": {}}}, "roles.left.knuckle: is a role of 'left', which is no part"),
        ([], {"parts": {"left": {}, "right": {}, "a": {}}}, "parts.a: has no mechanism and no role"),
        ([], {"stand_ins": {"a": "a"}}, "stand_ins.a: is 'a', the omitted point itself; allowed: another"),
        ([], {"side": "right"}, "side: is 'right', but each part has its own side: left is left, right is"),
    ],
)
def test_a_wheel_is_a_part_with_roles_and_gives_a_beam_no_roll_centre(
    effects: list[str], changes: dict[str, Any], words: str
) -> None:
    with pytest.raises(SceneError, match=words):
        Scene.from_mapping(beam(effects, **changes))


@by_each
def test_a_car_of_two_axles_has_four_wheels(who: str) -> None:
    """Points of a part of a part, too: the rear axle's own, and the mirror images of both."""
    one = {"parts": {side: {"mechanism": CORNER, "side": side, "mirrored": side == "left"} for side in SIDES}}
    turns = {"left": 0.0625, "right": 0.03125}
    laws = {f"{end}.{side}.turn": turn for end in ("front", "rear") for side, turn in turns.items()}
    points = {**UPRIGHT, **WHEEL, **{f"rear.{n}": (2500.0, *p[1:]) for n, p in {**UPRIGHT, **WHEEL}.items()}}
    parts = {"front": {"mechanism": one}, "rear": {"mechanism": one}}
    mechanism = {"parts": parts, "points": points, "wheel_radius": RADIUS}
    scene = scene_of(mechanism, ["steer_angle"], **laws)
    assert scene.mechanism.points["rear.left.centre"] == (2500.0, -HALF_TRACK, 300.0)
    assert scene.mechanism.points["front.left.centre"] == (0.0, -HALF_TRACK, 300.0)
    exact = {f"{name.rpartition('.')[0]}.steer_angle": [mpf(turn)] * 3 for name, turn in laws.items()}
    assert_exact(solved_by(who, scene), exact)


def test_two_travels_are_said_to_be_of_two_wheels() -> None:
    inputs = {side: {"height": f"{side}.centre"} for side in SIDES}
    # A beam on a ball joint, held from swivelling by a rod.
    joints = {
        "bodies": {
            "chassis": ["a", "front"],
            "beam": ["a", "end", *(f"{side}.{end}" for side in SIDES for end in ("inner", "centre"))],
        },
        "rods": {"drag": ["front", "end"]},
        "points": {
            "a": (0.0, 0.0, 300.0),
            "end": (0.0, 500.0, 400.0),
            "front": (-800.0, 500.0, 400.0),
            **WHEEL,
        },
    }
    content = beam(["toe_by_travel"], **joints, inputs=inputs)
    content["inputs"] = {side: {"constant": 0.0} for side in SIDES}
    with pytest.raises(
        SceneError, match=r"there is left, right; drive one for each wheel; .* left\.wheel_travel"
    ):
        Scene.from_mapping(content)
    for name in SIDES:
        for table in (inputs, content["inputs"]):
            table[f"{name}.wheel_travel"] = table.pop(name)
    assert Scene.from_mapping(content).effects == ("toe_by_travel",)
