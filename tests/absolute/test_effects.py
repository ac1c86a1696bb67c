"""Numbers of wheel, steering axis and damper, and their gradients: in many digits and by hand."""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from one_arm import CAR, DRAWN, RADIUS, RATES, ROLES, plain, solved, written
from shipped import EPS, Motion, shipped

import absolute
from absolute.dual import arctan2, constant

# The carriage does not turn the arm, which has no screw axis by it.
EFFECTS = tuple(name for name in absolute.EFFECTS if not name.startswith("screw_"))
LENGTHS = ("wheelbase", "centre_of_gravity_height", "spring_free_length")
POSES: tuple[dict[str, float], ...] = (
    {},
    {"turn": 0.2, "steer": 15.0},
    {"turn": -0.3, "steer": -20.0, "roll": 0.1, "pitch": -0.05},
)
# Every line of the arm is more than 100 mm long, and its condition number below 40: points are off by 40
# roundings of 800 mm, numbers by ten times that, as contact points and axes reach 310 mm beyond such lines,
# and angles and gradients by a hundredth of it, as they change by no more over 100 mm. Of an anti-feature it
# is 500 times that. The hinge leans a tenth out of the plane of the front view, which has the instant centre
# ten times as far away as the hinge, and 50 times as far off; in the side view it is nearer.
OFF = 10 * 40 * EPS * 800.0


def tolerance(name: str) -> float:
    if "_view_" in name:
        return 50.0 * OFF
    # A spring gives 27.5 N for each mm.
    # The inputs turn the arm and the car by about a radian a second: errors of rates are those of places.
    units = {"mm": OFF, "mm/s": 2.0 * OFF, "%": 5.0 * OFF, "N": 27.5 * OFF, "N/mm": 27.5 * OFF / 100.0}
    return units.get(absolute.EFFECTS[name].unit, OFF / 100.0)


def assert_close(found: dict[str, float], wanted: dict[str, float], times: float = 1.0) -> None:
    for name, value in wanted.items():
        assert abs(found[name] - value) <= times * tolerance(name), name


@pytest.mark.parametrize("values", POSES)
def test_every_effect_is_what_is_written_out_in_many_digits(values: dict[str, float]) -> None:
    assert_close(solved(EFFECTS, values), {name: written(name, values) for name in EFFECTS})


@pytest.mark.parametrize("values", POSES)
def test_a_mirrored_scaled_moved_or_turned_car_has_the_same_numbers(values: dict[str, float]) -> None:
    here = solved(EFFECTS, values)
    # The mirror image turns the other way about lines that it keeps, and the same way about those across.
    other = {**values, "turn": -values.get("turn", 0.0), "roll": -values.get("roll", 0.0)}
    points = {name: (x, -y, z) for name, (x, y, z) in DRAWN.items()}
    # To the left on either side: a wheel turned in goes the other way.
    signs = {name: -1.0 if name.startswith("steer_angle") else 1.0 for name in EFFECTS}
    rates = {**RATES, "turn": -RATES["turn"], "roll": -RATES["roll"]}
    mirrored = solved(EFFECTS, other, points, rates, side="right")
    assert_close({name: signs[name] * value for name, value in mirrored.items()}, here, 2)
    for scale in (1e-3, 1e3):
        points = {name: np.multiply(scale, point) for name, point in DRAWN.items()}
        scaled = solved(
            EFFECTS,
            {**values, "steer": scale * values.get("steer", 0.0)},
            points,
            {**RATES, "steer": scale * RATES["steer"]},
            wheel_radius=scale * RADIUS,
            car=CAR | {name: scale * CAR[name] for name in LENGTHS},
        )
        by = {"mm": scale, "mm/s": scale, "N": scale, "rad/mm": 1.0 / scale}
        units = {name: by.get(absolute.EFFECTS[name].unit, 1.0) for name in here}
        assert_close({name: value / units[name] for name, value in scaled.items()}, here, 2)
    # The roll centre's plane goes through the origin, so it may not move sideways. Places are rounded anew.
    others = tuple(name for name in EFFECTS if not name.endswith("roll_centre_height"))
    for shift, names in (((500.0, 0.0, -300.0), EFFECTS), ((100.0, 700.0, 50.0), others)):
        moved = solved(names, values, {name: np.add(point, shift) for name, point in DRAWN.items()})
        assert_close(moved, {name: here[name] for name in names}, 4)
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = {name: turn @ point for name, point in DRAWN.items()}
    assert_close(solved(EFFECTS, values, points, up=turn[:, 2], right=turn[:, 1]), here, 4)


