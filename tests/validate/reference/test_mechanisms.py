"""A slider crank after any number of turns, rows that depend on others, and what makes no mechanism."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from mechanism_drawings import (
    SLIDER_CRANK,
    described,
)
from mpmath import mpf

from validate.reference import (
    Design,
    Instant,
    NoReferenceError,
    instants_of,
)
from validate.reference.vectors import Vector, minus

WITHIN = mpf("1e-50")


def apart(one: Mapping[str, Vector], other: Mapping[str, Vector]) -> mpf:
    """Greatest difference of a coordinate, mm."""
    return max(abs(x) for name in other for x in minus(one[name], other[name]))


def solved(plain: Mapping[str, Any], inputs: Mapping[str, Any]) -> Instant:
    return next(instants_of(Design.from_plain(plain), [inputs]))


def crank_of(theta: mpf) -> Vector:
    return 3 * mpmath.cos(theta), 3 * mpmath.sin(theta), mpf(0)


@pytest.mark.parametrize("theta", ["0.4", "2.1", "-2.9", "7.5", "-30"])
def test_a_slider_crank_is_where_its_closed_form_says_after_any_number_of_turns(theta: str) -> None:
    def slider(angle: mpf) -> mpf:
        return 3 * mpmath.cos(angle) + mpmath.sqrt(144 - 9 * mpmath.sin(angle) ** 2)

    t = mpf(theta)
    found = solved(SLIDER_CRANK, {"turn": (t, 2, 0)})
    assert apart(found.position, {"a": crank_of(t), "b": (slider(t), mpf(0), mpf(5))}) < WITHIN
    with mpmath.workdps(80):
        rate = 2 * mpmath.diff(slider, t)
        bend = 4 * mpmath.diff(slider, t, 2)
    assert abs(found.velocity["b"][0] - rate) < mpf("1e-30")
    assert abs(found.acceleration["b"][0] - bend) < mpf("1e-20")
    assert abs(found.angular_velocity["crank"][2] - 2) < WITHIN


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": {**SLIDER_CRANK["points"], "a": (0, 0, 3)}}, "all on one line"),
        ({"inputs": {}}, "drive 1 more"),
    ],
)
def test_a_description_that_makes_no_mechanism_is_refused_by_name(
    change: dict[str, Any], message: str
) -> None:
    with pytest.raises(NoReferenceError, match=message):
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
    found = solved(planar_four_bar(Fraction(0)), {"turn": (mpf("0.3"), 1, 0)})
    p = found.position
    for one, other, squared in (("a", "b", 25), ("p", "b", 10), ("a2", "b2", 25), ("o", "a", 9)):
        d = minus(p[one], p[other])
        assert abs(d[0] ** 2 + d[1] ** 2 + d[2] ** 2 - squared) < WITHIN
    assert abs(p["b"][2]) < WITHIN


def test_the_same_with_a_crooked_pin_is_locked() -> None:
    with pytest.raises(NoReferenceError):
        solved(planar_four_bar(Fraction(1, 3)), {"turn": (mpf("0.3"), 1, 0)})
