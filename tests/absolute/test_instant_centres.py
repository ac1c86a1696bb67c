"""Instant centres at infinity or known by hand, anti-features, and what these ask of the car."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from mechanism_files import plain_scene
from numpy.typing import NDArray
from one_arm import DRAWN, plain, solved
from shipped import EPS, off

import absolute

Array = NDArray[np.float64]
both_sides = pytest.mark.parametrize(("side", "out"), [("left", -1), ("right", 1)])

CAR = {
    "axle": "rear",
    "wheelbase": 2700.0,
    "centre_of_gravity_height": 500.0,
    "brake_share": 0.4,
    "drive_share": 0.9,
}
CENTRES = ("swing_arm", "centre_height")
ANTI = ("anti_brake", "anti_drive")
both_views = pytest.mark.parametrize("view", ["front_view", "side_view"])


def planar(view: str, side: str, upper_inner: float = 370.0, **car: Any) -> absolute.Model:
    """A double wishbone that moves in the plane of a view, its wheel 300 mm above the ground.

    Arms lead from the wheel inboard, or ahead in the side view. As drawn the lower one is level, 150 mm high,
    and the upper one falls from 400 mm; the tie rod is as the lower arm. Hinges lie across the plane.
    """
    out = -1.0 if side == "left" else 1.0

    def place(inner: float, across: float, height: float) -> tuple[float, float, float]:
        if view == "front_view":
            return (across, out * (760.0 - inner), height)
        return (-inner, out * 760.0 + across, height)

    points = {
        "lower_arm_front": place(460.0, -100.0, 150.0),
        "lower_arm_rear": place(460.0, 100.0, 150.0),
        "lower_ball_joint": place(60.0, 0.0, 150.0),
        "upper_arm_front": place(410.0, -90.0, upper_inner),
        "upper_arm_rear": place(410.0, 80.0, upper_inner),
        "upper_ball_joint": place(110.0, 10.0, 400.0),
        "tie_rod_inner": place(460.0, 120.0, 150.0),
        "tie_rod_outer": place(60.0, 120.0, 150.0),
        "wheel_axis_inner": (0.0, out * 660.0, 300.0),
        "wheel_centre": (0.0, out * 760.0, 300.0),
    }
    described = plain_scene("wheel-travel") | {"side": side, "wheel_radius": 300.0, "car": CAR | car}
    own = {name: np.array(place, dtype=float) for name, place in described["points"].items()}
    described["points"] = {name: points.get(name, own[name] * [1.0, out, 1.0]) for name in own}
    described["points"]["rack_centre"] = points["tie_rod_inner"]
    return absolute.compile(described)


def moved(model: absolute.Model, names: Sequence[str], travels: Sequence[float]) -> absolute.Solution:
    inputs = {name: np.zeros((len(travels), 3)) for name in ("wheel_travel", "rack")}
    inputs["wheel_travel"][:, 0] = travels
    return absolute.solve(model, inputs, conditions=True, effects=names)


def allowed_at(motion: absolute.Solution, far: float) -> float:
    """How far off the meeting of two lines is that are fixed by points 250 mm apart, so many mm away."""
    return 2.0 * (1.0 + far / 250.0) ** 2 * float(off(motion).max())


@both_sides
def test_a_brake_whose_force_points_at_the_centre_of_gravity_is_full(side: str, out: int) -> None:
    # All braking is at the rear, and the line from the contact point to the instant centre is as high as the
    # centre of gravity where it has gone a wheelbase.
    model = planar("side_view", side, centre_of_gravity_height=2700.0 * 150.0 / 2610.0, brake_share=1)
    motion = moved(model, ["anti_brake"], [0.0])
    assert abs(motion.effects["anti_brake"][0] - 100.0) < 1e-9


@both_views
@both_sides
def test_a_centre_at_infinity_is_no_number(view: str, side: str, out: int) -> None:
    # A wheel that moves in the plane of one view does not turn in the other; parallel arms turn it in none.
    across = "side_view" if view == "front_view" else "front_view"
    names = [f"{view}_{centre}" for centre in CENTRES]
    others = [f"{across}_{centre}" for centre in CENTRES]
    travels = [0.0, -40.0, 35.0]
    found = moved(planar(view, side), [*names, *others, *ANTI], travels).effects
    assert all(np.isnan(found[name]).all() for name in others)
    assert all(np.isfinite(found[name]).all() for name in (*names, *ANTI))
    parallel = moved(planar(view, side, 400.0), names, [0.0]).effects
    assert all(np.isnan(parallel[name]).all() for name in names)
    # 0.3 um in 300 mm is seen.
    near = moved(planar(view, side, 400.0 - 3e-4), names, [0.0])
    far = 60.0 + 50.0 + 250.0 / 1e-6
    height = near.effects[f"{view}_centre_height"]
    assert abs(abs(near.effects[f"{view}_swing_arm"][0]) - far) <= allowed_at(near, far)
    assert abs(height[0] - 150.0) <= allowed_at(near, far)


def test_a_hinge_through_the_contact_point_has_no_centre_across_it() -> None:
    # The wheel leans out by the angle of 3-4-5, so that it rises although its lowest point stands still.
    drawn = DRAWN | {
        "inner": (0.0, -620.0, 360.0),
        "centre": (0.0, -700.0, 300.0),
        "pivot": (-50.0, -520.0, 60.0),
        "pivot_end": (50.0, -520.0, 60.0),
    }
    # In a frame that is turned somehow, what is zero is rounded.
    turn = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = {name: turn @ point for name, point in drawn.items()}
    front, side = ([f"{view}_{centre}" for centre in CENTRES] for view in ("front_view", "side_view"))
    found = solved([*front, *side], {}, points, up=turn[:, 2], right=turn[:, 1], wheel_radius=300.0)
    assert all(abs(found[name]) < 10 * 40 * 800 * EPS for name in front)
    assert all(np.isnan(found[name]) for name in side)


@pytest.mark.parametrize("angle", [-0.3, 0.0, 0.2])
def test_a_trailing_arm_turns_its_wheel_about_its_pivot(angle: float) -> None:
    # The pivot is 400 mm ahead of the wheel centre and as high, 310 mm above the contact point.
    points = DRAWN | {
        "inner": (0.0, -600.0, 310.0),
        "centre": (0.0, -700.0, 310.0),
        "pivot": (-400.0, -700.0, 310.0),
        "pivot_end": (-400.0, -500.0, 310.0),
    }
    names = [f"{view}_{centre}" for view in ("front_view", "side_view") for centre in CENTRES]
    found = solved([*names, *ANTI], {"turn": -angle}, points, car=CAR)
    ahead, rise = 400.0 * np.cos(angle), 400.0 * np.sin(angle)
    wanted = {
        "side_view_swing_arm": -ahead,
        "side_view_centre_height": 310.0 - rise,
        "anti_brake": 40.0 * (310.0 - rise) / ahead * 2700.0 / (500.0 - rise),
        "anti_drive": 90.0 * -rise / ahead * 2700.0 / (500.0 - rise),
    }
    for name, number in wanted.items():
        # A condition number below 40 and lengths of 800 mm; 500 times slopes over 400 mm.
        assert abs(found[name] - number) < 10 * 40 * 800 * EPS * 5, name
    assert np.isnan([found[name] for name in names[:2]]).all()


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
            list(CAR),
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