def test_a_displaced_chassis_changes_no_number() -> None:
    inputs = {name: np.array([[value, RATES[name], 0.0]]) for name, value in POSES[2].items()}
    still, displaced = (
        Motion(plain(), inputs, chassis).solve(effects=EFFECTS)
        for chassis in (None, np.full((1, 3, 3), 40.0))
    )
    assert all(np.array_equal(still.effects[name], displaced.effects[name]) for name in EFFECTS)


# A wheel of 300 mm upright, one turned in by the angle of 3-4-5, and one leant out by it, whose lowest point
# is 180 mm further inboard and 60 mm higher. The axis is 10 mm inboard and 20 mm ahead of that point at its
# height, and 25 mm inboard and 10 mm behind the centre at the height of that.
UPRIGHT = {
    **DRAWN,
    "inner": (0.0, -600.0, 300.0),
    "centre": (0.0, -700.0, 300.0),
    "lower": (-10.0, -685.0, 100.0),
    "upper": (20.0, -670.0, 400.0),
}
BY_HAND = {
    "kingpin_offset": 10.0,
    "castor_offset": 20.0,
    "mechanical_trail": 20.0,
    "scrub_radius": np.sqrt(500.0),
    "kingpin_offset_at_wheel": 25.0,
    "hub_trail": 10.0,
}


@pytest.mark.parametrize(
    ("moved", "changed"),
    [
        ({}, {"camber": 0.0, "toe": 0.0, "kingpin": np.arctan(15 / 300), "caster": np.arctan(0.1)}),
        # Its own forward leads 0.6 inboard and 0.8 ahead.
        ({"inner": (60.0, -620.0, 300.0)}, {"mechanical_trail": 22.0, "toe": np.arctan(0.75)}),
        (
            {
                "inner": (0.0, -620.0, 360.0),
                "lower": (-20.0, -510.0, 60.0),
                "upper": (60.0, -1180.0, 620.0),
            },
            {
                "camber": np.arctan(0.75),
                # 3/7 of the way up the axis, 240 mm above its lower end.
                "kingpin_offset_at_wheel": 700.0 - 510.0 - 670.0 * 3 / 7,
                "hub_trail": -20.0 + 80.0 * 3 / 7,
            },
        ),
        # Further than a right angle.
        ({"inner": (60.0, -620.0, 300.0), "centre": (0.0, -540.0, 300.0)}, {"toe": np.arctan2(60.0, -80.0)}),
        (
            {"inner": (0.0, -620.0, 360.0), "centre": (0.0, -540.0, 300.0)},
            {"camber": np.arctan2(60.0, -80.0)},
        ),
    ],
)
def test_a_wheel_drawn_by_hand_has_the_offsets_that_it_is_drawn_with(
    moved: dict[str, Any], changed: dict[str, float]
) -> None:
    wanted = changed if "centre" in moved else BY_HAND | changed
    for out, side in ((1, "left"), (-1, "right")):
        points = {name: (x, out * y, z) for name, (x, y, z) in (UPRIGHT | moved).items()}
        assert_close(solved(wanted, {}, points, side=side, wheel_radius=300.0), wanted)


# A trailing link of 400 mm, hinged ahead of the wheel, with a damper straight above the middle of the link.
LINK = {
    **UPRIGHT,
    "pivot": (-400.0, -700.0, 300.0),
    "pivot_end": (-400.0, -500.0, 300.0),
    "damper_foot": (-200.0, -700.0, 300.0),
    "damper_top": (-200.0, -700.0, 600.0),
}


@pytest.mark.parametrize("angle", [-0.3, 0.0, 0.2])
def test_a_trailing_link_lifts_its_wheel_along_a_circle(angle: float) -> None:
    # About the line to the right the wheel behind goes down: up by minus the turn.
    sine, cosine, tangent = np.sin(angle), np.cos(angle), np.tan(angle)
    foot = 200.0 * np.array([cosine - 1.0, sine]) - [0.0, 300.0]
    damper = float(np.hypot(*foot))
    wanted = {
        "travel": 400.0 * sine,
        "contact_travel": 400.0 * sine,
        "recession": 400.0 * (cosine - 1.0),
        "half_track_change": 0.0,
        "damper_length": damper,
        "travel_by_travel": 1.0,
        "recession_by_travel": -tangent,
        "half_track_change_by_travel": 0.0,
        # The axis is turned forward at its top.
        "caster": np.arctan(0.1) - angle,
        "caster_by_travel": -1.0 / (400.0 * cosine),
        "camber_by_travel": 0.0,
        "toe_by_travel": 0.0,
        "damper_length_by_travel": (foot @ np.array([-sine, cosine])) / damper / 2.0 / cosine,
        "roll_centre_height": 0.0,
    }
    assert_close(solved(wanted, {"turn": -angle}, LINK), wanted)


