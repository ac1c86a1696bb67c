"""Cars drawn out of proportion: each parameter leads where it says, and sides are told however near."""

from __future__ import annotations

import numpy as np
import pytest

from validate.hard.cases import points as cases
from validate.hard.cases.points import LOWER, OFF, OUTER, assembled, put

EPS = float(np.finfo(float).eps)
ROUNDING = 8 * EPS * 600  # of lengths made of six coordinates below 600 mm
Points = cases.Points


def from_line(p: Points, name: str, start: str, end: str) -> float:
    """Distance of a point from a line, mm."""
    axis = p[end] - p[start]
    return float(np.linalg.norm(np.cross(p[name] - p[start], axis)) / np.linalg.norm(axis))


def sine_with_plane(p: Points) -> float:
    """Of the angle between the strut's axis and the plane of the knuckle's three points."""
    ball, outer, lower = (p[n] for n in ("lower_ball_joint", "tie_rod_outer", "strut_lower"))
    normal, axis = np.cross(outer - ball, lower - ball), p["strut_top"] - lower
    return abs(float(normal @ axis)) / float(np.linalg.norm(normal) * np.linalg.norm(axis))


@pytest.mark.parametrize("value", [1.0, 1e-3, 1e-6, 0.0])
def test_a_parameter_leads_where_it_says(value: float) -> None:
    p, beside = assembled(), assembled("beside")

    def length(q: Points, a: str, b: str) -> float:
        return float(np.linalg.norm(q[a] - q[b]))

    for moved, onto in (("strut_rod_end", "strut_top"), ("lower_arm_rear", "lower_arm_front")):
        near = put(moved, from_=onto)(p, value)
        assert abs(length(near, moved, onto) - value * length(p, moved, onto)) < ROUNDING
        assert all(np.array_equal(near[name], p[name]) for name in p if name != moved)
    rod, ends = cases.tie_rod_short(p, value), ("tie_rod_outer", "tie_rod_inner")
    assert abs(length(rod, *ends) - value * length(p, *ends)) < ROUNDING
    thin, kingpin = cases.thin_knuckle(LOWER)(p, value), (OUTER, LOWER, "lower_ball_joint")
    assert abs(from_line(thin, *kingpin) - value * from_line(p, *kingpin)) < 2 * ROUNDING
    near = cases.ball_joint_near_the_axis(beside, value)
    # An axis past a point at a distance across the line to the top passes it a little nearer.
    off = from_line(near, "lower_ball_joint", "strut_lower", "strut_top")
    assert off == pytest.approx(OFF * value, rel=3e-3, abs=1e-12)
    through = cases.axis_through_the_tie_rod_end(beside, value)
    off = from_line(through, "tie_rod_outer", "strut_lower", "strut_top")
    assert off == pytest.approx(OFF * value, rel=0.1, abs=1e-12)
    # 100 mm across, over the height of strut_lower above the line of the others, some 50 mm.
    assert sine_with_plane(cases.axis_in_the_knuckle_plane(beside, value)) <= 3.0 * value + 1e-15
    assert 1.0 - sine_with_plane(cases.axis_across_the_knuckle_plane(beside, value)) <= value + 1e-15
    q = cases.slide_drawn_run_out(beside, value)
    axis, strut = q["strut_top"] - q["strut_lower"], q["strut_top"] - q["lower_ball_joint"]
    cosine = float(axis @ strut) / float(np.linalg.norm(axis) * np.linalg.norm(strut))
    assert cosine == pytest.approx(value / np.hypot(1.0, value), rel=1e-9, abs=1e-15)
