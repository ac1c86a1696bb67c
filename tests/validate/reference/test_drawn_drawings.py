"""What a drawing of a strut may be, what is refused of it, and on which side it lies."""

from __future__ import annotations

from fractions import Fraction

import pytest
from closed_forms import Points
from off_axis_cars import BASE
from plain_mechanisms import solve_car
from reference_cars import OFF_AXIS as POINTS

from validate.reference import BadInputError
from validate.reference.vectors import minus, plus, times

STILL = {"arm_angle": (1.5, 0, 0), "rack": (230, 0, 0)}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"strut_lower": BASE["strut_top"]}, "strut_top in strut_lower"),
        ({"strut_rod_end": BASE["strut_top"]}, "length of strut_rod"),
    ],
)
def test_a_strut_that_is_none_is_refused_by_name(change: Points, message: str) -> None:
    with pytest.raises(BadInputError, match=message):
        solve_car({**POINTS, **change}, STILL, closure="drawn")


@pytest.mark.parametrize("small", [Fraction(1, 10**3), Fraction(1, 10**12), Fraction(1, 10**30)])
def test_strut_lower_drawn_next_to_the_strut_top_costs_nothing(small: Fraction) -> None:
    top = POINTS["strut_top"]
    near = {**POINTS, "strut_lower": plus(top, times(minus(POINTS["strut_lower"], top), small))}
    there, here = (solve_car(p, STILL, closure="drawn") for p in (near, POINTS))
    assert there.digits == here.digits
    same = set(POINTS) - {"strut_lower"}  # the axis is the same line
    for name in same:
        assert all(
            abs(x) <= there.radius + here.radius for x in minus(there.position[name], here.position[name])
        )
