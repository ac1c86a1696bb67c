"""Struts beside their ball joint: each parameter leads where it says, and what comes of it is as expected."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Scene
from validate.formulations.registry import formulation
from validate.hard.cars import BESIDE, BESIDE_CAR
from validate.hard.case import Case
from validate.hard.cases import beside

Array = NDArray[np.float64]
BY_NAME = {case.name: case for case in beside.CASES}


def at(name: str, *values: float) -> Case:
    """A case at some values of its parameter only."""
    return replace(BY_NAME[name], values=values)


def from_axis(p: beside.Points, name: str) -> float:
    """Distance of a point from the strut's axis, mm."""
    axis = p["strut_top"] - p["strut_lower"]
    return float(np.linalg.norm(np.cross(p[name] - p["strut_lower"], axis)) / np.linalg.norm(axis))


def sine_with_plane(p: beside.Points) -> float:
    """Of the angle between the axis and the plane of the knuckle's three points."""
    ball, outer, lower = (p[n] for n in ("lower_ball_joint", "tie_rod_outer", "strut_lower"))
    normal, axis = np.cross(outer - ball, lower - ball), p["strut_top"] - lower
    return abs(float(normal @ axis)) / float(np.linalg.norm(normal) * np.linalg.norm(axis))


@pytest.mark.parametrize("value", [1.0, 1e-3, 1e-6, 0.0])
def test_a_parameter_leads_where_it_says(value: float) -> None:
    near = beside.ball_joint_near_axis(value)
    # An axis past a point at a distance across the line to the top passes it a little nearer.
    assert from_axis(near, "lower_ball_joint") == pytest.approx(beside.OFF * value, rel=3e-3, abs=1e-12)
    through = beside.axis_near_tie_rod_end(value)
    assert from_axis(through, "tie_rod_outer") == pytest.approx(beside.OFF * value, rel=0.1, abs=1e-12)
    # 100 mm across, over the height of strut_lower above the line of the others, some 50 mm.
    assert sine_with_plane(beside.axis_in_the_triangle(value)) <= 3.0 * value + 1e-15
    assert 1.0 - sine_with_plane(beside.axis_across_the_triangle(value)) <= value + 1e-15
    p = beside.slide_drawn_run_out(value)
    axis, strut = p["strut_top"] - p["strut_lower"], p["strut_top"] - p["lower_ball_joint"]
    cosine = float(axis @ strut) / float(np.linalg.norm(axis) * np.linalg.norm(strut))
    assert cosine == pytest.approx(value / np.hypot(1.0, value), rel=1e-9, abs=1e-15)


CLOSING: tuple[Callable[[float], beside.Points], ...] = (
    beside.ball_joint_near_axis,
    beside.axis_in_the_triangle,
    beside.axis_across_the_triangle,
    beside.axis_near_tie_rod_end,
    beside.kingpin_near_tie_rod_end,
    beside.axis_near_ball_joint,
)


@pytest.mark.parametrize("points", CLOSING)
@pytest.mark.parametrize("value", [1.0, 1e-1, 1e-2])
def test_what_a_case_draws_closes(points: Callable[[float], beside.Points], value: float) -> None:
    scene = Scene.from_mapping(beside.motion(points(value), 0.0, 0.0))
    solution = formulation("pointcoord").solve(scene)
    for name, place in points(value).items():
        # 1e4 roundings of 1000 mm: steering arms of a hundredth of the car's have a condition number of 1e3.
        assert np.abs(solution.position[name][0] - place).max() < 2e-9, name


def test_the_car_beside_its_ball_joint_is_drawn_in_line_to_the_last_bit() -> None:
    p = {name: np.array(place) for name, place in BESIDE.items()}
    assert np.array_equal(
        np.cross(p["strut_rod_end"] - p["strut_top"], p["strut_lower"] - p["strut_top"]), [0, 0, 0]
    )
    assert from_axis(p, "lower_ball_joint") == pytest.approx(beside.OFF, abs=0.5)
    assert BESIDE_CAR.closure == "drawn"
