"""Cases of branches: the places are where they are said to be, and a jump is found out."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene
from validate.adjudication.reference_solution import inputs_at, reference_instant
from validate.cars.paper_car import PAPER
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.cars import paper_car
from validate.hard.case import unexpected
from validate.hard.cases.branches import (
    CASES,
    SOLVERS,
    flat_car,
    from_a_flat_drawing,
    through_the_meeting,
)
from validate.hard.cases.counting import (
    DEGREE,
    beside_meeting,
    counted,
    meeting,
    near_greatest_rack,
    near_lowest_arm,
)
from validate.hard.cases.oriented import drawn_signs, followed, sides
from validate.hard.trial import Tried, try_scene
from validate.reference import InfeasibleError, count_assemblies, solve_reference

BY_NAME = {case.name: case for case in CASES}


def feasible(angle: float, rack: float) -> bool:
    try:
        solve_reference(
            PAPER, {"arm_angle": (angle, 0, 0), "rack": (rack, 0, 0)}, digits=15, closure="collinear"
        )
    except InfeasibleError:
        return False
    return True


def test_branches_meet_where_the_reference_loses_its_pose() -> None:
    angle, rack = meeting()
    assert round(math.degrees(angle), 1) == 35.1
    # Known to some 1e-12 mm: the rounding of `spare`, 1e-15, over its slope of 0.015 per mm, and more.
    assert feasible(angle, rack + 1e-11)
    assert not feasible(angle, rack - 1e-11)
    for aside in (-0.01, 0.01):
        assert feasible(angle + aside, rack - 1e-11)


@pytest.mark.parametrize("share", [1e-2, 1e-8])
def test_assemblies_near_the_meeting_are_as_far_apart_as_the_report_says(share: float) -> None:
    trial = BY_NAME["branches-nearly-meet"].examine(share)
    scene = Scene.from_mapping(through_the_meeting(share, 1.0))
    angle = float(scene.functions["arm_angle"].series(0.5, 0)[0])
    rack = float(scene.functions["rack"].series(0.5, 0)[0])
    listed = count_assemblies(
        PAPER, {"arm_angle": (angle, 0, 0), "rack": (rack, 0, 0)}, starts=1000, closure="collinear"
    )
    meant = reference_instant(scene, inputs_at(scene, 0.5), exact_sides=True).choices
    drawn = next(i for i in listed.found if i.choices == meant)
    other = next(i for i in listed.found if i.choices == replace(drawn.choices, tie=-drawn.choices.tie))
    gap = math.dist(*(map(float, i.position["tie_rod_outer"]) for i in (drawn, other)))
    # `spare`, good to some 1e-15, is 1.5e-9 at the nearer place, and the gap is as its root.
    assert trial.facts["assemblies apart [mm]"] == pytest.approx(gap, rel=1e-5)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("share", [1.0, 1e-6, 1e-11])
def test_the_flat_drawing_stands_at_its_height_and_on_its_side(share: float, mirrored: bool) -> None:
    p = flat_car(share, mirrored)
    a, b, c = (p[name] - p["lower_ball_joint"] for name in ("strut_lower", "tie_rod_inner", "tie_rod_outer"))
    height = float(np.cross(a, b) @ c) / float(np.linalg.norm(np.cross(a, b)))
    whole = flat_car(1.0, False)["tie_rod_outer"] - p["lower_ball_joint"]
    expected = (
        (-share if mirrored else share) * float(np.cross(a, b) @ whole) / np.linalg.norm(np.cross(a, b))
    )
    # Coordinates below 600 mm are rounded to 1e-13 mm.
    assert abs(height - expected) < 1e-12
    signs = [drawn_signs(Scene.from_mapping(from_a_flat_drawing(share, side))) for side in (mirrored, False)]
    assert (signs[0]["tie"] != signs[1]["tie"]) == mirrored


@pytest.mark.parametrize(
    "name", ["crooked-drawing", "flat-drawing", "far-start-rack", "assemblies-counted-arm"]
)
def test_the_branch_of_the_drawing_is_kept_far_from_the_singular_place(name: str) -> None:
    case = BY_NAME[name]
    trial = case.examine(case.values[0])
    assert {answer.outcome for answer in trial.answers} == {"right"}
    shares = [value for fact, value in trial.facts.items() if fact.endswith("least share")]
    assert len(shares) == 2 * len(SOLVERS)
    assert all(float(share) > 0.0 for share in shares)


def test_a_gap_is_not_leapt() -> None:
    trial = BY_NAME["branches-met"].examine(1e-3)
    assert {answer.outcome for answer in trial.answers} == {"refused"}


def mirror(scene: Scene, solution: Solution) -> Solution:
    """The other assembly of the same pose: the tie rod's outer end reflected in the plane of the rest."""
    p = solution.position
    ball = p["lower_ball_joint"]
    normal = np.cross(p["strut_top"] - ball, p["tie_rod_inner"] - ball)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    outer = p["tie_rod_outer"]
    height = np.sum((outer - ball) * normal, axis=-1, keepdims=True)
    return solution.with_numbers({"position": {**p, "tie_rod_outer": outer - 2.0 * height * normal}})


