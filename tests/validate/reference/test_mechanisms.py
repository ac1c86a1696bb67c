"""Mechanisms of every kind, held to closed forms and to other people's tables; planted faults are noticed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from lotus_front import POINTS as LOTUS
from lotus_front import ROLLING_RADIUS
from mechanism_drawings import (
    DOUBLE_ARM,
    SLIDER_CRANK,
    described,
)
from mechanism_files import plain_scene
from mpmath import mpf
from plain_mechanisms import plain_mechanism

from validate.reference import (
    BadInputError,
    Design,
    InfeasibleError,
    Instant,
    NoReferenceError,
    solve_reference,
)
from validate.reference.vectors import Vector, cross, minus, plus

WITHIN = mpf("1e-50")


def apart(one: Mapping[str, Vector], other: Mapping[str, Vector]) -> mpf:
    """Greatest difference of a coordinate, mm."""
    return max(abs(x) for name in other for x in minus(one[name], other[name]))


def crank_of(theta: mpf) -> Vector:
    return 3 * mpmath.cos(theta), 3 * mpmath.sin(theta), mpf(0)


@pytest.mark.parametrize("theta", ["0.4", "2.1", "-2.9", "7.5", "-30"])
def test_a_slider_crank_is_where_its_closed_form_says_after_any_number_of_turns(theta: str) -> None:
    def slider(angle: mpf) -> mpf:
        return 3 * mpmath.cos(angle) + mpmath.sqrt(144 - 9 * mpmath.sin(angle) ** 2)

    t = mpf(theta)
    found = solve_reference(SLIDER_CRANK, {"turn": (t, 2, 0)})
    assert apart(found.position, {"a": crank_of(t), "b": (slider(t), mpf(0), mpf(5))}) < WITHIN
    with mpmath.workdps(80):
        rate = 2 * mpmath.diff(slider, t)
        bend = 4 * mpmath.diff(slider, t, 2)
    assert abs(found.velocity["b"][0] - rate) < mpf("1e-30")
    assert abs(found.acceleration["b"][0] - bend) < mpf("1e-20")
    assert abs(found.angular_velocity["crank"][2] - 2) < WITHIN


def test_an_arm_on_an_arm_turns_against_it_and_both_rates_add() -> None:
    one, two = mpf("2.3"), mpf("-5.1")
    found = solve_reference(DOUBLE_ARM, {"shoulder": (one, 2, 0), "elbow": (two, 3, 0)})
    elbow = (4 * mpmath.cos(one), 4 * mpmath.sin(one), mpf(0))
    tip = plus(elbow, (3 * mpmath.cos(one + two), 3 * mpmath.sin(one + two), mpf(0)))
    assert apart(found.position, {"e": elbow, "tip": tip}) < WITHIN
    for body, rate in (("upper", 2), ("fore", 5)):
        assert max(abs(x) for x in minus(found.angular_velocity[body], (0, 0, rate))) < WITHIN


def lotus(*driven: str, **others: Any) -> dict[str, Any]:
    """The Lotus front suspension, driven by other inputs than the arm."""
    inputs = {
        "gap": {"distance": ["tie_rod_outer", "upper_arm_front"]},
        "contact": {"contact": ["wheel_axis_inner", "wheel_centre"], "along": "up"},
        "sideways": {"moves": "chassis", "along": "right"},
        "roll": {"turns": "chassis", "about": "rack_centre", "along": "forward"},
    }
    plain = plain_mechanism("double_wishbone", LOTUS, ["arm_angle", "rack", "wheel_travel"], side="right")
    every = {**plain["inputs"], **inputs}
    return {
        **plain,
        "inputs": {name: every[name] for name in driven},
        "wheel_radius": ROLLING_RADIUS,
        **others,
    }


def test_a_car_that_rolls_takes_its_pose_along_and_adds_its_turning() -> None:
    inputs = {"arm_angle": (mpf("1.5"), 1, 0), "rack": (10, 20, 0)}
    rolling = {**inputs, "sideways": (7, 3, 0), "roll": (mpf("0.2"), 2, 0)}
    still = solve_reference(lotus("arm_angle", "rack"), inputs)
    rolled = solve_reference(lotus("arm_angle", "rack", "sideways", "roll"), rolling)
    about, (sine, cosine) = LOTUS["tie_rod_inner"], (mpmath.sin(mpf("0.2")), mpmath.cos(mpf("0.2")))

    def turned(v: Vector) -> Vector:
        # Forward is -x: right-handed about it.
        return v[0], cosine * v[1] + sine * v[2], cosine * v[2] - sine * v[1]

    axis = (-2, 0, 0)
    for name, place in still.position.items():
        arm = turned(minus(place, about))
        want = plus(plus(about, arm), (0, 7, 0))
        assert max(abs(x) for x in minus(rolled.position[name], want)) < WITHIN
        speed = plus(plus(cross(axis, arm), turned(still.velocity[name])), (0, 3, 0))
        assert max(abs(x) for x in minus(rolled.velocity[name], speed)) < WITHIN
    omega = plus(turned(still.angular_velocity["knuckle"]), axis)
    assert max(abs(x) for x in minus(rolled.angular_velocity["knuckle"], omega)) < WITHIN


# What is wrong in a description, and what becomes of it.
def test_a_rod_that_is_dropped_leaves_a_freedom_and_is_named_so() -> None:
    with pytest.raises(BadInputError, match="drive 1 more"):
        Design.from_plain(
            {**plain_scene("five-link"), "rods": dict(list(plain_scene("five-link")["rods"].items())[1:])}
        )


def test_an_input_too_many_locks_the_mechanism_and_is_noticed_off_the_drawing() -> None:
    plain = lotus("arm_angle", "rack", "wheel_travel")
    inputs = {"arm_angle": (mpf("1.5"), 0, 0), "rack": (10, 0, 0), "wheel_travel": (30, 0, 0)}
    with pytest.raises(NoReferenceError, match="depends on the others in the drawing, is violated"):
        solve_reference(plain, inputs)


def test_a_slide_through_another_point_and_a_body_that_is_swapped_are_other_mechanisms() -> None:
    plain = lotus("arm_angle", "rack")
    inputs = {"arm_angle": (mpf("1.5"), 0, 0), "rack": (10, 0, 0)}
    right = solve_reference(plain, inputs)
    beside = {**plain["points"], "rack_centre": plus(plain["points"]["rack_centre"], (0, 0, 40))}
    assert apart(solve_reference({**plain, "points": beside}, inputs).position, right.position) > 1
    bodies = {**plain["bodies"], "upper_arm": ["upper_arm_front", "lower_arm_rear", "upper_ball_joint"]}
    assert apart(solve_reference({**plain, "bodies": bodies}, inputs).position, right.position) > 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"rods": {"rod": ["a", "nowhere"]}}, "rods.rod is 'nowhere'"),
        ({"points": {**SLIDER_CRANK["points"], "spare": (1, 2, 3)}}, "points.spare is 'in no body"),
        ({"points": {**SLIDER_CRANK["points"], "above": (0, 0, 0)}}, "hinge of crank"),
        ({"points": {**SLIDER_CRANK["points"], "a": (0, 0, 3)}}, "all on one line"),
        ({"points": {**SLIDER_CRANK["points"], "b": (3, 0, 0)}}, "length of rod"),
        ({"inputs": {"turn": {"spins": "crank"}}}, "inputs.turn"),
    ],
)
def test_a_description_that_makes_no_mechanism_is_refused_by_name(
    change: dict[str, Any], message: str
) -> None:
    with pytest.raises(BadInputError, match=message):
        Design.from_plain({**SLIDER_CRANK, **change})


def planar_four_bar(lift: Fraction) -> dict[str, Any]:
    """A four-bar of hinges along z: some of its rows say what others do, unless a pin is crooked."""
    points = {
        "o": (0, 0, 0), "o2": (0, 0, 1), "p": (4, 0, 0), "p2": (4, 0, 1),
        "a": (0, 3, 0), "a2": (0, 3, 1), "b": (5, 3, 0), "b2": (5 + lift, 3, 1),
    }  # fmt: skip
    bodies = {
        "chassis": ["o", "o2", "p", "p2"],
        "crank": ["o", "o2", "a", "a2"],
        "rocker": ["p", "p2", "b", "b2"],
        "coupler": ["a", "a2", "b", "b2"],
    }
    return described(points, bodies, {"turn": {"angle": "crank", "from": "drawing"}})


def test_a_planar_mechanism_is_solved_by_independent_rows_and_the_others_hold() -> None:
    found: Instant = solve_reference(planar_four_bar(Fraction(0)), {"turn": (mpf("0.3"), 1, 0)})
    p = found.position
    for one, other, squared in (("a", "b", 25), ("p", "b", 10), ("a2", "b2", 25), ("o", "a", 9)):
        d = minus(p[one], p[other])
        assert abs(d[0] ** 2 + d[1] ** 2 + d[2] ** 2 - squared) < WITHIN
    assert abs(p["b"][2]) < WITHIN


def test_the_same_with_a_crooked_pin_is_locked() -> None:
    with pytest.raises(NoReferenceError):
        solve_reference(planar_four_bar(Fraction(1, 3)), {"turn": (mpf("0.3"), 1, 0)})


def test_a_fold_on_the_way_is_named_with_the_inputs_at_it() -> None:
    # With a rod of 13 and a crank of 20 the slider's crank cannot pass where 400 sin^2 = 144.
    long = {**SLIDER_CRANK, "points": {**SLIDER_CRANK["points"], "a": (20, 0, 0), "b": (32, 0, 5)}}
    with pytest.raises(InfeasibleError) as caught:
        solve_reference(long, {"turn": (mpf("1.2"), 0, 0)})
    assert abs(caught.value.inputs["turn"] - mpmath.asin(mpf(12) / 20)) < mpf("1e-20")