@pytest.mark.parametrize(
    ("way", "wanted"),
    [
        ((0.0, -1.0, 0.0), {"half_track_change": 1.0, "recession": 0.0, "travel": 0.0}),
        ((1.0, 0.0, 0.0), {"half_track_change": 0.0, "recession": 1.0, "travel": 0.0}),
        ((0.0, 0.0, 1.0), {"half_track_change": 0.0, "recession": 0.0, "travel": 1.0}),
    ],
)
def test_a_wheel_pushed_along_a_direction_goes_that_way(
    way: tuple[float, ...], wanted: dict[str, float]
) -> None:
    points = {**LINK, "guide_end": np.add(DRAWN["guide"], np.multiply(80.0, way))}
    names = [*wanted, *(f"{name}_by_rack" for name in wanted), "damper_length_by_rack"]
    found = solved(names, {"steer": 12.0}, points)
    assert_close(found, {name: 12.0 * slope for name, slope in wanted.items()})
    assert_close(found, {f"{name}_by_rack": slope for name, slope in wanted.items()})
    if way[2]:
        assert_close(found, {"damper_length_by_rack": -1.0})


@pytest.mark.parametrize("inward", [True, False])
def test_a_rack_that_moves_the_steering_arm_to_the_middle_turns_the_wheel_in(inward: bool) -> None:
    """The tie rod of the printed car lies in front of the wheel's centre. A steering axis laid back leans a
    wheel in that is turned in, as every car with caster does with its outer wheel in a bend."""
    motion = shipped("double-wishbone", 2)
    outboard = np.sign(motion.plain["points"]["wheel_centre"][1])
    drawn = absolute.close_drawing(absolute.compile(motion.plain)).inputs
    inputs = {name: np.array([[value, 0.0, 0.0]] * 2) for name, value in drawn.items()}
    # A positive rack moves against right.
    inputs["rack"][1, 0] += (10.0 if inward else -10.0) * outboard
    effects = Motion(motion.plain, inputs).solve(effects=["toe", "camber", "caster"]).effects
    turned, leant = np.diff(effects["toe"])[0], np.diff(effects["camber"])[0]
    assert abs(turned) > 0.05
    assert (turned > 0) == inward
    assert effects["caster"][0] > 0.0
    # A small turn d about a steering axis: toe d cos c, camber -d sin c; the rest is of second order.
    assert np.isclose(leant / turned, -np.tan(effects["caster"][0]), atol=abs(turned))


@pytest.mark.parametrize("length", [60.0, 1e-3])
def test_a_spin_axis_short_or_far_from_the_origin_keeps_its_digits(length: float) -> None:
    # Its ends are places hundreds of mm away, whose difference would have lost that many digits.
    scene = plain_scene("double-wishbone", ["arm_angle", "rack"])
    centre = np.array(scene["points"]["wheel_centre"])
    points = scene["points"] | {"wheel_axis_inner": centre - np.array([0.125, 1.0, 0.25]) * length}
    angle = absolute.close_drawing(absolute.compile(scene)).inputs["arm_angle"]
    inputs = {"arm_angle": np.array([[angle, 0.0, 0.0]]), "rack": np.zeros((1, 3))}
    for far in (0.0, 2.0**30):
        drawn = {name: np.round(np.array(p) * 2.0**22) / 2.0**22 + far for name, p in points.items()}
        spin = drawn["wheel_centre"] - drawn["wheel_axis_inner"]
        found = Motion(scene | {"points": drawn, "side": "right"}, inputs).solve(effects=["camber"]).effects
        if far and length < 1.0:
            continue
        assert abs(found["camber"][0] - np.arctan2(-spin[2], spin[1])) < 1e-12


def test_gradients_of_a_long_motion_are_those_of_its_instants_in_any_order() -> None:
    # Instants are solved many at a time.
    motion = shipped("bounce-and-steer", 81)
    back = Motion(motion.plain, {name: law[::-1].copy() for name, law in motion.inputs.items()})
    there, again = (
        one.solve(rates=False, effects=["toe_by_rack", "caster_by_travel"]).effects for one in (motion, back)
    )
    assert np.ptp(there["caster_by_travel"]) > 1e-6
    assert all(np.abs(there[name] - again[name][::-1]).max() <= 1e-13 for name in there)


def test_half_a_turn_is_pi_with_either_zero() -> None:
    assert arctan2(constant(-0.0), constant(-1.0)).value == np.pi


