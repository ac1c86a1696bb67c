"""Instant centres and anti-features, held to where hinges pierce planes and the lines of arms meet."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import pytest
from exact_vectors import number, unit
from mechanism_drawings import described
from mpmath import mpf

from validate.reference import BadInputError, Design, closed_drawing, solve_reference
from validate.reference.vectors import Vector, minus, plus, times

WITHIN = mpf("1e-55")
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
LEANING = {"inner": (992, 652, 325), "centre": (1000, 700, 300)}


def on_an_arm(hinge: tuple[Vector, Vector], wheel: Mapping[str, Vector], **others: Any) -> dict[str, Any]:
    """A right wheel of radius 300 on an arm; x rearward, y right, z up."""
    return described(
        {"pivot": hinge[0], "end": hinge[1], **wheel},
        {"chassis": ["pivot", "end"], "arm": ["pivot", "end", "inner", "centre"]},
        {
            "swing": {"angle": "arm", "from": "drawing"},
            "roll": {"turns": "chassis", "about": "pivot", "along": "forward"},
            "pitch": {"turns": "chassis", "about": "end", "along": "right"},
            "heave": {"moves": "chassis", "along": "up"},
        },
        **{
            "roles": {"knuckle": "arm", "wheel_axis": ["inner", "centre"]},
            "side": "right",
            "wheel_radius": 300,
            "car": CAR,
            **others,
        },
    )


def pierced(start: Vector, end: Vector, axis: int, value: mpf) -> Vector:
    """The point of a line with a coordinate of this value."""
    along = minus(end, start)
    return plus(start, times(along, (value - start[axis]) / along[axis]))


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("axle", ["front", "rear"])
@pytest.mark.parametrize("hinge", [((600, 400, 300), (800, 150, 340)), ((1100, 200, 400), (300, 260, 380))])
def test_the_centres_of_an_arm_are_where_its_hinge_pierces_the_planes_of_the_views(
    hinge: tuple[Vector, Vector], axle: str, side: str
) -> None:
    out, s = (1, -1)[side == "left"], (1, -1)[axle == "front"]
    plain = on_an_arm(hinge, LEANING, side=side, car={**CAR, "axle": axle})
    points = {name: (x, out * y, z) for name, (x, y, z) in plain["points"].items()}
    inputs = {"swing": mpf("0.1"), "roll": mpf("0.05"), "pitch": mpf("-0.03"), "heave": 20}
    still = {name: (value, 0, 0) for name, value in inputs.items()}
    instant = solve_reference({**plain, "points": points}, still, effects=NAMES)
    found, place = instant.effects, instant.position
    centre, spin = place["centre"], unit(minus(place["centre"], place["inner"]))
    contact = minus(centre, times(unit(minus((0, 0, 1), times(spin, spin[2]))), 300))

    def seen(axis: int, point: Vector) -> Vector:
        return minus(pierced(place["pivot"], place["end"], axis, point[axis]), point)

    front, side_view, of_wheel = seen(0, contact), seen(1, contact), seen(1, centre)
    assert abs(found["front_view_swing_arm"] + out * front[1]) < WITHIN
    assert abs(found["front_view_centre_height"] - front[2]) < WITHIN
    assert abs(found["side_view_swing_arm"] - side_view[0]) < WITHIN
    assert abs(found["side_view_centre_height"] - side_view[2]) < WITHIN
    # What is at a point moves at right angles to its line to the centre.
    lever = 2600 / (520 - found["contact_travel"])
    assert abs(found["contact_travel"]) > 10
    for name, share, line in (("anti_brake", 3 / mpf(8), side_view), ("anti_drive", 1 / mpf(4), of_wheel)):
        assert abs(found[name] + 100 * share * s * line[2] / line[0] * lever) < WITHIN, name


def test_a_trailing_arm_turns_about_its_pivot_in_the_side_view_and_has_no_centre_in_the_front_view() -> None:
    plain = on_an_arm(((600, 400, 350), (600, 500, 350)), UPRIGHT)
    found = closed_drawing(Design.from_plain(plain), effects=NAMES).instant
    # 400 ahead of the wheel, 350 above the ground and 50 above the wheel centre.
    by_hand = {
        "side_view_swing_arm": -400,
        "side_view_centre_height": 350,
        "anti_brake": 100 * Fraction(3, 8) * Fraction(350, 400) * 5,
        "anti_drive": 100 * Fraction(1, 4) * Fraction(50, 400) * 5,
    }
    for name, value in by_hand.items():
        assert abs(found.effects[name] - number(value)) < WITHIN, name
    for name in FRONT_VIEW:
        assert "at infinity" in found.left_out[name]


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
