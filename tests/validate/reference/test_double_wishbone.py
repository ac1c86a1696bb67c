"""A double wishbone's assemblies, what it cannot reach, and what is refused of its drawing."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from reference_cars import CARS

from validate.reference import (
    AmbiguousAssemblyError,
)
from validate.reference.vectors import Vector, minus, plus, times

CAR = CARS["double wishbone"]


def along(*parts: tuple[str, Fraction]) -> Vector:
    """The lower ball joint, and shares of the ways from it to other points."""
    ball = CAR.points["lower_ball_joint"]
    place = ball
    for name, share in parts:
        place = plus(place, times(minus(CAR.points[name], ball), share))
    return place


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