def test_an_input_of_two_slides_moves_both() -> None:
    # A damper whose top stands on a sledge that goes with the carriage is as long as before.
    apart = np.add(DRAWN["damper_top"], np.subtract(DRAWN["guide_end"], DRAWN["guide"]))
    described = plain({**DRAWN, "sledge": DRAWN["damper_top"], "beside": apart}, turns=())
    described["bodies"]["chassis"] = ["stop", "sledge", "beside"]
    slide = {
        "points": ["damper_top"],
        "body": "chassis",
        "through": "sledge",
        "along": "beside",
        "turns": True,
    }
    described["slides"]["top"] = slide
    described["inputs"]["steer"] = {"travel": ["guide", "top"]}
    names = ["half_track_change_by_rack", "damper_length_by_rack", "damper_length_by_travel"]
    inputs = {"turn": np.array([[0.1, 0.0, 0.0]]), "steer": np.array([[8.0, 0.0, 0.0]])}
    found = Motion(described, inputs).solve(effects=names).effects
    assert abs(found["damper_length_by_rack"][0]) <= tolerance("damper_length_by_rack")
    assert found["half_track_change_by_rack"][0] > 0.9
    assert found["damper_length_by_travel"][0] < -0.1


def test_a_wheel_that_does_not_rise_has_no_gradient_by_travel_and_no_roll_centre() -> None:
    # The wheel stands on the carriage, and what turns is a flap of the chassis that holds the damper's foot.
    described = plain(turns=())
    described["bodies"] = {
        "chassis": ["stop", "damper_top", "pivot", "pivot_end"],
        "carriage": ["guide", "guide_end", "inner", "centre", "lower", "upper"],
        "flap": ["pivot", "pivot_end", "damper_foot"],
    }
    described["inputs"]["turn"] = {"angle": "flap", "from": "drawing"}
    inputs = {"turn": np.zeros((1, 3)), "steer": np.array([[12.0, 0.0, 0.0]])}
    names = ["damper_length_by_travel", "travel_by_travel", "toe_by_travel", "roll_centre_height"]
    found = Motion(described, inputs).solve(effects=[*names, "recession_by_rack"]).effects
    assert all(np.isnan(found[name][0]) for name in names), found
    assert found["recession_by_rack"][0] > 0.1


@pytest.mark.parametrize(
    ("names", "roles", "radius", "words"),
    [
        (
            ["toe", "damper_length"],
            ("wheel_axis",),
            None,
            "'damper_length' needs the role 'damper'.*two points",
        ),
        (["hub_trail"], ("wheel_axis",), None, "'hub_trail' needs the role 'steering_axis'"),
        (
            ["damper_length_by_travel"],
            ("damper",),
            300.0,
            "'damper_length_by_travel' needs the role 'wheel_axis'",
        ),
        (["travel", "recession"], ("wheel_axis",), None, "'recession' needs wheel_radius.*mechanism.*mm"),
    ],
)
def test_what_a_number_lacks_is_said_in_one_line(
    names: list[str], roles: tuple[str, ...], radius: float | None, words: str
) -> None:
    kept = {role: ROLES[role] for role in roles}
    with pytest.raises(absolute.DescriptionError, match=f"^effect {words}") as refused:
        solved(names, roles=kept, wheel_radius=radius)
    assert "\n" not in str(refused.value)
    others = ["travel", "hub_trail", "damper_length_by_travel", "toe"]
    assert solved(others, wheel_radius=None) == solved(others)


def test_an_effect_that_is_not_known_is_refused_with_those_there_are() -> None:
    with pytest.raises(absolute.InputError, match=r"no effect 'lean'.*'camber', 'camber_by") as caught:
        solved(["camber", "lean"])
    assert caught.value.name == "lean"


def test_a_gradient_without_exactly_one_input_of_its_kind_is_refused() -> None:
    scene = plain_scene("five-link")
    turn = {name: np.zeros((1, 3)) for name in scene["inputs"]}
    assert Motion(scene, turn).solve(effects=["toe_by_travel"]).effects
    words = r"^effect 'toe_by_rack' needs exactly one driven input that is the travel.* are 0: \[\] of"
    with pytest.raises(absolute.DescriptionError, match=words):
        Motion(scene, turn).solve(effects=["toe_by_rack"])
    loose = plain_scene("bounce", ["arm_angle", "rack"])
    loose["inputs"]["rack"] = {"height": "tie_rod_inner", "along": "left"}
    for name in ("travel_by_travel", "roll_centre_height"):
        words = f"^effect '{name}' needs.* is not .* are 2: .*arm_angle"
        with pytest.raises(absolute.DescriptionError, match=words):
            Motion(loose | {"wheel_radius": 300.0}, {n: np.zeros((1, 3)) for n in loose["inputs"]}).solve(
                effects=[name]
            )
