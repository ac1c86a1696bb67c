"""What a car lacks for its numbers is said by name, and so is what cannot be."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest
from mechanism_drawings import described
from plain_mechanisms import plain_mechanism
from reference_cars import CARS

from validate.reference import BadInputError, Design, Instant, closed_drawing
from validate.reference.effects.registry import EFFECTS

WHEEL = {
    "wheel_axis_inner": (964, 652, 275),
    "wheel_centre": (1000, 700, 300),
    "lower": (1015, 705, 180),
    "upper": (1045, 645, 420),
    "damper_low": (1014, 421, 558),
}
DAMPER_TOP = (1000, 400, 600)
ROLES = {
    "knuckle": "arm",
    "wheel_axis": ["wheel_axis_inner", "wheel_centre"],
    "steering_axis": ["lower", "upper"],
    "damper": ["damper_top", "damper_low"],
}
CAR = {
    "axle": "rear",
    "wheelbase": 2600,
    "centre_of_gravity_height": 520,
    "brake_share": Fraction(3, 8),
    "drive_share": Fraction(1, 4),
}


def on_an_arm(**others: Any) -> dict[str, Any]:
    """A right wheel on an arm about a line across the car; x rearward, y right, z up."""
    hinge = {"pivot": (600, 400, 350), "end": (600, 500, 350)}
    return described(
        {**WHEEL, **hinge, "damper_top": DAMPER_TOP},
        {"chassis": [*hinge, "damper_top"], "arm": [*hinge, *WHEEL]},
        {"swing": {"angle": "arm", "from": "drawing"}},
        **{"roles": ROLES, "side": "right", "wheel_radius": 260, "car": CAR, **others},
    )


def drawn(**others: Any) -> Instant:
    return closed_drawing(Design.from_plain(on_an_arm(**others)), effects=EFFECTS).instant


def test_what_a_car_lacks_is_said_by_name() -> None:
    found = drawn(roles={"wheel_axis": ROLES["wheel_axis"]}, wheel_radius=None)
    of_the_axis = {"camber", "toe", "camber_by_arcsine", "toe_by_arcsine", "steer_angle"}
    of_the_axis |= {"toe_change_by_arcsine", "travel"}
    along = {f"{name}_{way}" for name in of_the_axis for way in ("by_travel", "by_time")}
    assert set(found.effects) == of_the_axis | along
    assert found.left_out["caster"] == "needs the role steering_axis"
    assert found.left_out["contact_travel"] == "needs a wheel_radius, mm"
    assert found.left_out["scrub_radius"] == "needs the role steering_axis and a wheel_radius, mm"
    assert found.left_out["damper_length"] == "needs the role damper"
    assert "role knuckle" in found.left_out["roll_centre_height"]
    assert found.left_out["track"] == "needs two parts on opposite sides of the car and a wheel_radius, mm"
    words = "needs exactly one driven input that is the travel of a slide or steers one"
    assert found.left_out["toe_by_rack"] == words


def test_two_inputs_that_move_the_wheel_leave_no_gradient_by_its_travel() -> None:
    car = CARS["double wishbone"]
    rods = {"gap": {"distance": ["tie_rod_outer", "upper_arm_front"]}}
    plain = plain_mechanism(car.suspension, car.points, ["arm_angle"], wheel_radius=car.wheel_radius)
    plain = {**plain, "inputs": {**plain["inputs"], **rods}}
    found = closed_drawing(Design.from_plain(plain), effects=EFFECTS).instant
    assert {one for one in found.effects if one.endswith(("_by_travel", "_by_rack"))} == set()
    words = "exactly one driven input that is not the travel of a slide"
    assert words in found.left_out["camber_by_travel"]
    assert words in found.left_out["roll_centre_height"]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"car": {"wheel_base": 2600}}, "car.wheel_base"),
        ({"car": {"axle": "middle"}}, "car.axle"),
        ({"car": {"wheelbase": 0}}, "car.wheelbase"),
        ({"car": {"centre_of_gravity_height": float("nan")}}, "car.centre_of_gravity_height"),
        ({"car": {"brake_share": 62.5}}, "car.brake_share"),
        ({"wheel_radius": -260}, "wheel_radius"),
        ({"sides": {"left": "port"}}, r"sides\['left'\] is 'port'"),
    ],
)
def test_what_cannot_be_is_refused_by_name(change: dict[str, Any], what: str) -> None:
    with pytest.raises(BadInputError, match=what):
        drawn(**change)
