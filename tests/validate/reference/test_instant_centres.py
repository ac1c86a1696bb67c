"""What instant centres and anti-features ask of the car. What they are is in tests/mechanisms."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest
from mechanism_drawings import described

from validate.reference import BadInputError, Design, closed_drawing
from validate.reference.vectors import Vector

FRONT_VIEW = ("front_view_swing_arm", "front_view_centre_height")
SIDE_VIEW = ("side_view_swing_arm", "side_view_centre_height")
ANTI = ("anti_brake", "anti_drive")
NAMES = (*FRONT_VIEW, *SIDE_VIEW, *ANTI, "contact_travel")

# The wheelbase is five times the height.
CAR = {
    "axle": "rear",
    "wheelbase": 2600,
    "centre_of_gravity_height": 520,
    "brake_share": Fraction(3, 8),
    "drive_share": Fraction(1, 4),
}
UPRIGHT = {"inner": (1000, 650, 300), "centre": (1000, 700, 300)}


def on_an_arm(hinge: tuple[Vector, Vector], wheel: Mapping[str, Vector], **others: Any) -> dict[str, Any]:
    """A right wheel of radius 300 on an arm; x rearward, y right, z up."""
    return described(
        {"pivot": hinge[0], "end": hinge[1], **wheel},
        {"chassis": ["pivot", "end"], "arm": ["pivot", "end", "inner", "centre"]},
        {"swing": {"angle": "arm", "from": "drawing"}},
        **{
            "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
            "side": "right",
            "wheel_radius": 300,
            "car": CAR,
            **others,
        },
    )


def test_each_missing_number_of_the_car_is_said_by_name() -> None:
    hinge = (600, 400, 350), (600, 500, 350)
    for key in CAR:
        plain = on_an_arm(hinge, UPRIGHT, car={name: one for name, one in CAR.items() if name != key})
        found = closed_drawing(Design.from_plain(plain), effects=NAMES).instant
        lacking = {"brake_share": {"anti_brake"}, "drive_share": {"anti_drive"}}.get(key, set(ANTI))
        assert set(ANTI) - set(found.effects) == lacking
        assert all(key in found.left_out[name] for name in lacking)
    plain = on_an_arm(hinge, UPRIGHT)
    del plain["car"]
    found = closed_drawing(Design.from_plain(plain), effects=NAMES).instant
    assert all(key in found.left_out["anti_drive"] for key in CAR if key != "brake_share")


@pytest.mark.parametrize(
    ("car", "what"),
    [
        ([2600], "car is"),
        ({"wheel_base": 2600}, "car.wheel_base"),
        ({"axle": "middle"}, "car.axle"),
        ({"wheelbase": 0}, "car.wheelbase"),
        ({"wheelbase": "2600"}, "car.wheelbase"),
        ({"centre_of_gravity_height": -1}, "car.centre_of_gravity_height"),
        ({"centre_of_gravity_height": float("nan")}, "car.centre_of_gravity_height"),
        ({"brake_share": 62.5}, "car.brake_share"),
        ({"drive_share": -0.1}, "car.drive_share"),
    ],
)
def test_a_number_of_the_car_that_cannot_be_is_refused_by_name(car: Any, what: str) -> None:
    with pytest.raises(BadInputError, match=what):
        Design.from_plain(on_an_arm(((600, 400, 350), (600, 500, 350)), UPRIGHT, car=car))
