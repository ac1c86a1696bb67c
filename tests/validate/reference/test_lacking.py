"""A car has the numbers that it lacks nothing for, and no others."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from mechanism_drawings import described
from plain_mechanisms import plain_mechanism
from reference_cars import CARS

from validate.reference import Design, Instant, instants_of
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
    return solved(on_an_arm(**others), {"swing": (0, 0, 0)})


def solved(plain: dict[str, Any], inputs: dict[str, Any]) -> Instant:
    return next(instants_of(Design.from_plain(plain), [inputs], effects=EFFECTS))


def test_of_a_spin_axis_alone_there_is_what_is_made_of_it() -> None:
    found = drawn(roles={"wheel_axis": ROLES["wheel_axis"]}, wheel_radius=None)
    of_the_axis = {"camber", "toe", "camber_by_arcsine", "toe_by_arcsine", "steer_angle"}
    of_the_axis |= {"toe_change_by_arcsine", "travel"}
    along = {f"{name}_{way}" for name in of_the_axis for way in ("by_travel", "by_time")}
    assert set(found.effects) == of_the_axis | along


def test_two_inputs_that_move_the_wheel_leave_no_gradient_by_its_travel() -> None:
    car = CARS["double wishbone"]
    rods = {"gap": {"distance": ["tie_rod_outer", "upper_arm_front"]}}
    plain = plain_mechanism(car.suspension, car.points, ["arm_angle"], wheel_radius=car.wheel_radius)
    plain = {**plain, "inputs": {**plain["inputs"], **rods}}
    inputs = {"arm_angle": (Fraction(3, 2), 0, 0), "gap": (400, 0, 0)}
    found = solved(plain, inputs)
    assert {one for one in found.effects if one.endswith(("_by_travel", "_by_rack"))} == set()
    assert "roll_centre_height" not in found.effects
