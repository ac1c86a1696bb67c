"""A double wishbone's assemblies, what it cannot reach, and what is refused of its drawing."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from reference_cars import CARS

from validate.reference import (
    AmbiguousAssemblyError,
    Instant,
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


def test_all_eight_assemblies_are_found_proven_and_told_apart_by_the_signs_of_a_closed_form() -> None:
    listed = ROOMY.count({"arm_angle": (1.5, 0, 0), "rack": (5, 0, 0)})
    assert len(listed.found) == len({signs(arrays(one)) for one in listed.found}) == 8


@pytest.mark.parametrize("share", [Fraction(1, 2), Fraction(1, 4)])
def test_a_drawing_in_the_plane_where_two_assemblies_meet_is_ambiguous(share: Fraction) -> None:
    place = along(("upper_ball_joint", share), ("tie_rod_inner", share))
    found = []
    for hair in (Fraction(1, 10**9), Fraction(-1, 10**9)):
        x, y, z = place
        near = replace(CAR, points={**CAR.points, "tie_rod_outer": (x + hair, y, z + hair)})
        with pytest.raises(AmbiguousAssemblyError, match="from another assembly"):
            near.close()
        found.append(near.close(clearness=0).instant.position["wheel_centre"])
    assert found[0] != found[1]
    with pytest.raises(AmbiguousAssemblyError):
        replace(CAR, points={**CAR.points, "tie_rod_outer": place}).close(clearness=0)
