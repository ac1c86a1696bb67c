"""Cases of branches: the places are where they are said to be, and a jump is found out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from stand_in import stand_in

from pointcoord import Scene
from validate.formulations.protocol import Solution
from validate.formulations.registry import formulation
from validate.hard.cars import PAPER_CAR, scene_content
from validate.hard.cases.branches import MEETINGS
from validate.hard.last_values import reachable
from validate.hard.subjects import NAMED
from validate.hard.trial import try_scene


@pytest.mark.parametrize("car", MEETINGS)
def test_branches_meet_where_the_reference_loses_its_pose(car: str) -> None:
    angle, rack = MEETINGS[car]
    assert round(math.degrees(angle), 1) == 35.1

    def feasible(angle: float, rack: float) -> bool:
        return reachable(NAMED[car], {"arm_angle": angle, "rack": rack})

    # Known to some 1e-12 mm: the rounding of a closed form, 1e-15, over its slope of 0.015 per mm, and more.
    assert feasible(angle, rack + 1e-11)
    assert not feasible(angle, rack - 1e-11)
    for aside in (-0.01, 0.01):
        assert feasible(angle + aside, rack - 1e-11)


def mirror(solution: Solution) -> Solution:
    """The other assembly of the same pose: the tie rod's outer end reflected in the plane of the rest."""
    p = solution.position
    ball = p["lower_ball_joint"]
    normal = np.cross(p["strut_top"] - ball, p["tie_rod_inner"] - ball)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    outer = p["tie_rod_outer"]
    height = np.sum((outer - ball) * normal, axis=-1, keepdims=True)
    return solution.with_numbers({"position": {**p, "tie_rod_outer": outer - 2.0 * height * normal}})


def test_a_jump_to_the_mirror_image_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    content = scene_content(PAPER_CAR, (1.5, 0.1), (0.0, 20.0), stop=0.5)
    straight = formulation("absolute").solve(Scene.from_mapping(content))
    other = mirror(straight)
    # The mirror image closes all links as well.
    for end in ("lower_ball_joint", "strut_lower", "tie_rod_inner"):
        lengths = [
            np.linalg.norm(s.position["tie_rod_outer"] - s.position[end], axis=-1) for s in (straight, other)
        ]
        assert np.allclose(lengths[0], lengths[1], rtol=1e-14, atol=0.0)
    stand_in(monkeypatch, lambda scene: other)
    assert try_scene(1.0, content, ("absolute",)).answers[0].outcome == "wrong"
