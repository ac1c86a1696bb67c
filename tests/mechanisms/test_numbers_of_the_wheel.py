"""Every number of a wheel, by all three mechanics: in many digits, and where there is none."""

from __future__ import annotations

from functools import cache

import pytest
from effects_by_hand import numbers
from mpmath import atan2, mpf, workdps
from one_arm import CAR, DRAWN, tables
from three_mechanics import DIGITS, assert_exact, assert_none, by_each, scene_of, solved_by
from within_bounds import outside

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
    **{"turn": [0.1875, -0.375], "steer": [-12.0, 40.0]},
    **{"roll": [0.0625, -0.25], "pitch": [-0.125, 0.1875]},
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


@by_each
def test_braking_and_driving_lift_a_rear_axle_where_they_lower_a_front_one(who: str) -> None:
    rear = scene_of(tables(car=CAR | {"axle": "rear"}), ["anti_features"], **LAWS)
    exact = {name: [-number for number in written()[name]] for name in ("anti_brake", "anti_drive")}
    assert_exact(solved_by(who, rear), exact, 1e-8)


def same_numbers(changed: Solution, plain: Solution) -> set[str]:
    """The names of the numbers that are the same within both claims."""
    claims = changed.accuracy.claims, plain.accuracy.claims
    different = {name for _, name in outside(changed.numbers, plain.numbers, *claims)}
    return {name for of in plain.numbers.values() for name in of} & {*NUMBERS_OF_THE_CAR} - different


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


# A right wheel that toes out and leans in at the top; its steering axis is (30, -60, 240).
WHEEL = {
    "inner": (964.0, 652.0, 275.0),
    "centre": (1000.0, 700.0, 300.0),
    "lower": (1015.0, 705.0, 180.0),
    "upper": (1045.0, 645.0, 420.0),
    "low": (1014.0, 421.0, 558.0),
}
CONTACT_X = 1060.0
Place = tuple[float, float, float]


def on_an_arm(
    who: str, hinge: tuple[Place, Place], effects: tuple[str, ...], turn: float = 0.0, **moved: Place
) -> Solution:
    """The wheel on an arm about a line, x rearward, y right, z up."""
    wheel, ends = {**WHEEL, **moved}, dict(zip(("pivot", "end"), hinge, strict=True))
    mechanism = {
        "bodies": {"chassis": ["pivot", "end", "damper_top"], "arm": ["pivot", "end", *wheel]},
        "inputs": {"swing": {"angle": "arm", "from": "drawing"}},
        "roles": {
            "knuckle": "arm",
            "wheel_axis": ["inner", "centre"],
            "steering_axis": ["lower", "upper"],
            "damper": ["damper_top", "low"],
        },
        "points": {**wheel, **ends, "damper_top": (1000.0, 400.0, 600.0)},
        "side": "right",
        "wheel_radius": 260.0,
    }
    return solved_by(who, scene_of(mechanism, effects, swing=turn))


def across(x: float, z: float) -> tuple[Place, Place]:
    """A hinge from the left to the right."""
    return (x, 400.0, z), (x, 500.0, z)


@by_each
@pytest.mark.parametrize(
    ("name", "inner"), [("toe", (1060.0, 780.0, 300.0)), ("camber", (1000.0, 780.0, 360.0))]
)
def test_an_angle_goes_beyond_a_right_angle(who: str, name: str, inner: Place) -> None:
    """A spin axis that leads inboard, and on its way there forward or down."""
    solution = on_an_arm(who, across(600.0, 300.0), ("toe", "camber"), inner=inner)
    with workdps(DIGITS):
        angle = atan2(60, -80)
    assert_exact(solution, {name: [angle] * 3})


CENTRES = EFFECTS["instant_centres"].own_names


@by_each
@pytest.mark.parametrize(
    ("hinge", "effects", "lost", "turn"),
    [
        # The wheel does not turn in the front view.
        (across(600.0, 300.0), ("instant_centres", "toe"), CENTRES[:2], 0.25),
        # The wheel's centre is right below the hinge and goes along the car; or its contact point is.
        (across(1000.0, 500.0), ("toe_by_travel", "toe"), ("toe_by_travel",), 0.0),
        (across(CONTACT_X, 500.0), ("roll_centre", "toe"), ("roll_centre_height",), 0.0),
        # The hinge is the steering axis, whose lower point stands still.
        (
            ((985.0, 765.0, -60.0), (1075.0, 585.0, 660.0)),
            ("arm_roll_centre", "toe"),
            ("arm_roll_centre_height",),
            0.0,
        ),
        # The damper's upper end stands on the hinge, which leads upwards, so that places are rounded.
        (
            ((900.0, 370.0, 587.0), (1100.0, 430.0, 613.0)),
            ("motion_ratio", "toe"),
            ("wheel_per_damper",),
            0.3,
        ),
    ],
    ids=["no swing", "no travel", "no travel on the ground", "steering", "no stroke"],
)
def test_what_would_be_divided_by_zero_is_no_number(
    who: str, hinge: tuple[Place, Place], effects: tuple[str, ...], lost: tuple[str, ...], turn: float
) -> None:
    solution = on_an_arm(who, hinge, effects, turn)
    assert_none(solution, lost)
    assert "toe" in solution.numbers["wheel"]
