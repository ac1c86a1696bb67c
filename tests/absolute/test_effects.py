"""Numbers of the car: digits far out, batches, where there is none, and what they need.

What they are is in tests/mechanisms, for all mechanics.
"""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from one_arm import CAR, DRAWN, ROLES, plain
from shipped import Motion, shipped

import absolute
from absolute.dual import arctan2, constant


def solved(names: Any, **changed: Any) -> dict[str, float]:
    """Effects of the arm as it is drawn."""
    described = plain(**changed)
    inputs = {name: np.zeros((1, 3)) for name in described["inputs"]}
    found = Motion(described, inputs).solve(rates=False, effects=names).effects
    return {name: float(number[0]) for name, number in found.items()}


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
    described["bodies"]["chassis"] = ["stop", "stop_end", "sledge", "beside"]
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
    assert abs(found["damper_length_by_rack"][0]) <= 1e-13
    assert found["half_track_change_by_rack"][0] > 0.9
    assert found["damper_length_by_travel"][0] < -0.1


def test_a_wheel_that_does_not_rise_has_no_gradient_by_travel_and_no_roll_centre() -> None:
    # The wheel stands on the carriage, and what turns is a flap of the chassis that holds the damper's foot.
    described = plain(turns=())
    described["bodies"] = {
        "chassis": ["stop", "stop_end", "damper_top", "pivot", "pivot_end"],
        "carriage": ["guide", "guide_end", "inner", "centre", "lower", "upper"],
        "flap": ["pivot", "pivot_end", "damper_foot"],
    }
    described["inputs"]["turn"] = {"angle": "flap", "from": "drawing"}
    described["roles"] = ROLES | {"knuckle": "carriage"}
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


@pytest.mark.parametrize(
    ("car", "words"),
    [
        ({"wheel_base": 2700.0}, r"car has 'wheel_base'; it must be one of \['axle', 'wheelbase', "),
        ({"axle": "middle"}, r"axle is 'middle'; it must be one of \['front', 'rear'\]"),
        ({"wheelbase": 0}, "wheelbase is 0; a length above 0 is needed, in mm"),
        ({"wheelbase": True}, "wheelbase is True; a length"),
        ({"centre_of_gravity_height": np.nan}, "centre_of_gravity_height is nan; a length above 0"),
        ({"brake_share": 60}, "brake_share is 60; a number from 0 to 1 is needed"),
        ({"drive_share": None}, "drive_share is None; a number from 0 to 1 is needed"),
        (2700.0, r"car is 2700.0; a table of \['axle', "),
    ],
)
def test_numbers_of_a_car_are_checked(car: Any, words: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=f"^{words}") as refused:
        absolute.compile(plain(car=car))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("name", "lacking", "words"),
    [
        ("anti_brake", ["brake_share"], r"brake_share, and .* \[car\], for example, brake_share = 0.6, or"),
        ("anti_drive", ["axle", "drive_share"], r'axle and drive_share,.* axle = "front", drive_share = 0.5'),
        (
            "anti_brake",
            ["axle", "wheelbase", "centre_of_gravity_height", "brake_share"],
            "axle and wheelbase and centre_of_gravity_height and brake_share, and none",
        ),
    ],
)
def test_what_an_anti_feature_lacks_of_the_car_is_said_in_one_line(
    name: str, lacking: list[str], words: str
) -> None:
    car = {given: value for given, value in CAR.items() if given not in lacking} or None
    with pytest.raises(absolute.DescriptionError, match=f"^effect '{name}' needs {words}") as refused:
        solved(["toe", name], car=car)
    assert "\n" not in str(refused.value)
    assert refused.value.name == lacking[0]


def test_an_anti_feature_needs_no_share_of_the_other() -> None:
    for name, other in (("anti_brake", "drive_share"), ("anti_drive", "brake_share")):
        car = {given: value for given, value in CAR.items() if given != other}
        assert solved([name], car=car) == solved([name], car=CAR)
