"""Cars with points nearly in line or coincident: drawn as they are said to be, and judged by their side."""

from __future__ import annotations

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import (
    inputs_at,
    reference_instant,
    reference_solution,
)
from validate.cars.paper_car import PAPER
from validate.hard.cars import paper_car
from validate.hard.cases.links import held_apart
from validate.hard.cases.near_points import assembled, nearer, short_tie_rod, thin_knuckle
from validate.hard.family import PAPER as STRUT
from validate.hard.trial import try_scene
from validate.reference import AmbiguousAssemblyError

EPS = float(np.finfo(float).eps)


def test_the_assembled_car_has_the_links_of_the_paper_and_its_strut_on_a_line() -> None:
    p = assembled()
    for a, b in held_apart(STRUT.plain):
        drawn = np.linalg.norm(np.subtract(PAPER[a], PAPER[b]))
        # Six coordinates below 600 mm are rounded, and the norms.
        assert abs(np.linalg.norm(p[a] - p[b]) - drawn) < 8 * EPS * 600
    axis = p["strut_top"] - p["lower_ball_joint"]
    for name in ("strut_lower", "strut_rod_end"):
        beside = np.cross(p[name] - p["lower_ball_joint"], axis / np.linalg.norm(axis))
        assert np.abs(beside).max() < 8 * EPS * 600


@pytest.mark.parametrize("value", [1.0, 1e-3, 1e-9])
def test_points_are_as_near_as_the_value_says(value: float) -> None:
    p = assembled()
    # A difference of coordinates below 600 mm is known to their rounding.
    rounding = 2 * EPS * 600
    for moved, onto in (("strut_rod_end", "strut_top"), ("lower_arm_rear", "lower_arm_front")):
        near = nearer(moved, onto)(value)
        whole = float(np.linalg.norm(p[moved] - p[onto]))
        assert abs(np.linalg.norm(near[moved] - near[onto]) - value * whole) < rounding
        assert all(np.array_equal(near[name], p[name]) for name in p if name != moved)
    rod = short_tie_rod(value)
    whole = float(np.linalg.norm(p["tie_rod_outer"] - p["tie_rod_inner"]))
    assert abs(np.linalg.norm(rod["tie_rod_outer"] - rod["tie_rod_inner"]) - value * whole) < rounding

    def off_the_line(points: dict[str, np.ndarray]) -> float:
        line = points["strut_lower"] - points["lower_ball_joint"]
        arm = points["tie_rod_outer"] - points["lower_ball_joint"]
        return float(np.linalg.norm(np.cross(line, arm)) / np.linalg.norm(line))

    thin = {name: np.array(place) for name, place in thin_knuckle(value).items()}
    assert abs(off_the_line(thin) - value * off_the_line(p)) < 4 * rounding


def test_exact_signs_are_those_of_the_reference_where_the_reference_can_tell() -> None:
    for rack in (-40.0, 0.0, 60.0):
        scene = Scene.from_mapping(paper_car(1.4, (rack, 30.0, 5.0), stop=0.1))
        inputs = inputs_at(scene, 0.0)
        expected = reference_instant(scene, inputs)
        assert reference_instant(scene, inputs, exact_sides=True).position == expected.position


@pytest.mark.parametrize("lift", [1e-13, -1e-13])
def test_a_drawn_side_is_told_however_near_the_plane(lift: float) -> None:
    # In the plane y = 0 lie the strut and the tie rod's inner end; the outer end stands beside it.
    points = {
        "lower_arm_front": (-200.0, 300.0, 0.0),
        "lower_arm_rear": (200.0, 300.0, 0.0),
        "rack_centre": (100.0, 0.0, 80.0),
        "strut_top": (0.0, 0.0, 500.0),
        "lower_ball_joint": (0.0, 0.0, 0.0),
        "tie_rod_outer": (110.0, lift, 100.0),
        "strut_lower": (0.0, 0.0, 60.0),
        "strut_rod_end": (0.0, 0.0, 300.0),
        "tie_rod_inner": (100.0, 0.0, 80.0),
        "wheel_centre": (0.0, -80.0, 60.0),
    }
    scene = Scene.from_mapping(paper_car(points=points))
    with pytest.raises(AmbiguousAssemblyError, match="another assembly"):
        reference_solution(scene)
    flat = Scene.from_mapping(paper_car(points={**points, "tie_rod_outer": (110.0, 0.0, 100.0)}))
    with pytest.raises(AmbiguousAssemblyError, match="another assembly"):
        reference_solution(flat, exact_sides=True)


def test_a_scene_that_the_reference_can_judge_is_left_to_it() -> None:
    trial = try_scene(1.0, paper_car(), ("pointcoord-newton",))
    assert trial.facts["reference"] == "answers"
    assert trial.answers[0].outcome == "right"
