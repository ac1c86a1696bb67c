"""Every number of a wheel, by all three mechanics: in many digits, and where it is known by hand."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from effects_by_hand import numbers
from mpmath import atan, atan2, cos, mpf, sin, sqrt, tan, workdps
from one_arm import DRAWN, tables
from three_mechanics import DIGITS, assert_exact, assert_none, by_each, scene_of, solved_by

from pointcoord.effects.registry import EFFECTS, NUMBERS_OF_THE_CAR
from validate.formulations.protocol import Solution

# The carriage does not turn the arm, which has no screw axis by it.
WRITTEN = tuple(
    name
    for name, e in EFFECTS.items()
    if e.own_names and not getattr(e, "of_axle", False) and name != "screw_axis"
)
# Exact in binary.
LAWS = {
    "turn": [0.1875, -0.375],
    "steer": [-12.0, 40.0],
    "roll": [0.0625, -0.25],
    "pitch": [-0.125, 0.1875],
}


@cache
def written() -> dict[str, list[mpf]]:
    """Every number of the arm at its three instants."""
    instants = [numbers(LAWS, time) for time in (0.0, 0.5, 1.0)]
    names = {name for effect in WRITTEN for name in EFFECTS[effect].own_names}
    return {name: [one[name] for one in instants] for name in names}


@by_each
def test_every_effect_is_what_is_written_out_in_many_digits(who: str) -> None:
    # Instant centres are tens of metres away.
    assert_exact(solved_by(who, scene_of(tables(), WRITTEN, **LAWS)), written(), 1e-8)


def same_numbers(changed: Solution, plain: Solution) -> set[str]:
    """The names of the numbers that are the same within both claims."""
    same = set()
    for name, number in NUMBERS_OF_THE_CAR.items():
        quantity = number.quantity.name
        if name in plain.numbers.get(quantity, {}):
            found, wanted = (of.numbers[quantity][name] for of in (changed, plain))
            off, own = (of.accuracy.claims[quantity][name] for of in (changed, plain))
            if (np.abs(found - wanted) <= off + own).all():
                same.add(name)
    return same


@by_each
def test_a_heave_changes_no_number_and_another_middle_of_the_car_its_roll_centres_alone(who: str) -> None:
    plain = solved_by(who, scene_of(tables(), WRITTEN, **LAWS))
    every = {name for effect in WRITTEN for name in EFFECTS[effect].own_names}
    heaving = tables()
    heaving["inputs"] |= {"heave": {"moves": "chassis", "along": "up"}}
    moved = solved_by(who, scene_of(heaving, WRITTEN, **LAWS, heave=[1000.0, 30.0]))
    assert same_numbers(moved, plain) == every
    # The plane of a roll centre goes through the origin.
    points = {name: (x, y + 100.0, z) for name, (x, y, z) in DRAWN.items()}
    beside = solved_by(who, scene_of(tables(points), WRITTEN, **LAWS))
    assert every - same_numbers(beside, plain) == {"roll_centre_height", "arm_roll_centre_height"}


# Whole numbers: a right wheel that toes out and leans in at the top. Its spin axis (36, 48, 25) is 65 long,
# 60 of it level. So the lowest point of a disc of 260 lies 260 * 25 / 65 = 100 along (36, 48) / 60, and
# 260 * 60 / 65 = 240 below the centre: (1060, 780, 60). The steering axis (30, -60, 240) is at (1000, 735)
# there, and at (1030, 675) as high as the centre.
WHEEL = {
    "inner": (964.0, 652.0, 275.0),
    "centre": (1000.0, 700.0, 300.0),
    "lower": (1015.0, 705.0, 180.0),
    "upper": (1045.0, 645.0, 420.0),
    "low": (1014.0, 421.0, 558.0),
}
UPRIGHT = {**WHEEL, "inner": (1000.0, 650.0, 300.0)}
DAMPER_TOP = (1000.0, 400.0, 600.0)  # (14, 21, -42) = 7 (2, 3, -6)
OFFSETS = {
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
CAR = {
    "axle": "rear",
    "wheelbase": 2600.0,
    "centre_of_gravity_height": 520.0,
    "brake_share": 0.375,
    "drive_share": 0.25,
}
CENTRES = EFFECTS["instant_centres"].own_names
Place = tuple[float, float, float]


def on_an_arm(
    who: str,
    hinge: tuple[Place, Place],
    effects: tuple[str, ...],
    wheel: Mapping[str, Place] = WHEEL,
    turn: Any = 0.0,
    out: int = 1,
    radius: float = 260.0,
) -> Solution:
    """A wheel on an arm about a line, x rearward, y right, z up; mirrored where it is the left one."""
    points = {"pivot": hinge[0], "end": hinge[1], "damper_top": DAMPER_TOP, **wheel}
    mechanism = {
        "bodies": {"chassis": ["pivot", "end", "damper_top"], "arm": ["pivot", "end", *wheel]},
        "inputs": {"swing": {"angle": "arm", "from": "drawing"}},
        "roles": {
            "knuckle": "arm",
            "wheel_axis": ["inner", "centre"],
            "steering_axis": ["lower", "upper"],
            "damper": ["damper_top", "low"],
        },
        "points": {name: (x, out * y, z) for name, (x, y, z) in points.items()},
        "side": "right" if out > 0 else "left",
        "wheel_radius": radius,
        "car": CAR,
    }
    return solved_by(who, scene_of(mechanism, effects, swing=turn))


TRAILING = ((600.0, 400.0, 300.0), (600.0, 500.0, 300.0))  # 400 ahead of the wheel's centre
both_sides = pytest.mark.parametrize("out", [1, -1])


@by_each
@both_sides
def test_a_wheel_that_is_drawn_in_whole_numbers_has_its_offsets(who: str, out: int) -> None:
    effects = ("wheel_travel", "steering_axis", "damper", "wheel_angles", "toe", "caster", "steer_angle")
    with workdps(DIGITS):
        angles = {
            "camber": -atan(mpf(25) / 48),
            "toe": -atan(mpf(36) / 48),
            "steer_angle": out * atan(mpf(36) / 48) * -1,
            "kingpin": atan(mpf(60) / 240),
            "caster": atan(mpf(30) / 240),
        }
    # To the left on either side: a right wheel that toes out is turned to the right.
    exact = {name: [value] * 3 for name, value in (OFFSETS | angles).items()}
    assert_exact(on_an_arm(who, TRAILING, effects, out=out), exact)


@by_each
@pytest.mark.parametrize(
    ("name", "inner"), [("toe", (1060.0, 780.0, 300.0)), ("camber", (1000.0, 780.0, 360.0))]
)
def test_an_angle_goes_beyond_a_right_angle(who: str, name: str, inner: Place) -> None:
    """A spin axis that leads inboard, and on its way there forward or down."""
    solution = on_an_arm(who, TRAILING, ("toe", "camber"), {**WHEEL, "inner": inner})
    with workdps(DIGITS):
        angle = atan2(60, -80)
    assert_exact(solution, {name: [angle] * 3})


@by_each
@both_sides
def test_a_wheel_on_a_trailing_arm_goes_along_a_circle(who: str, out: int) -> None:
    """About the line to the right the wheel behind goes down, and the axis is turned forward at its top."""
    effects = ("wheel_travel", "caster", "roll_centre", "instant_centres", "anti_features")
    effects += tuple(f"{base}_by_travel" for base in ("wheel_travel", "caster", "toe", "camber", "damper"))
    # The mirror image of a line that leads to the right leads to the left.
    solution = on_an_arm(who, TRAILING, effects, UPRIGHT, [0.25 * out, -0.5 * out], out, 300.0)
    exact: dict[str, list[mpf]] = {}
    with workdps(DIGITS):
        for time in (mpf(0), mpf(1) / 2, mpf(1)):
            turn = mpf(0.25) - time / 2
            sine, cosine = -sin(turn), cos(turn)
            # The damper's lower end, 414 behind the pivot and 258 above it, goes down by d low / d turn.
            x, z = 414 * cosine - 258 * sine, 258 * cosine + 414 * sine
            line = (600 + x - 1000, 21, z - 300)
            stretch = (line[0] * z - line[2] * x) / sqrt(sum(c * c for c in line))
            lever = CAR["wheelbase"] / (CAR["centre_of_gravity_height"] - 400 * sine)
            for name, value in {
                "travel": 400 * sine,
                "contact_travel": 400 * sine,
                "recession": 400 * (cosine - 1),
                "half_track_change": mpf(0),
                "travel_by_travel": mpf(1),
                "recession_by_travel": -sine / cosine,
                "half_track_change_by_travel": mpf(0),
                "caster": atan(mpf(30) / 240) + turn,
                "caster_by_travel": -1 / (400 * cosine),
                "camber_by_travel": mpf(0),
                "toe_by_travel": mpf(0),
                "damper_length_by_travel": -stretch / (400 * cosine),
                "roll_centre_height": mpf(0),
                "side_view_swing_arm": -400 * cosine,
                "side_view_centre_height": 300 - 400 * sine,
                "anti_brake": mpf(37.5) * (300 - 400 * sine) / (400 * cosine) * lever,
                "anti_drive": mpf(25) * -tan(-turn) * lever,
            }.items():
                exact.setdefault(name, []).append(value)
    assert_exact(solution, exact, 1e-9)
    # It does not turn in the front view.
    assert_none(solution, CENTRES[:2])


@by_each
@pytest.mark.parametrize(("x", "lost"), [(1000.0, "toe_by_travel"), (1060.0, "roll_centre_height")])
def test_a_wheel_that_does_not_travel_has_no_numbers_by_it(who: str, x: float, lost: str) -> None:
    """The centre is right below the pivot, and goes along the car; or the contact point is."""
    hinge = ((x, 400.0, 500.0), (x, 500.0, 500.0))
    solution = on_an_arm(who, hinge, ("toe", "toe_by_travel", "roll_centre"))
    assert_none(solution, [lost])
    assert "toe" in solution.numbers["wheel"]


@by_each
def test_a_wheel_that_turns_about_its_steering_axis_has_no_roll_centre_of_its_arms(who: str) -> None:
    """The lower point of the axis stands still."""
    hinge = ((985.0, 765.0, -60.0), (1075.0, 585.0, 660.0))
    solution = on_an_arm(who, hinge, ("arm_roll_centre", "roll_centre"))
    assert_none(solution, ["arm_roll_centre_height"])
    assert "roll_centre_height" in solution.numbers["dimension"]


@by_each
def test_a_damper_whose_length_does_not_change_has_no_travel_per_its_own(who: str) -> None:
    """Its upper end stands on the hinge's line, which leads a little upwards, so that places are rounded."""
    hinge = ((900.0, 370.0, 587.0), (1100.0, 430.0, 613.0))
    solution = on_an_arm(who, hinge, ("motion_ratio", "toe"), turn=0.3)
    assert_none(solution, ["wheel_per_damper"])
    assert np.abs(solution.numbers["dimension_gradient"].get("damper_per_wheel", np.zeros(1))).max() < 1e-12
