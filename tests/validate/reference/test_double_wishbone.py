"""A double wishbone's assemblies, what it cannot reach, and what is refused of its drawing."""

from __future__ import annotations

from dataclasses import astuple, replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from mpmath import mpf
from reference_cars import CARS

from validate.reference import (
    AmbiguousAssemblyError,
    BadInputError,
    InfeasibleError,
    Instant,
    NotDecidedError,
    SingularPoseError,
)
from validate.reference.vectors import Vector, minus, plus, times

CAR = CARS["double wishbone"]
# Arms long enough to reach across the car: every choice has both of its answers.
ROOMY = replace(
    CAR,
    points={
        "lower_arm_front": (-100, 0, 0),
        "lower_arm_rear": (100, 0, 5),
        "upper_arm_front": (-90, 10, 250),
        "upper_arm_rear": (110, 10, 255),
        "lower_ball_joint": (0, 300, 0),
        "upper_ball_joint": (5, 290, 245),
        "tie_rod_outer": (-120, 280, 100),
        "tie_rod_inner": (-110, 20, 110),
        "wheel_centre": (0, 350, 120),
        "wheel_axis_inner": (0, 280, 118),
    },
)


def along(*parts: tuple[str, Fraction]) -> Vector:
    """The lower ball joint, and shares of the ways from it to other points."""
    ball = CAR.points["lower_ball_joint"]
    place = ball
    for name, share in parts:
        place = plus(place, times(minus(CAR.points[name], ball), share))
    return place


def arrays(instant: Instant) -> dict[str, Any]:
    return {name: np.array(instant.position_as_float(name)) for name in instant.position}


def signs(p: dict[str, Any]) -> tuple[int, ...]:
    """The three signs as they are defined for all models, in doubles."""
    lower = np.cross(p["lower_ball_joint"] - p["lower_arm_front"], p["lower_arm_rear"] - p["lower_arm_front"])
    plane = np.cross(p["upper_arm_rear"] - p["upper_arm_front"], p["lower_ball_joint"] - p["upper_arm_front"])
    kingpin = p["upper_ball_joint"] - p["lower_ball_joint"]
    beside = np.cross(kingpin, p["tie_rod_inner"] - p["lower_ball_joint"])
    return tuple(
        int(np.sign(product))
        for product in (
            lower @ (0, 0, 1),
            plane @ (p["upper_ball_joint"] - p["upper_arm_front"]),
            beside @ (p["tie_rod_outer"] - p["lower_ball_joint"]),
        )
    )


def test_all_eight_assemblies_are_found_proven_distinct_and_named_by_their_signs() -> None:
    listed = ROOMY.count({"arm_angle": (1.5, 0, 0), "rack": (5, 0, 0)})
    assert len(listed.found) == listed.possible == 8
    assert len({one.choices for one in listed.found}) == 8
    for one in listed.found:
        assert astuple(one.choices) == signs(arrays(one))
        others = [other for other in listed.found if other is not one]
        for other in others:
            apart = max(abs(x) for n in one.position for x in minus(one.position[n], other.position[n]))
            assert apart > one.radius + other.radius
            assert apart > 1


def test_a_drawing_comes_back_on_its_own_side_and_at_its_own_inputs() -> None:
    for car in (CAR, ROOMY):
        closed = car.close()
        assert closed.farthest[1] < mpf("1e-70")
        assert closed.inputs["rack"] == 0
        drawn = {name: np.array(place, dtype=float) for name, place in car.points.items()}
        assert astuple(closed.instant.choices) == signs(drawn)


def shortest(a: Any, along_a: float, b: Any, along_b: float) -> float:
    """Length of the shortest x with x . a = along_a and x . b = along_b."""
    return float(
        np.linalg.norm(np.linalg.lstsq(np.array([a, b]), np.array([along_a, along_b]), rcond=None)[0])
    )


def test_a_closure_that_cannot_be_met_is_named_with_its_gap() -> None:
    p = {name: np.array(place, dtype=float) for name, place in CAR.points.items()}

    def length(a: str, b: str) -> float:
        return float(np.linalg.norm(p[a] - p[b]))

    with pytest.raises(InfeasibleError, match="the arm closure") as caught:
        CAR.solve({"arm_angle": (0.01, 0, 0)})
    reach = length("lower_ball_joint", "lower_arm_front")
    axis = p["lower_arm_rear"] - p["lower_arm_front"]
    ahead = (reach**2 + axis @ axis - length("lower_ball_joint", "lower_arm_rear") ** 2) / 2
    least = shortest(axis, ahead, np.array([0, 0, 1.0]), reach * np.cos(0.01))
    assert caught.value.gap == pytest.approx(least - reach, rel=1e-9)

    with pytest.raises(InfeasibleError, match="the upper_arm closure") as caught:
        CAR.solve({"arm_angle": (2.3, 0, 0)})
    assert caught.value.closure == "upper_arm"
    # The lower arm alone stands there: a car whose upper arm is longer can do it.
    long = replace(
        CAR, points={**CAR.points, "upper_arm_front": (-91, 88, 5), "upper_arm_rear": (109, 88, 5)}
    )
    ball = np.array(long.solve({"arm_angle": (2.3, 0, 0)}).position_as_float("lower_ball_joint"))
    reach, axis = length("upper_ball_joint", "upper_arm_front"), p["upper_arm_rear"] - p["upper_arm_front"]
    across = ball - p["upper_arm_front"]
    ahead = (reach**2 + axis @ axis - length("upper_ball_joint", "upper_arm_rear") ** 2) / 2
    up_to = (reach**2 + across @ across - length("upper_ball_joint", "lower_ball_joint") ** 2) / 2
    assert caught.value.gap == pytest.approx(shortest(axis, ahead, across, up_to) - reach, rel=1e-9)

    with pytest.raises(InfeasibleError, match="the tie_rod closure") as caught:
        CAR.solve({"arm_angle": (1.5, 0, 0), "rack": (400, 0, 0)})
    stands = arrays(CAR.solve({"arm_angle": (1.5, 0, 0)}))
    reach = length("tie_rod_outer", "lower_ball_joint")
    kingpin = stands["upper_ball_joint"] - stands["lower_ball_joint"]
    inner = stands["tie_rod_inner"] - np.array([0, 400, 0]) - stands["lower_ball_joint"]
    ahead = (reach**2 + kingpin @ kingpin - length("tie_rod_outer", "upper_ball_joint") ** 2) / 2
    up_to = (reach**2 + inner @ inner - length("tie_rod_outer", "tie_rod_inner") ** 2) / 2
    assert caught.value.gap == pytest.approx(shortest(kingpin, ahead, inner, up_to) - reach, rel=1e-9)


