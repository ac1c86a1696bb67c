"""Lengths about the wheel and the steering axis, and gradients.

They are drawn as whole numbers, computed by their words from positions, and held to differences of poses.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from exact_vectors import number, numbers, size
from mechanism_drawings import described, five_link
from mpmath import mpf
from plain_mechanisms import plain_mechanism
from reference_cars import CARS

from validate.reference import BadInputError, Design, Instant, closed_drawing, instants_of, solve_reference
from validate.reference.effects.registry import ANGLES, EFFECTS, OF_POSITIONS
from validate.reference.vectors import Vector, cross, dot, minus, plus, times

EVERY = tuple(EFFECTS)
WITHIN = mpf("1e-55")
UP, RIGHT, FORWARD = (0, 0, 1), (0, 1, 0), (-1, 0, 0)  # x rearward, y right, z up

# A right wheel that toes out and leans in at the top: its spin axis (36, 48, 25) is 65 long, 60 of it level.
# So the lowest point of a disc of 260 lies 260 * 25 / 65 = 100 along (36, 48) / 60, and 260 * 60 / 65 = 240
# below the centre: (1060, 780, 60). The steering axis (30, -60, 240) is at (1000, 735) there, and at
# (1030, 675) as high as the centre.
WHEEL = {
    "wheel_axis_inner": (964, 652, 275),
    "wheel_centre": (1000, 700, 300),
    "lower": (1015, 705, 180),
    "upper": (1045, 645, 420),
    "damper_low": (1014, 421, 558),
}
DAMPER_TOP = (1000, 400, 600)  # (14, 21, -42) = 7 (2, 3, -6)
RADIUS = 260
DRAWN = {
    "travel": 0,
    "contact_travel": 0,
    "half_track_change": 0,
    "recession": 0,
    "kingpin_offset": 45,
    "scrub_radius": 75,
    "mechanical_trail": 21,  # 60 ahead and 45 inboard, along (48 forward, 36 outboard) / 60
    "castor_offset": 60,
    "kingpin_offset_at_wheel": 25,
    "hub_trail": 30,
    "damper_length": 49,
}
ROLES = {
    "knuckle": "arm",
    "wheel_axis": ["wheel_axis_inner", "wheel_centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_low"],
}
SWING = {"swing": {"angle": "arm", "from": "drawing"}}


def on_an_arm(
    pivot: tuple[int, ...], end: tuple[int, ...], inputs: Mapping[str, Any] = SWING, **others: Any
) -> dict[str, Any]:
    """The wheel on an arm about the line from `pivot` to `end`."""
    return described(
        {**WHEEL, "damper_top": DAMPER_TOP, "pivot": pivot, "end": end},
        {"chassis": ["pivot", "end", "damper_top"], "arm": ["pivot", "end", *WHEEL]},
        inputs,
        **{"roles": ROLES, "side": "right", "wheel_radius": RADIUS, **others},
    )


def by_hand(
    points: Mapping[str, Vector],
    drawn: Mapping[str, Vector],
    roles: Mapping[str, Any],
    radius: object,
    out: int,
) -> dict[str, mpf]:
    """The numbers of positions by their words, by components along outboard, rearward and up."""

    def parts(vector: Vector) -> Vector:
        return out * vector[1], vector[0], vector[2]

    def contact(places: Mapping[str, Vector]) -> Vector:
        inner, centre = (places[name] for name in roles["wheel_axis"])
        o, r, u = parts(minus(centre, inner))
        level, whole = mpmath.hypot(o, r), mpmath.sqrt(o * o + r * r + u * u)
        beside, below = number(radius) * u / whole, number(radius) * level / whole
        return plus(parts(centre), (beside * o / level, beside * r / level, -below))

    inner, centre = (parts(points[name]) for name in roles["wheel_axis"])
    lower, upper = (parts(points[name]) for name in roles["steering_axis"])
    c, went = contact(points), minus(contact(points), contact(drawn))

    def pierced(height: mpf) -> Vector:
        return plus(lower, times(minus(upper, lower), (height - lower[2]) / (upper[2] - lower[2])))

    ground, level = pierced(c[2]), pierced(centre[2])
    o, r, _ = minus(centre, inner)
    ahead = (r / mpmath.hypot(o, r), -o / mpmath.hypot(o, r), 0)  # level, at right angles to the spin axis
    found = {
        "travel": centre[2] - drawn[roles["wheel_axis"][1]][2],
        "contact_travel": went[2],
        "half_track_change": went[0],
        "recession": went[1],
        "kingpin_offset": c[0] - ground[0],
        "scrub_radius": size(minus(c, ground)),
        "mechanical_trail": dot(minus(ground, c), ahead),
        "castor_offset": c[1] - ground[1],
        "kingpin_offset_at_wheel": centre[0] - level[0],
        "hub_trail": level[1] - centre[1],
    }
    if "damper" in roles:
        found["damper_length"] = size(minus(*(points[name] for name in roles["damper"])))
    return found


def test_a_wheel_that_is_drawn_in_whole_numbers_has_its_offsets() -> None:
    plain = on_an_arm((600, 400, 300), (600, 500, 300))
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    for name, value in DRAWN.items():
        assert abs(found.effects[name] - value) < WITHIN, name


def test_a_wheel_on_a_trailing_arm_turns_with_it() -> None:
    # About the line along y through (600, -, 300), 400 ahead of the centre; right-handed, so up is minus.
    plain = on_an_arm((600, 400, 300), (600, 500, 300))
    theta, still = -mpmath.asin(mpf(3) / 5), closed_drawing(Design.from_plain(plain)).instant
    found = solve_reference(plain, {"swing": (theta, 0, 0)}, effects=EVERY)
    assert abs(found.effects["travel"] - 240) < WITHIN
    assert abs(found.effects["caster"] - (still.effects["caster"] + theta)) < WITHIN
    # d travel / d theta = -400 cos(theta).
    assert abs(found.effects["caster_by_travel"] + mpf(1) / 320) < WITHIN
    assert abs(found.effects["travel_by_travel"] - 1) < WITHIN
    # dL / d theta = (low - top) . d low / L, where low = (600 + x, y, 300 + z) turns with (z, 0, -x).
    x, y, z = minus(found.position["damper_low"], (600, 0, 300))
    low, top = (600 + x, y, 300 + z), DAMPER_TOP
    slope = dot(minus(low, top), (z, 0, -x)) / size(minus(low, top))
    assert abs(found.effects["damper_length_by_travel"] + slope / 320) < WITHIN
    # All goes along the car, so the normal of the contact point's path meets the middle plane at its height.
    assert abs(found.effects["roll_centre_height"]) < WITHIN
    (same,) = instants_of(
        Design.from_plain(on_an_arm((600, 400, 300), (600, 500, 300), {"rise": {"height": "wheel_centre"}})),
        [{"rise": (240, 0, 0)}],
        effects=EVERY,
    )
    assert set(same.effects) == set(found.effects)
    assert all(abs(same.effects[name] - value) < WITHIN for name, value in found.effects.items())


@pytest.mark.parametrize("end", [(100, 200, 400), (110, 203, 398)])
def test_the_roll_centre_of_a_swing_axle_lies_on_the_line_through_its_hinge(end: tuple[int, ...]) -> None:
    plain = on_an_arm((1100, 200, 400), end)
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    # As a point of the arm the contact point moves at right angles to the hinge and to its arm.
    along = minus(end, (1100, 200, 400))
    _, y, z = numbers(cross(along, minus((1060, 780, 60), (1100, 200, 400))))
    assert abs(found.effects["roll_centre_height"] - 780 * y / z) < WITHIN
    if end[1:] == (200, 400):
        # In the front view the hinge is a point: (200, 400) as seen from (780, 60).
        assert abs(found.effects["roll_centre_height"] - mpf(340 * 780) / 580) < WITHIN
    away = {**plain, "points": {name: (x + 50, y, z - 70) for name, (x, y, z) in plain["points"].items()}}
    there = closed_drawing(Design.from_plain(away), effects=EVERY).instant
    assert abs(there.effects["roll_centre_height"] - found.effects["roll_centre_height"]) < WITHIN


@pytest.mark.parametrize(("x", "lost"), [(1000, "toe_by_travel"), (1060, "roll_centre_height")])
def test_a_wheel_that_does_not_travel_has_no_gradients_by_it(x: int, lost: str) -> None:
    # The centre is right below the pivot, and goes along the car; or the contact point is.
    plain = on_an_arm((x, 400, 500), (x, 500, 500))
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    gradients = {name for name in EVERY if name.endswith("_by_travel")}
    assert {name for name in gradients if name in found.effects} == (gradients if x == 1060 else set())
    assert lost not in found.effects
    assert "the wheel does not travel" in found.left_out[lost]
    assert set(OF_POSITIONS) <= set(found.effects)


def moved_car(name: str) -> dict[str, Any]:
    """A car whose chassis rolls, pitches and is displaced up and aside."""
    car = CARS[name]
    plain = plain_mechanism(
        car.suspension, car.points, closure=car.closure, side=car.side, wheel_radius=car.wheel_radius
    )
    chassis = plain["bodies"]["chassis"]
    moves = {
        "roll": {"turns": "chassis", "about": chassis[0], "along": "forward"},
        "pitch": {"turns": "chassis", "about": chassis[1], "along": "right"},
        "sideways": {"moves": "chassis", "along": "right"},
    }
    return {**plain, "inputs": {**plain["inputs"], **moves}}


def poses_of(name: str, **more: Any) -> dict[str, tuple[Any, ...]]:
    """Inputs some way from the drawing, on a chassis that is turned."""
    car = CARS[name]
    values = {n: triple[0] for n, triple in car.inputs.items()}
    values |= {"roll": Fraction(1, 20), "pitch": Fraction(-1, 30), "sideways": Fraction(9)}
    values["arm_angle"] += Fraction(1, 10)
    return {n: (value + more.get(n, 0), 0, 0) for n, value in values.items()}


def solved(name: str, inputs: Mapping[str, tuple[Any, ...]], digits: int = 60) -> Instant:
    (found,) = instants_of(Design.from_plain(moved_car(name)), [inputs], digits, effects=EVERY)
    return found


@pytest.mark.parametrize("name", CARS)
def test_numbers_of_positions_are_those_of_their_words_on_a_turned_chassis(name: str) -> None:
    plain, inputs, car = moved_car(name), poses_of(name), CARS[name]
    drawn = {point: numbers(place) for point, place in plain["points"].items()}
    out = 1 if car.side == "right" else -1
    found = solved(name, inputs)
    shift = (0, inputs["sideways"][0], inputs["heave"][0])
    there = {point: minus(place, numbers(shift)) for point, place in found.position.items()}
    level = solved(name, {n: triple for n, triple in inputs.items() if n in ("arm_angle", "rack")})
    wanted = by_hand(there, drawn, plain["roles"], car.wheel_radius, out)
    upright = by_hand(level.position, drawn, plain["roles"], car.wheel_radius, out)
    on_chassis = {"travel", "contact_travel"}
    # Angles are in test_angles, and those by arcsine in tests of all three mechanics.
    others = {"damper_length", "steer_angle", "camber_by_arcsine", "toe_by_arcsine"}
    assert set(wanted) | others == set(OF_POSITIONS) - set(ANGLES)
    for one, value in wanted.items():
        assert abs(found.effects[one] - (upright if one in on_chassis else wanted)[one]) < WITHIN, one
        assert abs(level.effects[one] - upright[one]) < WITHIN, one
        # A check of the check: the turns of the chassis are seen, but by a length of the car.
        assert one == "damper_length" or abs(value - upright[one]) > 1e-3, one


@pytest.mark.parametrize("name", CARS)
def test_gradients_are_the_differences_of_proven_poses(name: str) -> None:
    # A central difference is off by step^2 / 6 of the third derivative, by rad here below 1e6 and by mm less:
    # by 2e-39. Of a quotient by d travel, of 100 mm/rad at least, it is off by no more.
    step, off = Fraction(1, 10**22), mpf("1e-38")
    here = solved(name, poses_of(name))
    by_arm, by_rack = (
        [solved(name, poses_of(name, **{one: sign * step}), 100).effects for sign in (1, -1)]
        for one in ("arm_angle", "rack")
    )
    travelled = by_arm[0]["travel"] - by_arm[1]["travel"]
    assert abs(travelled) > 200 * number(step)
    names = set(OF_POSITIONS) - {"damper_length"}
    assert {f"{one}_{way}" for one in names for way in ("by_travel", "by_rack")} <= set(here.effects)
    for one in names:
        ahead, behind = (by_arm[k][one] for k in range(2))
        assert abs(here.effects[f"{one}_by_travel"] - (ahead - behind) / travelled) < off, one
        ahead, behind = (by_rack[k][one] for k in range(2))
        assert abs(here.effects[f"{one}_by_rack"] - (ahead - behind) / (2 * number(step))) < off, one


@pytest.mark.parametrize("name", CARS)
def test_numbers_by_time_are_the_differences_of_proven_poses_a_moment_apart(name: str) -> None:
    # As above: all inputs move by less than 50 rad/s or mm/s here.
    step, off = Fraction(1, 10**22), mpf("1e-36")
    rates = {n: Fraction(7 + 3 * k, 5) for k, n in enumerate(poses_of(name))}
    moving = solved(name, {n: (value, rates[n], 0) for n, (value, *_) in poses_of(name).items()}).effects
    ahead, behind = (
        solved(name, poses_of(name, **{n: sign * step * rate for n, rate in rates.items()}), 100).effects
        for sign in (1, -1)
    )
    names = set(OF_POSITIONS) - {"damper_length"}
    assert {f"{one}_by_time" for one in names} <= set(moving)
    for one in names:
        assert abs(moving[f"{one}_by_time"] - (ahead[one] - behind[one]) / (2 * number(step))) < off, one


def test_what_a_car_lacks_is_said_by_name() -> None:
    plain = on_an_arm(
        (600, 400, 300), (600, 500, 300), roles={"wheel_axis": ROLES["wheel_axis"]}, wheel_radius=None
    )
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    of_the_axis = {"camber", "toe", "camber_by_arcsine", "toe_by_arcsine", "steer_angle", "travel"}
    along = {f"{name}_{way}" for name in of_the_axis for way in ("by_travel", "by_time")}
    assert set(found.effects) == of_the_axis | along
    assert found.left_out["caster"] == "needs the role steering_axis"
    assert found.left_out["contact_travel"] == "needs a wheel_radius, mm"
    assert found.left_out["scrub_radius"] == "needs the role steering_axis and a wheel_radius, mm"
    assert found.left_out["damper_length"] == "needs the role damper"
    assert "role knuckle" in found.left_out["roll_centre_height"]
    words = "needs exactly one driven input that is the travel of a slide or steers one"
    assert found.left_out["toe_by_rack"] == words


def test_two_inputs_that_move_the_wheel_leave_no_gradient_by_its_travel() -> None:
    car = CARS["double wishbone"]
    rods = {"gap": {"distance": ["tie_rod_outer", "upper_arm_front"]}}
    plain = plain_mechanism(car.suspension, car.points, ["arm_angle"], wheel_radius=car.wheel_radius)
    plain = {**plain, "inputs": {**plain["inputs"], **rods}}
    found = closed_drawing(Design.from_plain(plain), effects=EVERY).instant
    assert {one for one in found.effects if one.endswith(("_by_travel", "_by_rack"))} == set()
    words = "exactly one driven input that is not the travel of a slide"
    assert words in found.left_out["camber_by_travel"]
    assert words in found.left_out["roll_centre_height"]


@pytest.mark.parametrize("radius", [0, -260, float("nan")])
def test_a_wheel_without_size_is_refused(radius: float) -> None:
    plain = {**five_link(), "wheel_radius": radius}
    with pytest.raises(BadInputError, match="wheel_radius"):
        solve_reference(plain, {"wheel_travel": (0, 0, 0)}, effects=EVERY)