def test_a_jump_to_the_mirror_image_is_wrong_and_its_side_is_negative(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    content = paper_car((1.5, 0.1), (0.0, 20.0), stop=0.5)
    scene = Scene.from_mapping(content)
    straight = formulation("absolute").solve(scene)
    other = mirror(scene, straight)
    # The mirror image closes all links as well.
    for end in ("lower_ball_joint", "strut_lower", "tie_rod_inner"):
        lengths = [
            np.linalg.norm(s.position["tie_rod_outer"] - s.position[end], axis=-1) for s in (straight, other)
        ]
        assert np.allclose(lengths[0], lengths[1], rtol=1e-14, atol=0.0)

    class Jumping:
        name = "absolute"

        def solve(self, scene: Scene) -> Solution:
            return other

    monkeypatch.setattr("validate.hard.trial.formulation", lambda _: Jumping())
    trial = try_scene(1.0, content, ("absolute",), followed)
    assert trial.answers[0].outcome == "wrong"
    assert float(trial.facts["tie side of absolute, least share"]) < 0.0
    assert float(trial.facts["arm side of absolute, least share"]) > 0.0


def test_sides_are_products_of_unit_vectors() -> None:
    scene = Scene.from_mapping(paper_car((1.5, 0.1), (0.0, 20.0), heave=(0.0, 50.0), stop=0.5))
    solution = formulation("pointcoord-newton").solve(scene)
    for shares in sides(scene, solution.position).values():
        assert np.all(np.abs(shares) <= 1.0)
    facts = followed(Tried(1.0, scene, {"pointcoord-newton": solution}, None))
    assert all(float(value) > 0.0 for value in facts.values())


@pytest.mark.parametrize("pose", [near_greatest_rack, near_lowest_arm, beside_meeting])
def test_all_assemblies_that_can_exist_are_found_far_from_a_singular_pose(
    pose: Callable[[float, str], tuple[float, float]],
) -> None:
    facts = counted(0.1, pose).facts
    # The search knows nothing of the closed forms, which allow two assemblies at least: both sides.
    assert float(facts["assemblies found, proven"]) == float(facts["assemblies possible"]) >= 2.0
    assert float(facts["starts"]) >= 1000.0


@pytest.mark.parametrize("share", BY_NAME["assemblies-counted-drawing"].values)
def test_at_the_drawing_and_beside_it_all_assemblies_are_found_and_the_drawn_one_is_answered(
    share: float,
) -> None:
    case = BY_NAME["assemblies-counted-drawing"]
    trial = case.examine(share)
    assert not unexpected(case, trial)
    found = float(trial.facts["assemblies found, proven"])
    assert 2.0 <= found == float(trial.facts["assemblies possible"]) <= DEGREE
    assert all(answer.condition is not None and answer.condition < 1e3 for answer in trial.answers)
