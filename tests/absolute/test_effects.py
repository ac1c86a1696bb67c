"""Numbers of the car: digits far out, batches, and what they need.

What they are is in tests/mechanisms, for all mechanics.
"""

from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from one_arm import CAR, ROLES, plain
from shipped import Motion, shipped

import absolute
from absolute.dual import arctan2, constant


def solved(described: dict[str, Any], names: Any, **values: float) -> dict[str, float]:
    """Effects at values of the inputs, which are 0 where they are not given."""
    inputs = {name: np.array([[values.get(name, 0.0), 0.0, 0.0]]) for name in described["inputs"]}
    found = Motion(described, inputs).solve(rates=False, effects=names).effects
    return {name: float(number[0]) for name, number in found.items()}


def axle(**changed: Any) -> dict[str, Any]:
    """The shipped axle with its points on whole numbers."""
    described = plain_scene("axle-steer", wheel_radius=300.0, car={"wheelbase": 1600.0})
    points = {name: np.round(np.array(place)) for name, place in described["points"].items()}
    return described | {"points": points} | changed


@pytest.mark.parametrize("length", [60.0, 1e-3])
def test_a_spin_axis_short_or_far_from_the_origin_keeps_its_digits(length: float) -> None:
    # Its ends are places hundreds of mm away, whose difference would have lost that many digits.
    scene = plain_scene("double-wishbone", ["arm_angle", "rack"])
    centre = np.array(scene["points"]["wheel_centre"])
    points = scene["points"] | {"wheel_axis_inner": centre - np.array([0.125, 1.0, 0.25]) * length}
    angle = absolute.close_drawing(absolute.compile(scene)).inputs["arm_angle"]
    for far in (0.0, 2.0**30):
        drawn = {name: np.round(np.array(p) * 2.0**22) / 2.0**22 + far for name, p in points.items()}
        spin = drawn["wheel_centre"] - drawn["wheel_axis_inner"]
        if far and length < 1.0:
            continue
        found = solved(scene | {"points": drawn, "side": "right"}, ["camber"], arm_angle=angle)
        assert abs(found["camber"] - np.arctan2(-spin[2], spin[1])) < 1e-12


def test_what_both_wheels_make_costs_no_digit_far_from_the_origin() -> None:
    """Drawn 2^30 mm out to the right, where a place is rounded by 2^-23 mm; integers are not."""
    names = ["track", "axle_roll_centre_height", "ackermann"]
    values = {"left.wheel_travel": 15.0, "right.wheel_travel": -5.0, "rack": 40.0}
    near = axle()
    far = axle(points={name: np.add(place, (0.0, 2.0**30, 0.0)) for name, place in near["points"].items()})
    there = solved(far, names, **values)
    for name, number in solved(near, names, **values).items():
        assert abs(number - there[name]) < 1e-10, name


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


def test_names_are_those_of_the_parts_and_of_both_wheels_of_an_axle() -> None:
    parts = {f"{part}.{name}" for part in ("left", "right") for name in absolute.EFFECTS}
    assert set(absolute.effect_names(absolute.compile(axle()))) == parts | set(absolute.AXLE_EFFECTS)
    assert absolute.effect_names(absolute.compile(plain())) == tuple(absolute.EFFECTS)


LOOSE = plain_scene("bounce", ["arm_angle", "rack"], wheel_radius=300.0)
LOOSE["inputs"]["rack"] = {"height": "tie_rod_inner", "along": "left"}


def lacking(*names: str, **changed: Any) -> dict[str, Any]:
    """The arm without some numbers of the car."""
    return plain(car={name: value for name, value in CAR.items() if name not in names} or None, **changed)