@pytest.mark.parametrize(
    ("choice", "point", "place"),
    [
        (
            "upper_arm",
            "upper_ball_joint",
            along(("upper_arm_front", Fraction(1, 4)), ("upper_arm_rear", Fraction(-3, 4))),
        ),
        (
            "tie",
            "tie_rod_outer",
            along(("upper_ball_joint", Fraction(1, 2)), ("tie_rod_inner", Fraction(-1, 4))),
        ),
    ],
)
def test_a_drawing_at_a_dead_point_is_refused_by_name_and_taken_by_its_exact_sign_when_asked_for(
    choice: str, point: str, place: Vector
) -> None:
    found = []
    for hair in (Fraction(1, 10**9), Fraction(-1, 10**9)):
        x, y, z = place
        near = replace(CAR, points={**CAR.points, point: (x + hair, y, z + hair)})
        with pytest.raises(AmbiguousAssemblyError, match=f"{choice} choice"):
            near.close()
        found.append(getattr(near.close(clearness=0).instant.choices, choice))
    assert sorted(found) == [-1, 1]
    with pytest.raises(AmbiguousAssemblyError, match=f"{choice} choice"):
        replace(CAR, points={**CAR.points, point: place}).close(clearness=0)


def test_an_exactly_singular_pose_is_an_error_that_says_so() -> None:
    # The lower arm's axis is level and the ball joint beside its front end: at theta = 0 it stands upright.
    level = {"lower_arm_front": (0, 0, 0), "lower_arm_rear": (200, 0, 0), "lower_ball_joint": (0, 300, 0)}
    upright = replace(ROOMY, points={**ROOMY.points, **level})
    with pytest.raises(SingularPoseError, match="400 digits") as caught:
        upright.solve({"arm_angle": (0, 1, 0)})
    assert isinstance(caught.value.reason, NotDecidedError)
    assert "the arm closure" in str(caught.value.reason)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tie_rod_outer": along(("upper_ball_joint", Fraction(1, 2)))}, "a triangle of these points"),
        ({"upper_arm_rear": CAR.points["upper_arm_front"]}, "two pivots that lie apart"),
        ({"lower_arm_rear": plus(CAR.points["lower_arm_front"], (0, 0, 50))}, "an axis not along up"),
        (
            {"upper_ball_joint": CAR.points["lower_ball_joint"]},
            "distance from upper_ball_joint to lower_ball",
        ),
        ({"strut_top": (0, 0, 0)}, "exactly the names"),
    ],
)
def test_a_double_wishbone_that_is_none_is_refused_by_name(change: dict[str, Vector], message: str) -> None:
    with pytest.raises(BadInputError, match=message):
        replace(CAR, points={**CAR.points, **change}).solve(CAR.still)


def test_the_spin_axis_is_required_and_the_rack_centre_is_not() -> None:
    without = {name: place for name, place in CAR.points.items() if name != "wheel_axis_inner"}
    with pytest.raises(BadInputError, match="wheel_axis_inner, with or without rack_centre"):
        replace(CAR, points=without).solve(CAR.still)
    middle = replace(CAR, points={**CAR.points, "rack_centre": (-10, 0, 154)})
    travelled = middle.solve({**CAR.inputs, "rack": (-178 + 10, -150, 50)})
    plain = CAR.solve(CAR.inputs)
    assert plain.position["rack_centre"] != travelled.position["rack_centre"]
    for name in CAR.points:
        for quantity in ("position", "velocity", "acceleration"):
            one, other = (getattr(i, quantity)[name] for i in (plain, travelled))
            assert all(abs(x) < mpf("1e-55") for x in minus(one, other))


def test_a_double_wishbone_has_one_closure() -> None:
    with pytest.raises(BadInputError, match="closure is 'collinear'; allowed is 'drawn'"):
        replace(CAR, closure="collinear").solve(CAR.still)