@pytest.mark.parametrize(
    ("described", "names", "words"),
    [
        (
            plain(roles={"wheel_axis": ROLES["wheel_axis"]}),
            ["toe", "damper_length"],
            "effect 'damper_length' needs the role 'damper'.*two points",
        ),
        (plain(roles={}), ["hub_trail"], "effect 'hub_trail' needs the role 'steering_axis'"),
        (
            plain(roles={"damper": ROLES["damper"]}),
            ["damper_length_by_travel"],
            "effect 'damper_length_by_travel' needs the role 'wheel_axis'",
        ),
        (
            plain(wheel_radius=None),
            ["travel", "recession"],
            "effect 'recession' needs wheel_radius.*mechanism.*mm",
        ),
        (plain(), ["camber", "lean"], r"there is no effect 'lean'.*'camber', 'camber_by"),
        (axle(), ["camber"], r"there is no effect 'camber'.*'left.camber'"),
        (plain(), ["track"], r"effect 'track' needs .* exactly two parts.* has none"),
        (
            axle(sides={"left": "left", "right": "left"}),
            ["track"],
            r"effect 'track' needs .* on opposite sides.* 'right': 'left'",
        ),
        (axle(car={}), ["ackermann"], "effect 'ackermann' needs wheelbase"),
        (
            plain_scene("five-link"),
            ["toe_by_rack"],
            r"effect 'toe_by_rack' needs exactly one driven input that is the travel.* are 0: \[\] of",
        ),
        (LOOSE, ["travel_by_travel"], "effect 'travel_by_travel' needs.* is not .* are 2: .*arm_angle"),
        (LOOSE, ["roll_centre_height"], "effect 'roll_centre_height' needs.* is not .* are 2: .*arm_angle"),
        (
            lacking("brake_share"),
            ["anti_brake"],
            r"effect 'anti_brake' needs brake_share, and .* \[car\], for example, brake_share = 0.6, or",
        ),
        (
            lacking("axle", "drive_share"),
            ["anti_drive"],
            r'.* axle and drive_share,.* axle = "front", drive_share = 0.5',
        ),
        (
            lacking(*CAR),
            ["anti_brake"],
            ".* axle and wheelbase and centre_of_gravity_height and brake_share, and none",
        ),
    ],
)
def test_what_a_number_lacks_is_said_in_one_line(
    described: dict[str, Any], names: list[str], words: str
) -> None:
    with pytest.raises((absolute.DescriptionError, absolute.InputError), match=f"^{words}") as refused:
        solved(described, names)
    assert "\n" not in str(refused.value)
    assert refused.value.name


def test_a_number_by_roll_needs_a_roll_that_is_driven() -> None:
    """The arm can be turned about a line along the car; whoever gives no angle for it has no such input."""
    given = {name: np.zeros((1, 3)) for name in ("turn", "steer", "roll", "pitch")}
    assert Motion(plain(), given).solve(effects=["toe_by_roll"]).effects["toe_by_roll"].size == 1
    words = "needs exactly one driven input that rolls the chassis, and there are 0"
    with pytest.raises(absolute.DescriptionError, match=f"effect 'toe_by_roll' {words}"):
        Motion(plain(), {name: given[name] for name in ("turn", "steer")}).solve(effects=["toe_by_roll"])


def test_a_number_needs_nothing_of_the_others() -> None:
    for names, less in (
        (["travel", "hub_trail", "damper_length_by_travel", "toe"], plain(wheel_radius=None)),
        (["anti_brake"], lacking("drive_share")),
        (["anti_drive"], lacking("brake_share")),
    ):
        assert solved(less, names) == solved(plain(), names)


@pytest.mark.parametrize(
    ("car", "words"),
    [
        ({"wheel_base": 2700.0}, r"car has 'wheel_base'; it must be one of \['axle', 'wheelbase', "),
        ({"axle": "middle"}, r"axle is 'middle'; it must be one of \['front', 'rear'\]"),
        ({"wheelbase": 0}, "wheelbase is 0; a length above 0 is needed, in mm"),
        ({"wheelbase": True}, "wheelbase is True; a length"),
        ({"centre_of_gravity_height": np.nan}, "centre_of_gravity_height is nan; a length above 0"),
        ({"spring_rate": -1.0}, "spring_rate is -1.0; a rate above 0 is needed, in N/mm"),
        ({"brake_share": 60}, "brake_share is 60; a number from 0 to 1 is needed"),
        ({"drive_share": None}, "drive_share is None; a number from 0 to 1 is needed"),
        (2700.0, r"car is 2700.0; a table of \['axle', "),
    ],
)
def test_numbers_of_a_car_are_checked(car: Any, words: str) -> None:
    with pytest.raises(absolute.DescriptionError, match=f"^{words}") as refused:
        absolute.compile(plain(car=car))
    assert "\n" not in str(refused.value)
